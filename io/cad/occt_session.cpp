// Turns signals inside OpenCASCADE into C++ exceptions (see Standard_ErrorHandler.hxx); must stand before its headers.
#ifndef OCC_CONVERT_SIGNALS
#define OCC_CONVERT_SIGNALS
#endif
#include "io/cad/occt_session.hpp"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <OSD.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>

#include "meshops/error.hpp"

namespace tri {

OcctSession::OcctSession() {
  printers_ = Message::DefaultMessenger()->Printers();
  Message::DefaultMessenger()->ChangePrinters().Clear();
  for (std::size_t i = 0; i < signals_.size(); ++i) sigaction(signals_[i], nullptr, &actions_[i]);
  OSD::SetSignal(OSD_SignalMode_Set, Standard_False);
  // Interrupts stay with the program: only crashes are OpenCASCADE's business here.
  for (std::size_t i = 5; i < signals_.size(); ++i) sigaction(signals_[i], &actions_[i], nullptr);
}

OcctSession::~OcctSession() {
  for (std::size_t i = 0; i < signals_.size(); ++i) sigaction(signals_[i], &actions_[i], nullptr);
  Message::DefaultMessenger()->ChangePrinters() = printers_;
}

std::string run_guarded(const std::function<void()>& body) {
  try {
    OCC_CATCH_SIGNALS
    body();
    return {};
  } catch (const Error&) {
    throw;
  } catch (const Standard_Failure& failure) {
    const char* text = failure.GetMessageString();
    const std::string type = failure.DynamicType()->Name();
    return text != nullptr && *text != 0 ? type + ": " + text : type;
  } catch (const std::exception& failure) {
    return failure.what();
  }
}

}  // namespace tri

#pragma once

// Included only by the source files that wrap OpenCASCADE's readers and writers.
#include <signal.h>

#include <Message_ProgressIndicator.hxx>
#include <Message_SequenceOfPrinters.hxx>
#include <array>
#include <functional>
#include <string>

#include "meshops/context.hpp"

namespace tri {

/// For its lifetime OpenCASCADE prints nothing, and signals raised inside it can be caught as exceptions.
/// Restores printers and signal handlers.
class OcctSession {
 public:
  OcctSession();
  ~OcctSession();
  OcctSession(const OcctSession&) = delete;
  OcctSession& operator=(const OcctSession&) = delete;

 private:
  static constexpr std::array<int, 8> signals_{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGSYS, SIGINT, SIGHUP, SIGQUIT};
  Message_SequenceOfPrinters printers_;
  std::array<struct sigaction, 8> actions_;
};

/// Hands OpenCASCADE's progress to a context and its cancel to OpenCASCADE.
class OcctProgress : public Message_ProgressIndicator {
 public:
  OcctProgress(const Context& context, std::string step) : context_(context), step_(std::move(step)) {}
  Standard_Boolean UserBreak() override { return context_.cancelled(); }

 protected:
  void Show(const Message_ProgressScope&, const Standard_Boolean) override;

 private:
  const Context& context_;
  std::string step_;
  double last_ = 0;
};

/// Runs `body`; an exception of OpenCASCADE or a signal inside it comes back as its description, success as "".
/// Exceptions of this library pass through.
std::string run_guarded(const std::function<void()>& body);

}  // namespace tri

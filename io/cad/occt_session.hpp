#pragma once

// Included only by the source files that wrap OpenCASCADE's readers and writers.
#include <signal.h>

#include <Message_SequenceOfPrinters.hxx>
#include <array>
#include <functional>
#include <string>

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

/// Runs `body`; an exception of OpenCASCADE or a signal inside it comes back as its description, success as "".
/// Exceptions of this library pass through.
std::string run_guarded(const std::function<void()>& body);

}  // namespace tri

#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "meshops/context.hpp"

namespace tri::cli {

/// From here on an interrupt (Ctrl-C) or a request to end cancels `context`, which then leaves no partial output. A
/// second one ends the program at once, for the sake of libraries that cannot be stopped. `context` must live until the
/// end.
void cancel_on_interrupt(Context& context);

/// While it lives, an interrupt that the work does not heed within a fifth of a second ends the program with
/// `exit_interrupted`: for the time in which OpenCASCADE parses a file and cannot be asked to stop. The work must hold
/// no file that it writes.
class EndOnInterrupt {
 public:
  explicit EndOnInterrupt(const Context& context);
  ~EndOnInterrupt();
  EndOnInterrupt(const EndOnInterrupt&) = delete;
  EndOnInterrupt& operator=(const EndOnInterrupt&) = delete;

 private:
  void watch();

  const Context& context_;
  std::mutex mutex_;
  std::condition_variable finished_;
  bool done_ = false;
  std::thread watcher_;
};

}  // namespace tri::cli

#include "python/call.hpp"

#include <chrono>
#include <string>
#include <thread>

namespace tri::python {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto least_pause = std::chrono::milliseconds(20);

}  // namespace

void Call::raise() {
  raised_ = std::current_exception();
  context_.cancel();
}

Call::Call(py::object progress, int threads) : progress_(std::move(progress)) {
  if (threads < 0) throw InvalidInput("threads = " + std::to_string(threads) + " is not allowed; allowed: from 0");
  context_.threads = threads;
  if (!progress_.is_none())
    context_.on_progress = [this, last = Clock::time_point(), last_step = std::string()](std::string_view step,
                                                                                         double share) mutable {
      const auto now = Clock::now();
      if (raised_ || (share < 1 && step == last_step && now - last < least_pause)) return;
      last = now;
      last_step = step;
      const py::gil_scoped_acquire locked;
      try {
        progress_(py::str(step.data(), step.size()), share);
      } catch (const py::error_already_set&) {
        raise();
      }
    };
  // Signals are looked at by the thread that called, and take effect in Python's main thread only.
  context_.on_checkpoint = [this, caller = std::this_thread::get_id(), last = Clock::now()]() mutable {
    if (std::this_thread::get_id() != caller) return;
    const auto now = Clock::now();
    if (raised_ || now - last < least_pause) return;
    last = now;
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) {
      try {
        throw py::error_already_set();
      } catch (const py::error_already_set&) {
        raise();
      }
    }
  };
}

}  // namespace tri::python

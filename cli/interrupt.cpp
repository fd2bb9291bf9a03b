#include "cli/interrupt.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>

#include "cli/program.hpp"

namespace tri::cli {
namespace {

Context* interrupted_context = nullptr;

void on_signal(int number) {
  interrupted_context->cancel();  // stores into an atomic without a lock, which a signal handler may do
  std::signal(number, SIG_DFL);
}

}  // namespace

void cancel_on_interrupt(Context& context) {
  static_assert(std::atomic<bool>::is_always_lock_free);
  interrupted_context = &context;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  // A reader that closes early (`tri ops | head`) shows as a failed write, not as a sudden end.
  std::signal(SIGPIPE, SIG_IGN);
}

EndOnInterrupt::EndOnInterrupt(const Context& context) : context_(context), watcher_([this] { watch(); }) {}

EndOnInterrupt::~EndOnInterrupt() {
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  finished_.notify_all();
  watcher_.join();
}

void EndOnInterrupt::watch() {
  using namespace std::chrono_literals;
  std::unique_lock lock(mutex_);
  const auto done = [this] { return done_; };
  // A signal handler may set a flag and no more, so the flag is looked at.
  while (!context_.cancelled())
    if (finished_.wait_for(lock, 20ms, done)) return;
  if (finished_.wait_for(lock, 200ms, done)) return;
  print_note("interrupted; nothing was written");
  // Without destructors: they would pull the ground from under the thread that still works.
  std::_Exit(exit_interrupted);
}

}  // namespace tri::cli

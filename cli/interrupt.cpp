#include "cli/interrupt.hpp"

#include <csignal>

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

}  // namespace tri::cli

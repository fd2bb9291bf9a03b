#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <string>

#include "cli/program.hpp"

namespace tri::cli {
namespace {

using Clock = std::chrono::steady_clock;

bool line_is_shown = false;

// Draws at most 20 times a second: a terminal is slower than a loop.
class ProgressLine {
 public:
  void show(std::string_view step, double share) {
    const auto now = Clock::now();
    const bool same_step = step == step_;
    if (same_step && now - drawn_ < std::chrono::milliseconds(50)) return;
    step_ = step;
    drawn_ = now;
    constexpr int cells = 30;
    const int full = static_cast<int>(share * cells);
    fmt::print(stderr, "\r\x1b[K[{}{}] {:3.0f}% {}", std::string(full, '#'), std::string(cells - full, '.'),
               100 * share, step);
    std::fflush(stderr);
    line_is_shown = true;
  }

 private:
  std::string step_;
  Clock::time_point drawn_{};
};

}  // namespace

void clear_progress() {
  if (!line_is_shown) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  line_is_shown = false;
}

void show_progress(Context& context, bool quiet) {
  if (quiet) return;
  context.on_log = [](std::string_view line) { print_note(std::string(line)); };
  if (isatty(STDERR_FILENO) == 0) return;
  context.on_progress = [line = ProgressLine()](std::string_view step, double share) mutable {
    line.show(step, share < 0 ? 0 : share > 1 ? 1 : share);
  };
}

}  // namespace tri::cli

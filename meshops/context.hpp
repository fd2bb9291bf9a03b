#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

namespace tri {

/// What a long operation talks to: progress, cancel, log and the number of threads.
///
/// A default-constructed context reports nothing, never cancels, and uses every core. One context serves one operation
/// at a time; `cancel` may be called from any thread. `progress` and `log` are called from the thread that runs the
/// operation.
class Context {
 public:
  /// (step name, share done in [0,1]); never goes backwards within a step.
  std::function<void(std::string_view step, double share)> on_progress;
  /// One line of text without a line break.
  std::function<void(std::string_view line)> on_log;
  /// Called at every checkpoint, on the thread that reached it, before cancellation is looked at; may call `cancel()`
  /// (an editor that polls a key, a test that cancels at each point). Must be safe to call from several threads at
  /// once.
  std::function<void()> on_checkpoint;
  /// Upper bound on worker threads; 0 means every core. Results do not depend on it.
  int threads = 0;

  /// Tells `on_progress`, if there is one. @param share  done of the step, in [0,1]
  void progress(std::string_view step, double share) const {
    if (on_progress) on_progress(step, share);
  }
  /// Tells `on_log`, if there is one.
  void log(std::string_view line) const {
    if (on_log) on_log(line);
  }

  /// Asks the running operation to stop; takes effect at its next checkpoint.
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  /// True once `cancel()` was called; it is never taken back.
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }
  /// @throws Cancelled once `cancel()` was called.
  void checkpoint() const;

 private:
  std::atomic<bool> cancelled_{false};
};

}  // namespace tri

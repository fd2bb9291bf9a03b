#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <tri/meshops/context.hpp>

namespace editor {

/// One long operation on a thread of its own, so that the window stays alive.
///
/// While a job runs nobody else touches the document.
class Job {
 public:
  Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  /// Cancels and waits.
  ~Job();

  /// @param work runs on the thread of the job; what it throws comes out of `finish`. Nothing may be running.
  void start(std::string name, std::function<void(tri::Context&)> work);

  bool running() const { return thread_.joinable(); }
  const std::string& name() const { return name_; }
  /// True once the work is over and `finish` would not wait.
  bool done() const { return done_.load(std::memory_order_acquire); }
  void cancel();

  struct Progress {
    std::string step;
    float share = 0;  ///< in [0, 1]
  };
  Progress progress() const;

  /// Waits for the end. @throws what the work threw, tri::Cancelled if it was cancelled.
  void finish();

 private:
  std::string name_;
  std::unique_ptr<tri::Context> context_;
  std::thread thread_;
  std::exception_ptr error_;
  std::atomic<bool> done_{false};
  mutable std::mutex mutex_;  ///< guards progress_
  Progress progress_;
};

}  // namespace editor

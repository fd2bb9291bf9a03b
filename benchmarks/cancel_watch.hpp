#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/error.hpp"

// How soon a cancel from another thread is heeded, for the benchmarks that ask that.
//
// A line of the table, in milliseconds. `silence`: the longest time without a checkpoint in a run to the end, from the
// start to the return, and the step in which it ended. `5%` to `95%`: from a request at that share of the run's time to
// the return, whatever unwinding and undoing takes; the worst of TRI_BENCH_REPEATS (1) tries. `-`: the run had ended.
// `after`: what there is has been looked at after every cancel: "valid", "as it was" (bit for bit), or what is wrong.
// `progress`: "ends" if every step's share went up to 1 without going back.
//
// Every time is the lesser of the time on the clock and the processor time that all threads together took: so what
// other programs do on the machine does not count.
namespace tri::cancel_watch {

/// A time on the clock and the processor time of all threads up to it.
struct Moment {
  std::chrono::steady_clock::time_point clock = std::chrono::steady_clock::now();
  double processor_ms = used_ms();

  static double used_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  }
};

inline double ms_between(const Moment& a, const Moment& b) {
  return std::min(std::chrono::duration<double, std::milli>(b.clock - a.clock).count(),
                  b.processor_ms - a.processor_ms);
}

inline constexpr double moments[] = {0.05, 0.25, 0.5, 0.75, 0.95};

inline std::int64_t environment(const char* name, std::int64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoll(text) : otherwise;
}

/// Looks on while an operation runs to its end: the longest time without a checkpoint, and how progress went.
class Watch {
 public:
  explicit Watch(Context& context) {
    context.on_checkpoint = [this] { look(); };
    context.on_progress = [this](std::string_view step, double share) {
      const std::lock_guard lock(mutex_);
      step_ = step;
      double& before = shares_.try_emplace(std::string(step), 0.0).first->second;
      if (share < before) backwards_ = step_;
      before = share;
    };
    last_ = start_ = Moment();
  }
  void look() {
    const Moment now;
    const std::lock_guard lock(mutex_);
    const double silence = ms_between(last_, now);
    if (silence > longest_) longest_ = silence, where_ = step_, at_ = ms_between(start_, now);
    last_ = now;
  }
  double longest() const { return longest_; }
  std::string where() const { return fmt::format("{} at {:.0f}", where_.empty() ? "start" : where_, at_); }
  std::string progress() const {
    if (!backwards_.empty()) return "BACKWARDS in " + backwards_;
    for (const auto& [step, share] : shares_)
      if (share < 1) return fmt::format("{} ends at {:.2f}", step, share);
    return shares_.empty() ? "NONE" : "ends";
  }

 private:
  std::mutex mutex_;
  Moment start_, last_;
  double longest_ = 0, at_ = 0;
  std::string step_, where_, backwards_;
  std::map<std::string, double> shares_;
};

/// One operation on an input of its own, made anew for each run.
struct Case {
  std::string name;
  /// Makes the input and returns what runs on it, and what looks at it afterwards.
  struct Job {
    std::function<void(Context&)> run;
    std::function<std::string()> check;
  };
  std::function<Job()> prepare;
};

struct Outcome {
  bool cancelled = false;
  double ms = 0;  ///< from the request, or without one from the start, to the return
  std::string error;
};

/// Runs on a thread of its own; with a moment, cancels from this one then.
inline Outcome run(const Case::Job& job, Context& context, std::optional<double> cancel_after_ms) {
  Outcome outcome;
  std::atomic<bool> ended{false};
  Moment start, end;
  std::thread worker([&] {
    try {
      job.run(context);
    } catch (const Cancelled&) {
      outcome.cancelled = true;
    } catch (const std::exception& e) {
      outcome.error = e.what();
    }
    end = Moment();
    ended = true;
  });
  if (cancel_after_ms) {
    while (!ended && ms_between(start, Moment()) < *cancel_after_ms)
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    start = Moment();
    context.cancel();
  }
  worker.join();
  outcome.ms = ms_between(start, end);
  return outcome;
}

inline void measure(const Case& what) {
  double whole = 0;
  std::string line, progress, after = "-";
  {
    const Case::Job job = what.prepare();
    Context context;
    Watch watch(context);
    const Outcome outcome = run(job, context, std::nullopt);
    watch.look();
    if (!outcome.error.empty()) {
      fmt::print("{:44} {}\n", what.name, outcome.error);
      return;
    }
    whole = outcome.ms;
    progress = watch.progress();
    line = fmt::format("{:44} {:8.2f} {:7.0f} {:34}", what.name, whole / 1000, watch.longest(), watch.where());
  }
  double worst = 0;
  for (const double moment : moments) {
    double longest = -1;
    for (std::int64_t i = environment("TRI_BENCH_REPEATS", 1); i > 0; --i) {
      const Case::Job job = what.prepare();
      Context context;
      const Outcome outcome = run(job, context, moment * whole);
      if (!outcome.error.empty()) after = outcome.error;
      if (!outcome.cancelled) continue;
      longest = std::max(longest, outcome.ms);
      if (const std::string state = job.check(); after == "-" || (state != "valid" && state != "as it was"))
        after = state;
    }
    worst = std::max(worst, longest);
    line += longest < 0 ? "     -" : fmt::format(" {:5.0f}", longest);
  }
  fmt::print("{} {:6.0f}  {}; {}{}\n", line, worst, after, progress, worst > 100 ? "  OVER" : "");
  std::fflush(stdout);
}

inline void print_head() {
  fmt::print("{:44} {:>8} {:>7} {:34}", "", "run s", "silence", "in");
  for (const double moment : moments) fmt::print(" {:4.0f}%", 100 * moment);
  fmt::print("  worst  after; progress\n");
}

/// Measures those whose names begin with one of the words of the command line; all without one.
inline void measure_chosen(const std::vector<Case>& cases, int argc, char** argv) {
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  print_head();
  for (const Case& c : cases)
    if (wanted.empty() || std::ranges::any_of(wanted, [&](const std::string& w) { return c.name.starts_with(w); }))
      measure(c);
}

}  // namespace tri::cancel_watch

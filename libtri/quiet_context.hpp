#pragma once

#include <map>
#include <string>
#include <string_view>

#include "meshops/context.hpp"

namespace tri {

/// For an operation inside another: says nothing, and is cancelled with it.
class QuietContext : public Context {
 public:
  QuietContext(const QuietContext&) = delete;
  QuietContext& operator=(const QuietContext&) = delete;
  /// @param outer        must outlive this object
  /// @param threads_most upper bound on threads, as Context::threads
  QuietContext(const Context& outer, int threads_most) {
    threads = threads_most;
    on_checkpoint = [this, &outer] {
      if (outer.on_checkpoint) outer.on_checkpoint();
      if (outer.cancelled()) cancel();
    };
  }
};

/// For an operation of several that tell the same steps, one after another: passes on what is told, but for shares that
/// go back, and is cancelled with the outer one.
class ForwardContext : public QuietContext {
 public:
  /// @param outer  must outlive this object
  explicit ForwardContext(const Context& outer) : QuietContext(outer, outer.threads) {
    if (outer.on_progress)
      on_progress = [this, &outer](std::string_view step, double share) {
        const auto [told, first] = told_.try_emplace(std::string(step), share);
        if (!first && share < told->second) return;
        told->second = share;
        outer.progress(step, share);
      };
    on_log = outer.on_log;
  }

 private:
  std::map<std::string, double> told_;  ///< the last share of each step
};

}  // namespace tri

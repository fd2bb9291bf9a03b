#pragma once

#include "meshops/context.hpp"

namespace tri {

/// For an operation inside another: says nothing, and is cancelled with it.
class QuietContext : public Context {
 public:
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

}  // namespace tri

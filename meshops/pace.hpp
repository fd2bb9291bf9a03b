#pragma once

#include <cstdint>

#include "meshops/context.hpp"

namespace tri {

/// Reaches a checkpoint in every so many calls: for loops whose steps are short, from within or from a comparison of a
/// sort. Belongs to one thread.
class Pace {
 public:
  static constexpr std::uint32_t usual = 1 << 15;  ///< steps of some 100 ns come to a few milliseconds

  /// @param context  null: none is reached
  explicit Pace(const Context* context, std::uint32_t every = usual) : context_(context), every_(every) {}
  /// The same for a context that is there.
  explicit Pace(const Context& context, std::uint32_t every = usual) : Pace(&context, every) {}

  /// @throws Cancelled
  void operator()() {
    if (++calls_ < every_) return;
    calls_ = 0;
    if (context_) context_->checkpoint();
  }

 private:
  const Context* context_;
  const std::uint32_t every_;
  std::uint32_t calls_ = 0;
};

}  // namespace tri

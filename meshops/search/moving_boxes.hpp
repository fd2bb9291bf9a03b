#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// Boxes of items that move, come and go: which of them overlap a given one.
///
/// A complete binary tree over the items in the order of a space-filling curve. A box that changes makes those above it
/// larger, never smaller, so that searches get slower with time; who changes much builds it anew now and then.
class MovingBoxes {
 public:
  /// An axis-aligned box, rounded outwards to floats; empty until it is grown.
  struct Box {
    std::array<float, 3> low{infinite, infinite, infinite};      ///< least coordinates
    std::array<float, 3> high{-infinite, -infinite, -infinite};  ///< greatest coordinates

    /// True if they have a place in common, their sides included.
    bool overlaps(const Box& b) const {
      return (low[0] <= b.high[0]) & (b.low[0] <= high[0]) & (low[1] <= b.high[1]) & (b.low[1] <= high[1]) &
             (low[2] <= b.high[2]) & (b.low[2] <= high[2]);
    }
    /// True if every place of the other is one of this.
    bool holds(const Box& b) const {
      return (low[0] <= b.low[0]) & (b.high[0] <= high[0]) & (low[1] <= b.low[1]) & (b.high[1] <= high[1]) &
             (low[2] <= b.low[2]) & (b.high[2] <= high[2]);
    }
    /// Makes it as large as needed to hold another box.
    void grow(const Box& b) {
      for (std::size_t k = 0; k < 3; ++k)
        low[k] = low[k] < b.low[k] ? low[k] : b.low[k], high[k] = high[k] > b.high[k] ? high[k] : b.high[k];
    }
  };

  /// The box of finite places.
  Box box_of(std::span<const Vec3> places) const;

  /// Starts from nothing but the triangles' corners. @param corners  of each item; those with a coordinate that is not
  /// finite have an empty box
  /// @throws Cancelled
  void build(std::span<const std::array<Vec3, 3>> corners, const Context& context);

  /// How many items there are, empty ones too.
  std::size_t size() const { return places_.size(); }
  /// The box of an item.
  const Box& box(std::uint32_t item) const { return slots_[places_[item].slot].box; }

  /// Gives an item another box; an empty one takes it out.
  void set(std::uint32_t item, const Box& box);

  /// Adds an item, whose index is `size()` before. @param beside  an item that it lies close to
  void add(std::uint32_t beside, const Box& box);

  /// Calls `visit(item)` for every item whose box overlaps `box`.
  template <class Visit>
  void overlapping(const Box& box, Visit visit) const {
    if (nodes_.empty() || !nodes_[1].overlaps(box)) return;
    std::uint32_t stack[64];
    int depth = 0;
    stack[depth++] = 1;
    const auto leaves = static_cast<std::uint32_t>(extra_.size());
    while (depth > 0) {
      const std::uint32_t node = stack[--depth];
      if (node >= leaves) {
        const std::uint32_t begin = (node - leaves) * leaf_size;
        for (std::uint32_t i = begin; i < begin + leaf_size; ++i)
          if (slots_[i].box.overlaps(box)) visit(slots_[i].item);
        for (std::uint32_t i = extra_[node - leaves]; i != none; i = slots_[i].next)
          if (slots_[i].box.overlaps(box)) visit(slots_[i].item);
        continue;
      }
      if (nodes_[2 * node + 1].overlaps(box)) stack[depth++] = 2 * node + 1;
      if (nodes_[2 * node].overlaps(box)) stack[depth++] = 2 * node;
    }
  }

 private:
  static constexpr float infinite = std::numeric_limits<float>::infinity();
  static constexpr std::uint32_t none = 0xffffffff;

  static constexpr std::uint32_t leaf_size = 4;
  struct Slot {
    Box box;
    std::uint32_t item = none;
    std::uint32_t next = none;  // of those that a leaf has beyond its own
  };

  Vec3 center_{0, 0, 0};              // boxes are kept relative to it
  std::vector<Box> nodes_;            // node k has the children 2k and 2k + 1; the root is 1
  std::vector<Slot> slots_;           // four for each leaf, then what was added
  std::vector<std::uint32_t> extra_;  // per leaf: the first slot that was added, or `none`
  struct Place {
    std::uint32_t slot, leaf;
  };
  std::vector<Place> places_;  // per item
};

}  // namespace tri

#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "meshops/pace.hpp"
#include "meshops/search/triangle_box.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A hierarchy of boxes, halved at the median of the longest side down to leaves of four: which boxes overlap a given
/// one. Queries may come from any thread.
class OverlapTree {
 public:
  /// An axis-aligned box; empty until it is grown.
  struct Box {
    Vec3 lo = Vec3(1, 1, 1) * std::numeric_limits<double>::infinity();     ///< least coordinates
    Vec3 hi = Vec3(-1, -1, -1) * std::numeric_limits<double>::infinity();  ///< greatest coordinates

    /// Makes it as large as needed to hold a point.
    void grow(const Vec3& p) { lo.minimize(p), hi.maximize(p); }
    /// Makes it as large as needed to hold another box.
    void grow(const Box& b) { lo.minimize(b.lo), hi.maximize(b.hi); }
    /// True if they have a place in common, their sides included.
    bool overlaps(const Box& b) const {
      for (int k = 0; k < 3; ++k)
        if (lo[k] > b.hi[k] || b.lo[k] > hi[k]) return false;
      return true;
    }
  };

  /// @param boxes  one per item; those that are not listed may be empty
  /// @param items  indices of the boxes that take part
  /// @param context  null: cannot be cancelled
  /// @throws Cancelled
  OverlapTree(std::vector<Box> boxes, std::vector<std::uint32_t> items, const Context* context = nullptr);

  /// All items, in the order of the tree.
  const std::vector<std::uint32_t>& items() const { return order_; }
  /// The box of an item.
  const Box& box(std::uint32_t item) const { return boxes_[item]; }

  /// Calls `visit(item)` for every item of index `from` or above whose box overlaps `box`.
  template <class Visit>
  void overlapping(const Box& box, std::uint32_t from, Visit visit) const {
    visit_boxes([&](const Box& other) { return other.overlaps(box); }, from, visit);
  }

  /// Calls `visit(item)` for every item whose box a triangle meets, and for some whose box it nearly meets. For a long
  /// triangle askew these are far fewer than the boxes that overlap its own.
  template <class Visit>
  void meeting(const TriangleBox& triangle, Visit visit) const {
    visit_boxes([&](const Box& other) { return triangle.may_meet(other.lo, other.hi); }, 0, visit);
  }

 private:
  struct Node {
    Box box;
    std::uint32_t first = 0, end = 0, right = 0;
    std::uint32_t last = 0;  ///< highest item index inside
  };

  template <class Meets, class Visit>
  void visit_boxes(const Meets& meets, std::uint32_t from, Visit& visit) const {
    if (nodes_.empty()) return;
    std::uint32_t stack[96];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t id = stack[--depth];
      const Node& node = nodes_[id];
      if (node.last < from || !meets(node.box)) continue;
      if (node.right == 0) {
        for (std::uint32_t i = node.first; i < node.end; ++i)
          if (order_[i] >= from && meets(boxes_[order_[i]])) visit(order_[i]);
      } else {
        stack[depth++] = node.right;
        stack[depth++] = id + 1;
      }
    }
  }

  std::uint32_t build(std::uint32_t first, std::uint32_t end, Pace& pace);

  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;
  std::vector<Node> nodes_;
};

}  // namespace tri

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "meshops/pace.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// An axis-aligned box.
struct Box {
  Vec3 low;   ///< least coordinates
  Vec3 high;  ///< greatest coordinates
};

/// A tree of boxes with four children a node, for searches of the nearest. Immutable; may be shared between threads.
class BoxTree {
 public:
  BoxTree() = default;
  /// @param boxes the box of each item; their index is what `search` hands over
  /// @param context  null: cannot be cancelled
  /// @throws Cancelled
  explicit BoxTree(const std::vector<Box>& boxes, const Context* context = nullptr);

  /// Hands over every item whose box is nearer than `limit()`, near ones first, roughly.
  /// @param limit returns the distance within which items still matter; it may shrink from one call to the next
  /// @param visit called with the item's index
  template <class Limit, class Visit>
  void search(const Vec3& p, Limit&& limit, Visit&& visit) const {
    search(
        p, limit, [](std::uint32_t) { return 0.0f; }, visit);
  }

  /// The same, with a closer bound than the box for each item: an item whose bound exceeds `limit()` is not handed
  /// over.
  /// @param bound called with the index of an item whose box is near enough; returns a distance, rounded down, that no
  /// part of the item goes below
  template <class Limit, class Bound, class Visit>
  void search(const Vec3& p, Limit&& limit, Bound&& bound, Visit&& visit) const {
    if (nodes_.empty()) return;
    const float x[3] = {static_cast<float>(p[0] - center_[0]), static_cast<float>(p[1] - center_[1]),
                        static_cast<float>(p[2] - center_[2])};
    // What rounding to float may have added to a distance.
    const float slack = 4e-7f * (radius_ + std::abs(x[0]) + std::abs(x[1]) + std::abs(x[2]));
    const auto squared_reach = [&] {
      const float reach = static_cast<float>(limit()) * (1 + 1e-6f) + slack;
      return std::min(reach * reach, std::numeric_limits<float>::max());
    };
    struct Entry {
      std::int32_t child;
      float distance2;
    };
    Entry stack[192];
    int top = 0;
    stack[top++] = {0, 0};
    float reach2 = squared_reach();
    while (top > 0) {
      const Entry entry = stack[--top];
      if (entry.distance2 > reach2) continue;
      if (entry.child < 0) {
        visit(static_cast<std::uint32_t>(~entry.child));
        reach2 = squared_reach();
        continue;
      }
      const Node& node = nodes_[entry.child];
      const Float4 zero{};
      Float4 d2 = zero;
      for (int c = 0; c < 3; ++c) {
        const Float4 below = node.low[c] - x[c], above = x[c] - node.high[c];
        Float4 d = below > above ? below : above;
        d = d > zero ? d : zero;
        d2 += d * d;
      }
      const int begin = top;
      for (int k = 0; k < 4; ++k) {
        if (!(d2[k] <= reach2)) continue;
        if (node.child[k] < 0) {
          const float least = bound(static_cast<std::uint32_t>(~node.child[k]));
          if (least * least > d2[k]) d2[k] = least * least;
          if (!(d2[k] <= reach2)) continue;
        }
        int at = top++;
        for (; at > begin && stack[at - 1].distance2 < d2[k]; --at) stack[at] = stack[at - 1];
        stack[at] = {node.child[k], d2[k]};
      }
    }
  }

  /// Hands over every item whose box the ray from `origin` along `direction` (any length) meets, in no order, until
  /// `visit(item)` returns true.
  /// @return whether it did
  template <class Visit>
  bool along_ray(const Vec3& origin, const Vec3& direction, Visit&& visit) const {
    if (nodes_.empty()) return false;
    const Vec3 from = origin - center_;
    std::int32_t stack[192];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const std::int32_t child = stack[--top];
      if (child < 0) {
        if (visit(static_cast<std::uint32_t>(~child))) return true;
        continue;
      }
      const Node& node = nodes_[child];
      for (int k = 0; k < 4; ++k) {
        double enter = 0, leave = std::numeric_limits<double>::infinity();
        for (int c = 0; c < 3; ++c) {
          const double low = node.low[c][k] - from[c], high = node.high[c][k] - from[c];
          if (direction[c] == 0) {
            if (low > 0 || high < 0) leave = -1;
            continue;
          }
          const double a = low / direction[c], b = high / direction[c];
          enter = std::max(enter, std::min(a, b));
          leave = std::min(leave, std::max(a, b));
        }
        if (enter <= leave * (1 + 1e-12) && std::isfinite(enter)) stack[top++] = node.child[k];
      }
    }
    return false;
  }

  /// Number of nodes, inner ones and leaves; 0 for an empty tree.
  std::size_t node_count() const { return nodes_.size(); }

 private:
  // Four at a time; the compiler does not find it by itself. Known to GCC and Clang on every machine.
  using Float4 = float __attribute__((vector_size(16)));
  struct Node {
    Float4 low[3], high[3];
    std::int32_t child[4];  // a node, or the complement of an item
  };

  std::int32_t build(const std::vector<Box>& boxes, std::uint32_t* begin, std::uint32_t* end, Pace& pace);

  std::vector<Node> nodes_;
  Vec3 center_{0, 0, 0};  // boxes are kept relative to it
  float radius_ = 0;
};

}  // namespace tri

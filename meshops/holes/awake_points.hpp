#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// Points each of which is awake or asleep: which of those that are awake lie in a box? A balanced k-d tree over all of
/// them whose nodes count the awake ones below. All are asleep at first.
class AwakePoints {
 public:
  /// @param points  finite; must outlive this object
  explicit AwakePoints(std::span<const Vec3> points);

  /// O(log n).
  void set(std::int32_t point, bool awake);

  /// The first awake point of the box, in an order that depends on the points alone, for which `matches(point)` is
  /// true; -1 if there is none.
  template <class Matches>
  std::int32_t find(const Vec3& low, const Vec3& high, Matches matches) const {
    std::uint32_t stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t id = stack[--depth];
      const Node& node = nodes_[id];
      if (node.awake == 0) continue;
      bool apart = false;
      for (int k = 0; k < 3; ++k) apart = apart || node.low[k] > high[k] || node.high[k] < low[k];
      if (apart) continue;
      if (id >= first_leaf_) {
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
          const std::int32_t point = order_[i];
          if (is_awake_[static_cast<std::size_t>(point)] && matches(point)) return point;
        }
      } else {
        stack[depth++] = 2 * id + 2;
        stack[depth++] = 2 * id + 1;
      }
    }
    return -1;
  }

 private:
  struct Node {
    Vec3 low, high;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t awake = 0;
  };
  void build(std::uint32_t id, std::uint32_t begin, std::uint32_t end);

  std::span<const Vec3> points_;
  std::vector<std::int32_t> order_;
  std::vector<std::uint32_t> leaf_of_;  ///< by point
  std::vector<char> is_awake_;          ///< by point
  std::vector<Node> nodes_;             ///< a complete binary tree; the children of i are 2 i + 1 and 2 i + 2
  std::uint32_t first_leaf_ = 0;
};

}  // namespace tri

#pragma once

#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// Points for searches by distance, in a balanced tree: ranges are split at their middle in the direction in which they
/// are widest.
class PointTree {
 public:
  explicit PointTree(std::vector<Vec3> points);

  /// Calls `visit(index)` for every point within `radius` of `center`, in an order that depends on the points alone.
  template <class Visit>
  void within(const Vec3& center, double radius, Visit&& visit) const {
    search(0, order_.size(), center, radius, visit);
  }

 private:
  void build(std::size_t begin, std::size_t end);

  template <class Visit>
  void search(std::size_t begin, std::size_t end, const Vec3& center, double radius, Visit& visit) const {
    if (begin >= end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Vec3& p = points_[order_[middle]];
    if ((p - center).sqrnorm() <= radius * radius) visit(order_[middle]);
    if (end - begin == 1) return;
    const double ahead = center[axis_[middle]] - p[axis_[middle]];
    if (ahead <= radius) search(begin, middle, center, radius, visit);
    if (ahead >= -radius) search(middle + 1, end, center, radius, visit);
  }

  std::vector<Vec3> points_;
  std::vector<int> order_;
  std::vector<char> axis_;
};

}  // namespace tri

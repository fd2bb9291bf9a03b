#include "meshops/point_tree.hpp"

#include <algorithm>
#include <numeric>

namespace tri {

PointTree::PointTree(std::vector<Vec3> points)
    : points_(std::move(points)), order_(points_.size()), axis_(points_.size(), 0) {
  std::iota(order_.begin(), order_.end(), 0);
  build(0, order_.size());
}

void PointTree::build(std::size_t begin, std::size_t end) {
  if (end - begin < 2) return;
  Vec3 low = points_[order_[begin]], high = low;
  for (std::size_t i = begin; i < end; ++i) low.minimize(points_[order_[i]]), high.maximize(points_[order_[i]]);
  const Vec3 size = high - low;
  const char axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  const std::size_t middle = begin + (end - begin) / 2;
  std::nth_element(
      order_.begin() + static_cast<std::ptrdiff_t>(begin), order_.begin() + static_cast<std::ptrdiff_t>(middle),
      order_.begin() + static_cast<std::ptrdiff_t>(end),
      [&](int a, int b) { return points_[a][axis] != points_[b][axis] ? points_[a][axis] < points_[b][axis] : a < b; });
  axis_[middle] = axis;
  build(begin, middle);
  build(middle + 1, end);
}

}  // namespace tri

#include "meshops/holes/awake_points.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tri {

namespace {
constexpr std::uint32_t leaf_size = 8;
}

AwakePoints::AwakePoints(std::span<const Vec3> points)
    : points_(points), order_(points.size()), leaf_of_(points.size()), is_awake_(points.size(), 0) {
  const auto n = static_cast<std::uint32_t>(points.size());
  std::uint32_t leaves = 1;
  while (leaves * leaf_size < n) leaves *= 2;
  first_leaf_ = leaves - 1;
  nodes_.resize(2 * leaves - 1);
  std::iota(order_.begin(), order_.end(), 0);
  build(0, 0, n);
}

void AwakePoints::build(std::uint32_t id, std::uint32_t begin, std::uint32_t end) {
  Node& node = nodes_[id];
  node.begin = begin;
  node.end = end;
  const double infinity = std::numeric_limits<double>::infinity();
  node.low = Vec3(infinity, infinity, infinity);
  node.high = -node.low;
  for (std::uint32_t i = begin; i < end; ++i) {
    node.low.minimize(points_[order_[i]]);
    node.high.maximize(points_[order_[i]]);
  }
  if (id >= first_leaf_) {
    for (std::uint32_t i = begin; i < end; ++i) leaf_of_[order_[i]] = id;
    return;
  }
  const Vec3 size = node.high - node.low;
  const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     const double x = points_[a][axis], y = points_[b][axis];
                     return x < y || (x == y && a < b);
                   });
  build(2 * id + 1, begin, middle);
  build(2 * id + 2, middle, end);
}

void AwakePoints::set(std::int32_t point, bool awake) {
  if (static_cast<bool>(is_awake_[point]) == awake) return;
  is_awake_[point] = awake;
  const std::uint32_t step = awake ? 1u : 0xffffffffu;
  for (std::uint32_t id = leaf_of_[point];; id = (id - 1) / 2) {
    nodes_[id].awake += step;
    if (id == 0) break;
  }
}

}  // namespace tri

#include "libtri/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "meshops/closest_on_triangle.hpp"

namespace tri {
namespace {

constexpr std::size_t leaf_size = 4;

// Moeller & Trumbore 1997, both sides.
bool ray_meets(const std::array<Vec3, 3>& t, const Vec3& origin, const Vec3& direction) {
  const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = direction % e2;
  const double det = e1 | p;
  if (det == 0) return false;
  const Vec3 s = origin - t[0];
  const double u = (s | p) / det;
  if (u < 0 || u > 1) return false;
  const Vec3 q = s % e1;
  const double v = (direction | q) / det;
  return v >= 0 && u + v <= 1 && (e2 | q) / det > 0;
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  if (triangles.empty()) return;
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Vec3> centres;
  centres.reserve(triangles.size());
  corners_.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    corners_.push_back({points[t[0]], points[t[1]], points[t[2]]});
    centres.push_back((points[t[0]] + points[t[1]] + points[t[2]]) / 3.0);
  }
  nodes_.emplace_back();
  split(0, order, 0, centres);
  std::vector<std::array<Vec3, 3>> sorted;
  sorted.reserve(order.size());
  for (const std::uint32_t t : order) sorted.push_back(corners_[t]);
  corners_ = std::move(sorted);
}

void TriangleTree::split(std::uint32_t node, std::span<std::uint32_t> order, std::uint32_t offset,
                         std::span<const Vec3> centres) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low(infinity), high(-infinity), centre_low(infinity), centre_high(-infinity);
  for (const std::uint32_t t : order) {
    for (const Vec3& p : corners_[t]) {
      low.minimize(p);
      high.maximize(p);
    }
    centre_low.minimize(centres[t]);
    centre_high.maximize(centres[t]);
  }
  nodes_[node] = {low, high, offset, static_cast<std::uint32_t>(order.size())};
  if (order.size() <= leaf_size) return;
  const Vec3 extent = centre_high - centre_low;
  const int axis = int(std::max_element(extent.data(), extent.data() + 3) - extent.data());
  const std::size_t half = order.size() / 2;
  std::nth_element(order.begin(), order.begin() + half, order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
  });
  const auto child = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = child;
  nodes_[node].count = 0;
  split(child, order.first(half), offset, centres);
  split(child + 1, order.subspan(half), offset + static_cast<std::uint32_t>(half), centres);
}

bool TriangleTree::hit(const Vec3& origin, const Vec3& direction) const {
  if (nodes_.empty()) return false;
  std::uint32_t stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    double enter = 0, leave = std::numeric_limits<double>::infinity();
    bool outside = false;
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0) {
        outside |= origin[k] < node.low[k] || origin[k] > node.high[k];
        continue;
      }
      const double a = (node.low[k] - origin[k]) / direction[k], b = (node.high[k] - origin[k]) / direction[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (outside || enter > leave * (1 + 1e-12)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = node.first + 1;
      continue;
    }
    for (std::uint32_t t = node.first; t < node.first + node.count; ++t) {
      if (ray_meets(corners_[t], origin, direction)) return true;
    }
  }
  return false;
}

bool TriangleTree::nearer_than(const Vec3& point, double distance) const {
  if (nodes_.empty()) return false;
  const double limit = distance * distance;
  std::uint32_t stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    double gap = 0;
    for (int k = 0; k < 3; ++k) {
      const double d = std::max({node.low[k] - point[k], point[k] - node.high[k], 0.0});
      gap += d * d;
    }
    if (gap >= limit) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = node.first + 1;
      continue;
    }
    for (std::uint32_t t = node.first; t < node.first + node.count; ++t) {
      if ((closest_on_triangle(corners_[t], point) - point).sqrnorm() < limit) return true;
    }
  }
  return false;
}

}  // namespace tri

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/soup.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A tree of bounding boxes over triangles, for two yes-or-no questions. Immutable; may be shared between threads.
class TriangleTree {
 public:
  /// Every index of `triangles` is below points.size(). Copies what it needs. Degenerate triangles are allowed.
  TriangleTree(std::span<const Vec3> points, std::span<const Triangle> triangles);

  /// True if the ray from `origin` along `direction` (any length) meets a triangle, from either side.
  bool hit(const Vec3& origin, const Vec3& direction) const;
  /// True if a triangle is nearer to `point` than `distance` (> 0).
  bool nearer_than(const Vec3& point, double distance) const;

 private:
  struct Node {
    Vec3 low, high;
    std::uint32_t first,
        count;  // leaf: triangles [first, first + count); inner (count 0): children first and first + 1
  };
  void split(std::uint32_t node, std::span<std::uint32_t> order, std::uint32_t offset, std::span<const Vec3> centres);

  std::vector<Node> nodes_;
  std::vector<std::array<Vec3, 3>> corners_;  // in the order of the leaves
};

}  // namespace tri

#pragma once

#include <array>
#include <span>
#include <vector>

#include "meshops/search/box_tree.hpp"
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
  BoxTree tree_;
  std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace tri

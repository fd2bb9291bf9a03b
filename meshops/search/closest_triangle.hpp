#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/search/box_tree.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Finds for a point the nearest of many triangles: a tree of boxes, and the exact distance to the triangles in them.
/// Immutable; may be shared between threads.
class ClosestTriangle {
 public:
  /// What is closest.
  struct Hit {
    double distance = 0;         ///< to the triangle
    Vec3 point{0, 0, 0};         ///< of the triangle
    std::uint32_t triangle = 0;  ///< index into the triangles given
  };

  /// Copies what it needs: some 140 bytes a triangle. Degenerate triangles take part.
  /// @param triangles  at least one; every index is below points.size()
  /// @throws InvalidInput if there is no triangle or a used coordinate is not finite
  /// @param context  null: cannot be cancelled @throws Cancelled
  ClosestTriangle(std::span<const Vec3> points, std::span<const Triangle> triangles, const Context* context = nullptr);

  /// @param p     finite
  /// @param hint  a triangle that may be near, say the last result for a point close by: makes the search faster
  Hit closest(const Vec3& p, std::uint32_t hint = 0) const;

  /// The corners of a triangle, by its index in the soup.
  const std::array<Vec3, 3>& corners(std::uint32_t triangle) const { return corners_[triangle]; }

 private:
  std::vector<std::array<Vec3, 3>> corners_;
  BoxTree tree_;
};

}  // namespace tri

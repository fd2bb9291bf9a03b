#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/search/closest_triangle.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Tells on which side of an oriented surface a place is, from the closest point of the surface.
///
/// The direction from the closest point is compared with the normal of its triangle, on an edge with the sum of the
/// normals of all its triangles, at a vertex with their sum weighted by angle: for a closed surface that bounds a solid
/// this is right everywhere [Baerentzen & Aanaes 2005]. Vertices at the same place are one. Immutable; may be shared
/// between threads.
class SurfaceSide {
 public:
  /// Copies what it needs. @param triangles  every index is below points.size()
  /// @param context  null: cannot be cancelled @throws Cancelled
  SurfaceSide(std::span<const Vec3> points, std::span<const Triangle> triangles, const Context* context = nullptr);

  /// 1 on the side that the triangles face, -1 on the other; 1 where the two cannot be told apart.
  /// @param hit  the closest point of `place`, found by a ClosestTriangle of the same surface
  double side(const Vec3& place, const ClosestTriangle::Hit& hit) const;

  /// What the direction to a place is compared with; not of unit length, (0,0,0) where triangles have no area.
  Vec3 normal(const ClosestTriangle::Hit& hit) const;

 private:
  struct Edge {
    std::uint64_t key;
    Vec3 normal;
  };
  std::vector<Vec3> points_;
  std::vector<Triangle> triangles_;  // of the lowest vertices at their places
  std::vector<Vec3> vertex_normals_;
  std::vector<Edge> edges_;  // ascending
};

}  // namespace tri

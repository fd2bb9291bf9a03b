#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "meshops/editing/attribute_snapshot.hpp"
#include "meshops/editing/mesh_before.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/search/closest_triangle.hpp"

namespace tri {

/// Barycentric coordinates of the foot of a place in the plane of a triangle; a place far beside it counts as nearer,
/// within a quarter. They sum to 1; (1, 0, 0) if the triangle has no area.
std::array<double, 3> triangle_weights(const std::array<Vec3, 3>& triangle, const Vec3& p);

/// Values of vertices and corners, from the surface on which they lay before a mesh was changed.
class PlaceValues {
 public:
  /// @param mesh    as it is before the change
  /// @param before  the same; outlives this object
  PlaceValues(MeshView mesh, const MeshBefore& before);

  /// Gives vertices and corners that moved or are new the values that the surface had where they lie now.
  /// @param surface     of `before`
  /// @param near        per vertex of the mesh as it is now: a triangle that may be close
  /// @param on_line     whether a vertex may lie on a seam: then each corner takes the values on its own side
  /// @param checkpoint  called now and then; may throw, and the values are as far as they were carried
  void carry(MeshView now, const ClosestTriangle& surface, const std::vector<std::uint32_t>& near,
             const std::function<bool(VertexHandle)>& on_line, const std::function<void()>& checkpoint);

 private:
  const MeshBefore& before_;
  AttributeSnapshot values_;
  std::vector<std::size_t> corners_;  // three half-edges per triangle, if corners have values
};

}  // namespace tri

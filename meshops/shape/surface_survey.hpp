#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/search/closest_triangle.hpp"

namespace tri {

/// What the triangles of a mesh are like.
struct SurfaceSurvey {
  std::size_t faces = 0;                     ///< that are not deleted
  double smallest_angle = std::numbers::pi;  ///< radians, of all triangles
  /// Model units: of vertices, middles of edges and of triangles to the other surface.
  double greatest_distance = 0;
};

/// Looks at all triangles. Parallel; the same for any number of threads.
/// @param other  a surface to measure the distance to
/// @param near   per vertex of the mesh: a triangle of it that may be close
/// @throws Cancelled
SurfaceSurvey survey_surface(MeshView mesh, const ClosestTriangle& other, const std::vector<std::uint32_t>& near,
                             const Context& context);

}  // namespace tri

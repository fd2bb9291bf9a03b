#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meshops/soup.hpp"

namespace tri {

/// Measured points connected to a manifold surface: what every method of triangulation yields before it becomes a mesh.
struct PointMesh {
  std::vector<Triangle> triangles;                     ///< 0-based indices of measured points
  std::vector<std::array<std::int32_t, 3>> neighbors;  ///< triangle across the edge opposite corner k; -1 on the
                                                       ///< boundary
};

}  // namespace tri

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libtri/registration.hpp"
#include "libtri/triangulation/point_mesh.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Flips edges of triangles that cross others while that lowers the number of crossing pairs. No point moves, the
/// topology keeps, and no triangle is turned against the model for it. Crossings between parts that no triangles
/// connect are left alone: solids that touch cross each other wherever there is noise, and no flip cures that.
///
/// @param points  mm, measured positions
/// @param feet    one per point, for the model's normals
/// @return the pairs that still cross, as `self_intersections` gives them; none if all could be undone
/// @throws Cancelled; the mesh is then valid, with some of the flips made
std::vector<std::array<std::uint32_t, 2>> untangle(std::span<const Vec3> points, std::span<const Foot> feet,
                                                   PointMesh& mesh, const Context& context);

}  // namespace tri

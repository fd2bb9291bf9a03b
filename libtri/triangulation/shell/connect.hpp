#pragma once

#include <span>
#include <string>
#include <vector>

#include "libtri/model/tessellation.hpp"
#include "libtri/registration.hpp"
#include "libtri/triangulation/point_mesh.hpp"

namespace tri {

struct ShellConnection {
  PointMesh mesh;
  std::size_t open_stars = 0;   ///< vertices of the model that could not be removed; their triangles are left out
  std::size_t lost_shells = 0;  ///< connected parts of the model that got no point and are not in the mesh
};

/// Connects registered points by the model's own sewn triangulation: inserts them at their feet, makes the
/// triangulation Delaunay on the surface, and removes every vertex of the model, cheapest first. The result has the
/// topology of the tessellation wherever there are points.
///
/// @param feet  one per point; those with face < 0 are left out
/// @throws Cancelled
ShellConnection connect_by_shell(const CadModel& model, const Tessellation& tessellation, std::span<const Foot> feet,
                                 Context& context);

}  // namespace tri

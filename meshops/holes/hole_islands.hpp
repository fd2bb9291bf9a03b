#pragma once

#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/holes/hole.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// Which rims of sheets lie within a hole, so that its filling has to go round them.
///
/// An island is in a hole if each vertex of its rim is nearer to the filling that the hole would get without it than
/// 0.7 of its distance to the nearest vertex of the hole's rim (seen from the rim it rises by less than 45 degrees),
/// and the island's faces along the rim look the way the filling does (mean cosine above 0.5). Of several such holes it
/// is in the one whose rim is nearest.
/// @param holes  before islands are joined
/// @param islands  the outer rims of sheets, as boundary half-edges
/// @return for each island the index of its hole, or -1
/// @throws Cancelled between holes and inside long ones
std::vector<int> find_hole_islands(MeshView mesh, std::span<const Hole> holes,
                                   std::span<const std::vector<HalfedgeHandle>> islands, const Context& context);

}  // namespace tri

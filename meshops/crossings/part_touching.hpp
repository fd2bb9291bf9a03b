#pragma once

#include <cstddef>

#include "meshops/context.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Moves vertices that lie in the place of others by a little, in single precision: into their own side of the surface
/// first, then any way.
///
/// A vertex moves only if then each of its triangles has an area, faces the same half-space as before, and meets no
/// triangle in more than the corners and sides that they share by place; tested exactly. Of those in one place all may
/// move but the last.
/// @param soup      every coordinate a float
/// @param farthest  model units: no vertex moves farther; up to 52 directions and 17 lengths up to there are tried for
/// each
/// @param report    `vertices_moved` is counted up
/// @return how many vertices moved
/// @throws Cancelled; some have moved then
std::size_t part_touching_vertices(Soup& soup, double farthest, Report& report, Context& context);

}  // namespace tri

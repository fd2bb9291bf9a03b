#pragma once

#include <span>

#include "libtri/model/tessellation.hpp"
#include "libtri/registration.hpp"
#include "libtri/triangulation/shell/edit_mesh.hpp"

namespace tri {

/// Inserts every registered point at its foot into the tessellation: planar Delaunay inside each original triangle.
///
/// @param feet    one per point; feet with face < 0 are left out
/// @return a mesh whose vertices are those of the tessellation, in their order, followed by one per inserted point, in
/// the
///         order of the points; positions of points are their feet. Topology is that of the tessellation.
/// Where two edges of the tessellation join the same two vertices, all but one are split by a further vertex, which is
/// added at the end: every edge is then told by its ends.
/// @throws Cancelled
EditMesh insert_feet(const CadModel& model, const Tessellation& tessellation, std::span<const Foot> feet,
                     Context& context);

}  // namespace tri

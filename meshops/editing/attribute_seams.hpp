#pragma once

#include <cstdint>
#include <vector>

#include "meshops/mesh_view.hpp"

namespace tri {

/// Edges along which an attribute jumps, for operators that keep such lines: one byte per edge, 1 for a seam; empty if
/// the mesh has no attribute that can jump.
///
/// Attributes that can: corner values (properties "h:NAME"), which jump where the two triangles of an edge have
/// different ones at one of its ends; and face properties "f:NAME" that count (integers, names) or have labels, as
/// groups and materials do, which jump where the two triangles have different ones. Boundary edges are no seams, and
/// types that `PropertyTypes::standard` does not know are left out. Linear time.
std::vector<std::uint8_t> attribute_seams(MeshView mesh);

}  // namespace tri

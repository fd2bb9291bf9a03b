#pragma once

#include "meshops/mesh_view.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// The reverse of `build_mesh`: vertices and faces that are not deleted, in order, and their attributes.
///
/// Isolated vertices stay. Properties "v:NAME", "f:NAME" and "h:NAME" (half-edges for the corners in which they end) of type double, float or int become scalars NAME, "v:uv"
/// becomes `u` and `v`, `property::labels` the face labels; OpenMesh's normals and colours theirs. Properties of other types and unnamed ones have no place
/// in a soup.
Soup to_soup(const MeshView& view);

}  // namespace tri

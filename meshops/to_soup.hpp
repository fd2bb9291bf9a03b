#pragma once

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// The reverse of `build_mesh`: vertices and faces that are not deleted, in order, and their attributes.
///
/// Isolated vertices stay. Properties "v:NAME", "f:NAME" and "h:NAME" (half-edges for the corners in which they end) of
/// any type of number, or bool, become scalars NAME; vectors of two to six numbers (OpenMesh's and Eigen's) become
/// scalars NAME_0, NAME_1, …, but "uv" becomes `u` and `v`, OpenMesh's "texcoords2D" `s` and `t`. Whole numbers beyond
/// 2^53 are rounded. OpenMesh's colours become vertex colours in [0,255] and, where any is not opaque, the scalar
/// `alpha`; floating-point colours in [0,1] are scaled and rounded, others are carried as vectors are. Face colours
/// become `red`, `green`, `blue` (and `alpha`). Normals of vertices become vertex normals; those of faces follow from
/// the triangles and are left out. `property::labels` become the face labels. Text, handles, traits of the kernel,
/// properties of edges and properties without a name of this kind have no place in a soup.
///
/// @param view  is only read; a kernel without status attributes has nothing deleted
/// @param context  null: cannot be cancelled
/// @throws Cancelled
Soup to_soup(const MeshView& view, const Context* context = nullptr);

}  // namespace tri

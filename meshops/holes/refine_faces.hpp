#pragma once

#include <functional>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/editing/add_faces.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// Refines triangles until they are as small as those around them [Liepa 2003, "Filling holes in meshes", section 4].
///
/// A triangle gets a vertex in its middle unless that would be nearer to a corner than 1 / sqrt(2) of the edge length
/// wanted there; edges between the triangles are flipped to be Delaunay, unless that folds the surface or doubles an
/// edge. The length wanted at the outer vertices is the mean of their edges that have a triangle outside; inwards it
/// grows by `growth` for each unit of distance. Vertices and edges that were there stay, edges between two of the faces
/// are flipped. New elements inherit as `split_face` says.
/// @param faces  each once; new ones are appended
/// @param growth  0 and above; with 0 the number of triangles grows with the area, else with the length of the rim
/// @param crossings  if not empty: how many things a triangle runs into; an edge is not flipped where that makes it
/// more
/// @return the new vertices
/// @throws Cancelled between triangles; the mesh is valid then, and `faces` complete
std::vector<VertexHandle> refine_faces(MeshView mesh, std::vector<FaceHandle>& faces, double growth,
                                       const std::function<int(const VertexTriple&)>& crossings,
                                       const Context& context);

}  // namespace tri

#pragma once

#include <span>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/triangulation/patches/face_patch.hpp"
#include "libtri/triangulation/shell/edit_mesh.hpp"

namespace tri {

/// Joins the patches of all faces along the edges they share, by the edges' chains, into one mesh with the topology of
/// the model.
///
/// A side that is not shared by exactly two triangles running against each other stays open. Triangles that a pole has
/// made degenerate are dropped. Where several fans of triangles meet in a vertex, all but the first get a copy of it
/// that stands for no measured point; where two edges join the same two vertices, one is split by a new vertex. Shared
/// edges of the model are creases of the mesh.
/// @param vertices  of the mesh; those that no triangle uses keep `vertex_triangle` -1
/// @param join_faces  false: faces are joined to themselves only, along their seams
/// @param on_chain  per vertex: whether it may be on the chain of an edge
EditMesh glue_patches(const CadModel& model, const std::vector<FacePatch>& patches,
                      const std::vector<std::size_t>& chain_sizes, std::vector<EditMesh::Vertex> vertices,
                      const std::vector<std::uint8_t>& on_chain, bool join_faces);

}  // namespace tri

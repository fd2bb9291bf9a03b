#pragma once

#include "meshops/mesh_view.hpp"

namespace tri {

/// Copies the values of a corner (properties "h:NAME" of the half-edge that ends in it, but for its status) to another one.
inline void copy_corner_values(OpenMesh::TriConnectivity& mesh, HalfedgeHandle from, HalfedgeHandle to) {
  for (auto it = mesh.hprops_begin(); it != mesh.hprops_end(); ++it)
    if (*it && (*it)->name().starts_with("h:") && (*it)->name() != "h:status")
      (*it)->copy(static_cast<std::size_t>(from.idx()), static_cast<std::size_t>(to.idx()));
}

/// Flips an edge; the two corners that get new vertices take over what corners there had in the triangle beyond.
/// @param edge with two triangles, whose other diagonal is no edge yet
inline void flip_edge(OpenMesh::TriConnectivity& mesh, EdgeHandle edge) {
  for (const int side : {0, 1}) {
    const HalfedgeHandle h = mesh.halfedge_handle(edge, static_cast<unsigned>(side));
    copy_corner_values(mesh, mesh.next_halfedge_handle(h), h);
  }
  mesh.flip(edge);
}

}  // namespace tri

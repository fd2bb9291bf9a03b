#pragma once

#include "meshops/editing/change_segment.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

inline std::size_t index_of(OpenMesh::BaseHandle handle) {
  return static_cast<std::size_t>(handle.idx());
}

/// Calls `function(OpenMesh::BaseProperty&)` for every property of corners ("h:NAME", but for the status): the value of
/// a half-edge belongs to the corner in which it ends.
template <class Function>
void for_each_corner_property(OpenMesh::TriConnectivity& mesh, const Function& function) {
  for (auto it = mesh.hprops_begin(); it != mesh.hprops_end(); ++it)
    if (*it && (*it)->name().starts_with("h:") && (*it)->name() != "h:status") function(**it);
}

/// Copies the values of a corner to another one.
inline void copy_corner_values(OpenMesh::TriConnectivity& mesh, HalfedgeHandle from, HalfedgeHandle to) {
  for_each_corner_property(mesh,
                           [&](OpenMesh::BaseProperty& property) { property.copy(index_of(from), index_of(to)); });
}

/// Sets all values of a new element, but for its status, from those of another one, or to initial ones if that is
/// invalid.
template <class Handle>
void inherit_values(MeshView view, ElementKind kind, Handle from, Handle to) {
  const OpenMesh::BaseProperty* const status = &view.mesh.property(view.mesh.status_pph(to));
  const WeightedIndex source{index_of(from), 1};
  for (OpenMesh::BaseProperty* property : property_slots(view.mesh, kind))
    if (property && property != status)
      view.policy->inherit(*property, std::span(&source, from.is_valid() ? 1 : 0), index_of(to));
}

/// Initial values for a new edge and its half-edges.
inline void initialise_edge(MeshView view, EdgeHandle e) {
  inherit_values(view, ElementKind::edge, EdgeHandle(), e);
  for (const unsigned side : {0u, 1u})
    inherit_values(view, ElementKind::halfedge, HalfedgeHandle(), view.mesh.halfedge_handle(e, side));
}

}  // namespace tri

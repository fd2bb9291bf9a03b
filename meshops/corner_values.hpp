#pragma once

#include "meshops/mesh_view.hpp"

namespace tri {

/// Calls `function(OpenMesh::BaseProperty&)` for every property of corners ("h:NAME", but for the status): the value of a
/// half-edge belongs to the corner in which it ends.
template <class Function>
void for_each_corner_property(OpenMesh::TriConnectivity& mesh, const Function& function) {
  for (auto it = mesh.hprops_begin(); it != mesh.hprops_end(); ++it)
    if (*it && (*it)->name().starts_with("h:") && (*it)->name() != "h:status") function(**it);
}

/// Copies the values of a corner to another one.
inline void copy_corner_values(OpenMesh::TriConnectivity& mesh, HalfedgeHandle from, HalfedgeHandle to) {
  for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
    property.copy(static_cast<std::size_t>(from.idx()), static_cast<std::size_t>(to.idx()));
  });
}

}  // namespace tri

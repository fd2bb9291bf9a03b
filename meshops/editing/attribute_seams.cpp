#include "meshops/editing/attribute_seams.hpp"

#include <string>

#include "meshops/editing/label_property.hpp"
#include "meshops/editing/new_values.hpp"
#include "meshops/editing/property_types.hpp"

namespace tri {
namespace {

std::size_t number_of(OpenMesh::BaseHandle handle) {
  return static_cast<std::size_t>(handle.idx());
}

/// Marks the edges at which `jumps(left, right)` holds for their two half-edges.
template <class Jumps>
void mark(const OpenMesh::TriConnectivity& mesh, std::vector<std::uint8_t>& seams, const Jumps& jumps) {
  if (seams.empty()) seams.assign(mesh.n_edges(), 0);
  for (std::size_t i = 0; i < mesh.n_edges(); ++i) {
    const EdgeHandle e(static_cast<int>(i));
    if (seams[i] || mesh.status(e).deleted() || mesh.is_boundary(e)) continue;
    seams[i] = jumps(mesh.halfedge_handle(e, 0), mesh.halfedge_handle(e, 1));
  }
}

/// Whether a face property divides the mesh into regions.
bool divides(const OpenMesh::TriConnectivity& mesh, const std::string& property) {
  for (const char* name : {"f:cad_face", "f:group", "f:material", "f:object"})
    if (property == name) return true;
  for (auto it = mesh.mprops_begin(); it != mesh.mprops_end(); ++it)
    if (*it && (*it)->name() == property::labels + property.substr(2)) return true;
  return false;
}

}  // namespace

std::vector<std::uint8_t> attribute_seams(MeshView view) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  std::vector<std::uint8_t> seams;
  const PropertyTypes& types = PropertyTypes::standard();
  for_each_corner_property(view.mesh, [&](const OpenMesh::BaseProperty& property) {
    const PropertyType* type = types.find(property);
    if (!type) return;
    mark(mesh, seams, [&](HalfedgeHandle left, HalfedgeHandle right) {
      // The corner in which a half-edge ends, and that of the same vertex in the triangle beyond.
      return !type->equal(property, number_of(left), number_of(mesh.prev_halfedge_handle(right))) ||
             !type->equal(property, number_of(right), number_of(mesh.prev_halfedge_handle(left)));
    });
  });
  for (auto it = mesh.fprops_begin(); it != mesh.fprops_end(); ++it) {
    if (!*it || !(*it)->name().starts_with("f:") || !divides(mesh, (*it)->name())) continue;
    const OpenMesh::BaseProperty& property = **it;
    const PropertyType* type = types.find(property);
    if (!type) continue;
    mark(mesh, seams, [&](HalfedgeHandle left, HalfedgeHandle right) {
      return !type->equal(property, number_of(mesh.face_handle(left)), number_of(mesh.face_handle(right)));
    });
  }
  return seams;
}

}  // namespace tri

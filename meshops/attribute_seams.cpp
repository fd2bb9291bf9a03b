#include "meshops/attribute_seams.hpp"

#include <string>

#include "meshops/label_property.hpp"

namespace tri {
namespace {

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

template <class T>
bool mark_corners(const OpenMesh::TriConnectivity& mesh, const OpenMesh::BaseProperty* base,
                  std::vector<std::uint8_t>& seams) {
  const auto* values = dynamic_cast<const OpenMesh::PropertyT<T>*>(base);
  if (!values) return false;
  mark(mesh, seams, [&](HalfedgeHandle left, HalfedgeHandle right) {
    // The corner in which a half-edge ends, and that of the same vertex in the triangle beyond.
    return (*values)[left.idx()] != (*values)[mesh.prev_halfedge_handle(right).idx()] ||
           (*values)[right.idx()] != (*values)[mesh.prev_halfedge_handle(left).idx()];
  });
  return true;
}

template <class T>
void mark_faces(const OpenMesh::TriConnectivity& mesh, const OpenMesh::BaseProperty* base,
                std::vector<std::uint8_t>& seams) {
  const auto* values = dynamic_cast<const OpenMesh::PropertyT<T>*>(base);
  if (!values) return;
  mark(mesh, seams, [&](HalfedgeHandle left, HalfedgeHandle right) {
    return (*values)[mesh.face_handle(left).idx()] != (*values)[mesh.face_handle(right).idx()];
  });
}

bool has_labels(const OpenMesh::TriConnectivity& mesh, const std::string& name) {
  for (auto it = mesh.mprops_begin(); it != mesh.mprops_end(); ++it)
    if (*it && (*it)->name() == property::labels + name) return true;
  return false;
}

}  // namespace

std::vector<std::uint8_t> attribute_seams(MeshView view) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  std::vector<std::uint8_t> seams;
  for (auto it = mesh.hprops_begin(); it != mesh.hprops_end(); ++it) {
    const OpenMesh::BaseProperty* p = *it;
    if (!p || !p->name().starts_with("h:") || p->name() == "h:status") continue;
    mark_corners<double>(mesh, p, seams) || mark_corners<float>(mesh, p, seams) || mark_corners<int>(mesh, p, seams) ||
        mark_corners<OpenMesh::Vec2f>(mesh, p, seams) || mark_corners<OpenMesh::Vec2d>(mesh, p, seams) ||
        mark_corners<OpenMesh::Vec3f>(mesh, p, seams) || mark_corners<OpenMesh::Vec3d>(mesh, p, seams);
  }
  for (auto it = mesh.fprops_begin(); it != mesh.fprops_end(); ++it) {
    const OpenMesh::BaseProperty* p = *it;
    if (!p || !p->name().starts_with("f:")) continue;
    mark_faces<int>(mesh, p, seams);
    if (has_labels(mesh, p->name().substr(2))) mark_faces<double>(mesh, p, seams);
  }
  return seams;
}

}  // namespace tri

#include "meshops/selection.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "meshops/error.hpp"

namespace tri {
namespace {

std::size_t element_index(OpenMesh::BaseHandle handle) {
  return static_cast<std::size_t>(handle.idx());
}

template <class Handle>
void check(const OpenMesh::TriConnectivity& mesh, Handle handle, std::size_t count, const char* kind) {
  if (!handle.is_valid() || element_index(handle) >= count)
    throw InvalidInput(fmt::format("selection: {} {} is not of this mesh, which has {}", kind, handle.idx(), count));
  bool deleted = false;
  if constexpr (std::is_same_v<Handle, FaceHandle>) deleted = mesh.has_face_status() && mesh.status(handle).deleted();
  if constexpr (std::is_same_v<Handle, VertexHandle>)
    deleted = mesh.has_vertex_status() && mesh.status(handle).deleted();
  if constexpr (std::is_same_v<Handle, HalfedgeHandle>)
    deleted = mesh.has_edge_status() && mesh.status(mesh.edge_handle(handle)).deleted();
  if (deleted) throw InvalidInput(fmt::format("selection: {} {} is deleted", kind, handle.idx()));
}

template <class Action>
void for_each_corner(const OpenMesh::TriConnectivity& mesh, FaceHandle f, const Action& action) {
  HalfedgeHandle h = mesh.halfedge_handle(f);
  for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) action(mesh.to_vertex_handle(h));
}

template <class Handle, class Count>
std::vector<Handle> with_status(const OpenMesh::TriConnectivity& mesh, Count count) {
  std::vector<Handle> handles;
  for (std::size_t i = 0; i < count; ++i) {
    const Handle handle(static_cast<int>(i));
    if (mesh.status(handle).selected() && !mesh.status(handle).deleted()) handles.push_back(handle);
  }
  return handles;
}

}  // namespace

Selection::Selection(const OpenMesh::TriConnectivity& mesh)
    : faces_(mesh.n_faces(), 0), vertices_(mesh.n_vertices(), 0), rim_(mesh.n_vertices(), 0) {}

Selection Selection::of_faces(const OpenMesh::TriConnectivity& mesh, std::span<const FaceHandle> faces) {
  Selection selection(mesh);
  for (const FaceHandle f : faces) {
    check(mesh, f, mesh.n_faces(), "face");
    selection.faces_[element_index(f)] = 1;
    for_each_corner(
        mesh, f, [&](VertexHandle v) { selection.vertices_[element_index(v)] = selection.rim_[element_index(v)] = 1; });
  }
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) {
    const FaceHandle f(static_cast<int>(i));
    if (selection.faces_[i] || (mesh.has_face_status() && mesh.status(f).deleted())) continue;
    for_each_corner(mesh, f, [&](VertexHandle v) { selection.vertices_[element_index(v)] = 0; });
  }
  return selection;
}

Selection Selection::of_vertices(const OpenMesh::TriConnectivity& mesh, std::span<const VertexHandle> vertices) {
  Selection selection(mesh);
  for (const VertexHandle v : vertices) {
    check(mesh, v, mesh.n_vertices(), "vertex");
    selection.vertices_[element_index(v)] = selection.rim_[element_index(v)] = 1;
  }
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) {
    const FaceHandle f(static_cast<int>(i));
    if (mesh.has_face_status() && mesh.status(f).deleted()) continue;
    int chosen = 0;
    for_each_corner(mesh, f, [&](VertexHandle v) { chosen += selection.vertices_[element_index(v)]; });
    selection.faces_[i] = chosen == 3;
  }
  return selection;
}

Selection Selection::of_loops(const OpenMesh::TriConnectivity& mesh, std::span<const HalfedgeHandle> halfedges) {
  Selection selection(mesh);
  selection.loop_edges_.assign(mesh.n_edges(), 0);
  for (const HalfedgeHandle first : halfedges) {
    check(mesh, first, mesh.n_halfedges(), "half-edge");
    if (!mesh.is_boundary(first))
      throw InvalidInput(fmt::format("selection: half-edge {} has a face and lies on no boundary loop", first.idx()));
    HalfedgeHandle h = first;
    do {
      selection.loop_edges_[element_index(mesh.edge_handle(h))] = 1;
      h = mesh.next_halfedge_handle(h);
    } while (h != first);
  }
  return selection;
}

Selection Selection::of_status(const OpenMesh::TriConnectivity& mesh) {
  if (!mesh.has_face_status() || !mesh.has_vertex_status() || !mesh.has_edge_status())
    throw InvalidInput("selection: the mesh has no status attributes, so that nothing in it is marked as selected");
  if (const auto faces = with_status<FaceHandle>(mesh, mesh.n_faces()); !faces.empty()) return of_faces(mesh, faces);
  if (const auto vertices = with_status<VertexHandle>(mesh, mesh.n_vertices()); !vertices.empty())
    return of_vertices(mesh, vertices);
  std::vector<HalfedgeHandle> loops;
  for (const EdgeHandle e : with_status<EdgeHandle>(mesh, mesh.n_edges()))
    for (const unsigned side : {0u, 1u})
      if (const HalfedgeHandle h = mesh.halfedge_handle(e, side); mesh.is_boundary(h)) loops.push_back(h);
  return of_loops(mesh, loops);
}

bool Selection::may_fill(const OpenMesh::TriConnectivity& mesh, std::span<const HalfedgeHandle> loop) const {
  return std::all_of(loop.begin(), loop.end(), [&](HalfedgeHandle h) {
    return loop_edges_.empty() ? contains(rim_, mesh.to_vertex_handle(h)) : contains(loop_edges_, mesh.edge_handle(h));
  });
}

}  // namespace tri

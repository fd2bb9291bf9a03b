#include "meshops/editing/mesh_before.hpp"

#include <algorithm>

#include "meshops/pace.hpp"

namespace tri {
namespace {

Triangle corners_of(const OpenMesh::TriConnectivity& mesh, FaceHandle f) {
  Triangle corners;
  HalfedgeHandle h = mesh.halfedge_handle(f);
  for (std::uint32_t& corner : corners) {
    corner = static_cast<std::uint32_t>(mesh.to_vertex_handle(h).idx());
    h = mesh.next_halfedge_handle(h);
  }
  return corners;
}

Triangle least_first(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

MeshBefore::MeshBefore(MeshView view, const Context* context) : face_count_(view.mesh.n_faces()) {
  Pace pace(context);
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  for (std::size_t i = 0; i < face_count_; ++i) {
    pace();
    const FaceHandle f(static_cast<int>(i));
    if (mesh.status(f).deleted()) continue;
    triangles_.push_back(corners_of(mesh, f));
    faces_.push_back(f);
  }
  points_.reserve(mesh.n_vertices());
  alive_.reserve(mesh.n_vertices());
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    const VertexHandle v(static_cast<int>(i));
    pace();
    points_.push_back(view.point(v));
    alive_.push_back(!mesh.status(v).deleted());
  }
}

void MeshBefore::compare(MeshView now, Report& report, const Context* context) const {
  Pace pace(context);
  const OpenMesh::TriConnectivity& mesh = now.mesh;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    const VertexHandle v(static_cast<int>(i));
    pace();
    const bool is_new = i >= points_.size();
    if (mesh.status(v).deleted()) {
      if (!is_new && alive_[i]) ++report.vertices_removed;
      continue;
    }
    if (!is_new && now.point(v) == points_[i]) continue;
    ++(is_new ? report.vertices_added : report.vertices_moved);
    report.touched_vertices.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    pace();
    if (mesh.status(faces_[t]).deleted())
      ++report.faces_removed;
    else if (least_first(corners_of(mesh, faces_[t])) != least_first(triangles_[t]))
      report.touched_faces.push_back(static_cast<std::uint32_t>(faces_[t].idx()));
  }
  for (std::size_t i = face_count_; i < mesh.n_faces(); ++i) {
    pace();
    if (mesh.status(FaceHandle(static_cast<int>(i))).deleted()) continue;
    ++report.faces_added;
    report.touched_faces.push_back(static_cast<std::uint32_t>(i));
  }
}

}  // namespace tri

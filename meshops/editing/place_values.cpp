#include "meshops/editing/place_values.hpp"

#include <algorithm>

#include "meshops/editing/change_recorder.hpp"

namespace tri {

std::array<double, 3> triangle_weights(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 normal = (t[1] - t[0]) % (t[2] - t[0]);
  const double total = normal.sqrnorm();
  std::array<double, 3> weights{1, 0, 0};
  if (!(total > 0)) return weights;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 spanned = (t[(k + 1) % 3] - p) % (t[(k + 2) % 3] - p);
    weights[k] = std::clamp((spanned | normal) / total, -0.25, 1.25);
    sum += weights[k];
  }
  for (double& w : weights) w /= sum;
  return weights;
}

PlaceValues::PlaceValues(MeshView view, const MeshBefore& before) : before_(before), values_(view) {
  if (!values_.has_corner_values()) return;
  for (const FaceHandle f : before.faces()) {
    HalfedgeHandle h = view.mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = view.mesh.next_halfedge_handle(h))
      corners_.push_back(static_cast<std::size_t>(h.idx()));
  }
}

void PlaceValues::carry(MeshView now, const ClosestTriangle& surface, const std::vector<std::uint32_t>& near,
                        const std::function<bool(VertexHandle)>& on_line, const std::function<void()>& checkpoint) {
  const OpenMesh::TriConnectivity& mesh = now.mesh;
  const auto index = [](auto handle) { return static_cast<std::size_t>(handle.idx()); };
  const auto sources = [&](std::uint32_t triangle, const Vec3& p, const auto& element) {
    const std::array<double, 3> weights = triangle_weights(surface.corners(triangle), p);
    std::array<WeightedIndex, 3> result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = {element(triangle, k), weights[k]};
    return result;
  };
  for (std::size_t i = 0; values_.has_vertex_values() && i < mesh.n_vertices(); ++i) {
    if (i % 1024 == 0) checkpoint();
    const VertexHandle v(static_cast<int>(i));
    if (mesh.status(v).deleted() || (before_.was_there(v) && now.point(v) == before_.points()[i])) continue;
    const std::uint32_t triangle = surface.closest(now.point(v), near[i]).triangle;
    if (now.recorder) now.recorder->values(ElementKind::vertex, v.idx());
    values_.set_vertex(
        v, sources(triangle, now.point(v), [&](std::uint32_t t, std::size_t k) { return before_.triangles()[t][k]; }));
  }
  for (std::size_t i = 0; values_.has_corner_values() && i < mesh.n_faces(); ++i) {
    if (i % 1024 == 0) checkpoint();
    const FaceHandle f(static_cast<int>(i));
    if (mesh.status(f).deleted() || !now.may_replace(f)) continue;
    std::array<HalfedgeHandle, 3> sides;
    HalfedgeHandle h = mesh.halfedge_handle(f);
    Vec3 centre(0, 0, 0);
    for (HalfedgeHandle& side : sides) {
      side = h;
      centre += now.point(mesh.to_vertex_handle(h)) / 3.0;
      h = mesh.next_halfedge_handle(h);
    }
    for (const HalfedgeHandle side : sides) {
      const VertexHandle v = mesh.to_vertex_handle(side);
      const Vec3& p = now.point(v);
      const Vec3 inside = on_line(v) ? p + 1e-3 * (centre - p) : p;
      const std::uint32_t triangle = surface.closest(inside, near[index(v)]).triangle;
      if (now.recorder) now.recorder->corner(side);
      values_.set_corner(side,
                         sources(triangle, p, [&](std::uint32_t t, std::size_t k) { return corners_[3 * t + k]; }));
    }
  }
}

}  // namespace tri

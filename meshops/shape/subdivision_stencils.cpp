#include "meshops/shape/subdivision_stencils.hpp"

#include <cmath>
#include <numbers>

#include "meshops/editing/vertex_rows.hpp"

namespace tri {
namespace {

using Connectivity = OpenMesh::TriConnectivity;

bool on_line(VertexClass c) {
  return c == VertexClass::crease || c == VertexClass::boundary;
}
bool is_free(VertexClass c) {
  return c == VertexClass::smooth || c == VertexClass::dart;
}

const Vec3& end_of(MeshView view, HalfedgeHandle h) {
  return view.point(view.mesh.to_vertex_handle(h));
}
/// The third corner of the triangle of a half-edge.
const Vec3& apex(MeshView view, HalfedgeHandle h) {
  return end_of(view, view.mesh.next_halfedge_handle(h));
}

int neighbours(const Connectivity& mesh, VertexHandle v) {
  int n = 0;
  for_each_outgoing(mesh, v, [&](HalfedgeHandle) { ++n; });
  return n;
}

/// Around a vertex of n neighbours, of the j-th one from the edge on; with 3/4 of the vertex itself they sum to 1.
double butterfly_weight(int n, int j) {
  if (n == 3) return j == 0 ? 5.0 / 12 : -1.0 / 12;
  if (n == 4) return j == 0 ? 3.0 / 8 : j == 2 ? -1.0 / 8 : 0;
  const double angle = 2 * std::numbers::pi * j / n;
  return (1.0 / 4 + std::cos(angle) + std::cos(2 * angle) / 2) / n;
}

/// By the weights around the vertex in which `h` begins.
Vec3 butterfly_around(MeshView view, HalfedgeHandle h) {
  const Connectivity& mesh = view.mesh;
  const VertexHandle v = mesh.from_vertex_handle(h);
  const int n = neighbours(mesh, v);
  Vec3 sum = view.point(v) * (3.0 / 4);
  for (int j = 0; j < n; ++j, h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h)))
    sum += end_of(view, h) * butterfly_weight(n, j);
  return sum;
}

/// The point before the start of a feature half-edge along its line.
Vec3 before_along_line(MeshView view, const Features& features, HalfedgeHandle h) {
  const VertexHandle v = view.mesh.from_vertex_handle(h);
  Vec3 point = view.point(v) * 2 - end_of(view, h);
  if (!on_line(features[v])) return point;
  for_each_outgoing(view.mesh, v, [&](HalfedgeHandle other) {
    if (other != h && features.is_feature(view.mesh.edge_handle(other))) point = end_of(view, other);
  });
  return point;
}

}  // namespace

Vec3 loop_edge_point(MeshView view, const Features& features, EdgeHandle e) {
  const HalfedgeHandle left = view.mesh.halfedge_handle(e, 0), right = view.mesh.halfedge_handle(e, 1);
  const Vec3 ends = end_of(view, left) + end_of(view, right);
  if (features.is_feature(e)) return ends / 2;
  return ends * (3.0 / 8) + (apex(view, left) + apex(view, right)) / 8;
}

Vec3 loop_vertex_point(MeshView view, const Features& features, VertexHandle v) {
  const Vec3& old = view.point(v);
  const VertexClass c = features[v];
  if (c == VertexClass::corner) return old;
  Vec3 sum(0, 0, 0);
  int n = 0;
  for_each_outgoing(view.mesh, v, [&](HalfedgeHandle h) {
    if (on_line(c) && !features.is_feature(view.mesh.edge_handle(h))) return;
    sum += end_of(view, h) - old;
    ++n;
  });
  if (on_line(c)) return old + sum / 8;
  const double x = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4;
  return old + sum * ((5.0 / 8 - x * x) / n);
}

Vec3 butterfly_edge_point(MeshView view, const Features& features, EdgeHandle e) {
  const Connectivity& mesh = view.mesh;
  const HalfedgeHandle h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
  const Vec3 ends = end_of(view, h) + end_of(view, o);
  if (features.is_feature(e))
    return ends * (9.0 / 16) - (before_along_line(view, features, h) + before_along_line(view, features, o)) / 16;
  const VertexHandle a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
  const bool free_a = is_free(features[a]), free_b = is_free(features[b]);
  if (!free_a && !free_b) return ends / 2;
  if (!free_a) return butterfly_around(view, o);
  if (!free_b) return butterfly_around(view, h);
  const bool regular_a = neighbours(mesh, a) == 6, regular_b = neighbours(mesh, b) == 6;
  if (regular_a && regular_b) {
    // No side is on the boundary, since both ends are off it.
    Vec3 next(0, 0, 0);
    for (const HalfedgeHandle side : {h, o})
      for (const HalfedgeHandle beyond : {mesh.next_halfedge_handle(side), mesh.prev_halfedge_handle(side)})
        next += apex(view, mesh.opposite_halfedge_handle(beyond));
    return ends / 2 + (apex(view, h) + apex(view, o)) / 8 - next / 16;
  }
  if (regular_a) return butterfly_around(view, o);
  if (regular_b) return butterfly_around(view, h);
  return (butterfly_around(view, h) + butterfly_around(view, o)) / 2;
}

}  // namespace tri

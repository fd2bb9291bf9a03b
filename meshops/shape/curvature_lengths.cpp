#include "meshops/shape/curvature_lengths.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t lengths_block = 4096;
constexpr double growth = 0.5;  // of a length, per distance
constexpr int growth_rounds = 8;

/// Calls `visit(h)` for each half-edge that leaves the vertex.
template <class Visit>
void for_each_edge_of(const OpenMesh::TriConnectivity& mesh, VertexHandle v, const Visit& visit) {
  const HalfedgeHandle first = mesh.halfedge_handle(v);
  if (mesh.status(v).deleted() || !first.is_valid()) return;
  HalfedgeHandle h = first;
  do {
    visit(h);
    h = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
  } while (h != first);
}

}  // namespace

std::vector<double> curvature_lengths(MeshView view, const EdgeLines& lines, double tolerance, double shortest,
                                      double longest, const Context& context) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const std::size_t n = mesh.n_vertices();
  const auto for_vertices = [&](const auto& body) {
    for_each_block(context, "", n, lengths_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i, VertexHandle(static_cast<int>(i)));
    });
  };
  const auto on_line = [&](VertexHandle v) {
    bool found = false;
    for_each_edge_of(mesh, v, [&](HalfedgeHandle h) {
      found = found || lines.lines()[static_cast<std::size_t>(mesh.edge_handle(h).idx())] != EdgeLines::none;
    });
    return found;
  };
  std::vector<double> curvature(n, 0);
  for_vertices([&](std::size_t i, VertexHandle v) {
    const Vec3 p = view.point(v);
    if (on_line(v)) {
      Vec3 arms[2];
      int count = 0;
      for_each_edge_of(mesh, v, [&](HalfedgeHandle h) {
        if (lines.lines()[static_cast<std::size_t>(mesh.edge_handle(h).idx())] == EdgeLines::none) return;
        if (count < 2) arms[count] = view.point(mesh.to_vertex_handle(h)) - p;
        ++count;
      });
      if (count != 2 || lines.kinds()[i] != EdgeLines::Kind::along) return;
      const double turn = std::atan2((arms[0] % arms[1]).norm(), -(arms[0] | arms[1]));
      const double length = 0.5 * (arms[0].norm() + arms[1].norm());
      if (length > 0) curvature[i] = turn / length;
      return;
    }
    Vec3 normal(0, 0, 0);
    for_each_edge_of(mesh, v, [&](HalfedgeHandle h) {
      if (mesh.is_boundary(h)) return;
      normal += (view.point(mesh.to_vertex_handle(h)) - p) %
                (view.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h))) - p);
    });
    const double length = normal.norm();
    if (!(length > 0)) return;
    normal /= length;
    for_each_edge_of(mesh, v, [&](HalfedgeHandle h) {
      const Vec3 edge = view.point(mesh.to_vertex_handle(h)) - p;
      if (edge.sqrnorm() > 0) curvature[i] = std::max(curvature[i], 2 * std::abs(edge | normal) / edge.sqrnorm());
    });
  });
  // Noise is evened out once; a line is as curved as the surface beside it, at least.
  std::vector<double> result(n, longest);
  for_vertices([&](std::size_t i, VertexHandle v) {
    double sum = 0, greatest = 0;
    int count = 0;
    for_each_edge_of(mesh, v, [&](HalfedgeHandle h) {
      const double k = curvature[static_cast<std::size_t>(mesh.to_vertex_handle(h).idx())];
      sum += k, greatest = std::max(greatest, k), ++count;
    });
    if (count == 0) return;
    const double mean = 0.5 * (curvature[i] + sum / count);
    const double k = on_line(v) ? std::max(curvature[i], mean) : mean;
    if (!(k > 0)) return;
    const double squared = 6 * tolerance / k - 3 * tolerance * tolerance;
    result[i] = std::clamp(squared > 0 ? std::sqrt(squared) : 0.0, shortest, longest);
  });
  std::vector<double> next(n);
  for (int round = 0; round < growth_rounds; ++round) {
    for_vertices([&](std::size_t i, VertexHandle v) {
      next[i] = result[i];
      for_each_edge_of(mesh, v, [&](HalfedgeHandle h) {
        const VertexHandle u = mesh.to_vertex_handle(h);
        const double reach =
            result[static_cast<std::size_t>(u.idx())] + growth * (view.point(u) - view.point(v)).norm();
        if (reach < next[i]) next[i] = reach;
      });
    });
    result.swap(next);
  }
  return result;
}

}  // namespace tri

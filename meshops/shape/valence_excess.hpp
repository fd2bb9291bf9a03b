#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshops/mesh_view.hpp"

namespace tri {

/// How many triangles (on a line) or edges (elsewhere) a vertex has more than suits equilateral triangles: 6 edges, and
/// on a line as many triangles as their angles here would make with 60 degrees each. 0 of deleted and isolated
/// vertices.
inline int valence_excess(const MeshView& view, VertexHandle v, bool on_line) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const HalfedgeHandle first = mesh.halfedge_handle(v);
  if (mesh.status(v).deleted() || !first.is_valid()) return 0;
  const auto vector_of = [&](HalfedgeHandle h) {
    return view.point(mesh.to_vertex_handle(h)) - view.point(mesh.from_vertex_handle(h));
  };
  double angle = 0;
  int edges = 0, faces = 0;
  HalfedgeHandle h = first;
  do {
    ++edges;
    const HalfedgeHandle back = mesh.prev_halfedge_handle(h);
    if (on_line && !mesh.is_boundary(h)) {
      const Vec3 a = vector_of(h), b = -vector_of(back);
      angle += std::atan2((a % b).norm(), a | b);
      ++faces;
    }
    h = mesh.opposite_halfedge_handle(back);
  } while (h != first);
  if (!on_line) return edges - 6;
  return faces - std::max(1, static_cast<int>(std::lround(angle / (std::numbers::pi / 3))));
}

}  // namespace tri

#pragma once

#include <cstddef>
#include <cstdint>

#include "meshops/editing/plain_vector.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// Calls `f(h)` for each half-edge that starts in a vertex, from its stored one on in the order of the fan.
template <class F>
void for_each_outgoing(const OpenMesh::TriConnectivity& mesh, VertexHandle v, const F& f) {
  const HalfedgeHandle first = mesh.halfedge_handle(v);
  if (!first.is_valid()) return;
  HalfedgeHandle h = first;
  do {
    f(h);
    h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
  } while (h != first);
}

/// Neighbours of every vertex in flat arrays, for passes over all of them: entries begin[v] to begin[v + 1] - 1 belong
/// to vertex v. 8 bytes per half-edge.
struct VertexRows {
  PlainVector<std::uint32_t> begin;     ///< one per vertex, and one beyond
  PlainVector<std::uint32_t> neighbor;  ///< index of the vertex at the other end
  PlainVector<std::uint32_t> halfedge;  ///< index of the half-edge that leads there
};

/// The neighbours that `keep(v, h)` (asked from several threads) accepts, for each vertex in the order of its fan.
/// @throws Cancelled
template <class Keep>
VertexRows vertex_rows(MeshView view, const Context& context, const Keep& keep) {
  constexpr std::size_t block_size = 4096;
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const std::size_t count = mesh.n_vertices();
  const auto for_each_kept = [&](std::size_t i, const auto& f) {
    const VertexHandle v(static_cast<int>(i));
    if (mesh.status(v).deleted()) return;
    for_each_outgoing(mesh, v, [&](HalfedgeHandle h) {
      if (keep(v, h)) f(h);
    });
  };
  VertexRows rows;
  rows.begin.resize(count + 1);
  rows.begin[0] = 0;
  for_each_block(context, "", count, block_size, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t n = 0;
      for_each_kept(i, [&](HalfedgeHandle) { ++n; });
      rows.begin[i + 1] = n;
    }
  });
  for (std::size_t i = 0; i < count; ++i) rows.begin[i + 1] += rows.begin[i];
  rows.neighbor.resize(rows.begin[count]);
  rows.halfedge.resize(rows.begin[count]);
  for_each_block(context, "", count, block_size, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t at = rows.begin[i];
      for_each_kept(i, [&](HalfedgeHandle h) {
        rows.neighbor[at] = static_cast<std::uint32_t>(mesh.to_vertex_handle(h).idx());
        rows.halfedge[at++] = static_cast<std::uint32_t>(h.idx());
      });
    }
  });
  return rows;
}

}  // namespace tri

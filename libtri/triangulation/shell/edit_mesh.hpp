#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/soup.hpp"

namespace tri {

/// A manifold triangulation by triangles and neighbours, made for the two moves of the shell method: the flip of an
/// edge and the replacement of a vertex's star. Half the memory of a half-edge structure and no garbage collection in
/// between.
class EditMesh {
 public:
  struct Vertex {
    Vec3 p{0, 0, 0};                ///< mm; decisions are made on these positions
    std::array<float, 3> normal{};  ///< unit outward normal of the model; zero where the model has none (a sharp edge)
    float area = 0;           ///< mm^2 that the vertex stands for; weighs the shape of triangles against their place
    std::int32_t point = -1;  ///< index of the measured point; -1 for a vertex of the tessellation
  };

  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::array<std::int32_t, 3>> neighbors;
  std::vector<std::uint8_t> creases;          ///< bit k: the edge opposite corner k is a sharp edge of the model
  std::vector<std::int32_t> vertex_triangle;  ///< one triangle of the vertex's fan; -1 once removed

  bool alive(std::int32_t t) const { return triangles[t][0] != triangles[t][1]; }
  int corner(std::int32_t t, std::uint32_t v) const {
    const Triangle& q = triangles[t];
    return q[0] == v ? 0 : q[1] == v ? 1 : 2;
  }
  /// Corner of `t` opposite its edge from vertex `from` to vertex `to`. Vertices tell sides apart where neighbours
  /// cannot: two triangles may share two edges.
  int side(std::int32_t t, std::uint32_t from, std::uint32_t to) const {
    const Triangle& q = triangles[t];
    return q[1] == from && q[2] == to ? 0 : q[2] == from && q[0] == to ? 1 : 2;
  }
  /// The vertex of the neighbour across the edge opposite corner `k` of `t` that is not on that edge.
  std::uint32_t opposite(std::int32_t t, int k) const {
    const std::int32_t n = neighbors[t][k];
    return triangles[n][side(n, triangles[t][(k + 2) % 3], triangles[t][(k + 1) % 3])];
  }
  /// Sets `vertex_triangle` from the triangles.
  void index_vertices();

  /// The fan around a vertex, counter-clockwise. For a vertex inside, ring[i] -> ring[i+1] (cyclic) is the far edge of
  /// fan[i]; for one on the boundary the ring has one entry more than the fan.
  struct Star {
    std::vector<std::int32_t> fan;
    std::vector<std::uint32_t> ring;
    bool closed = false;
  };
  /// @return false if the fan has more than `limit` triangles (the star is then incomplete).
  bool star(std::uint32_t v, Star& out, std::size_t limit) const;

  /// Calls `visit` for every vertex that shares an edge with `v`, for some of them twice.
  template <class Visit>
  void for_neighbors(std::uint32_t v, Visit visit) const {
    const std::int32_t start = vertex_triangle[v];
    std::int32_t t = start;
    do {
      const int c = corner(t, v);
      visit(triangles[t][(c + 1) % 3]);
      visit(triangles[t][(c + 2) % 3]);
      t = neighbors[t][(c + 1) % 3];
    } while (t >= 0 && t != start);
    if (t == start) return;
    t = neighbors[start][(corner(start, v) + 2) % 3];
    while (t >= 0) {
      const int c = corner(t, v);
      visit(triangles[t][(c + 1) % 3]);
      t = neighbors[t][(c + 2) % 3];
    }
  }

  bool has_edge(std::uint32_t a, std::uint32_t b) const;
  bool on_boundary(std::uint32_t v) const;

  /// Exchanges the diagonal opposite corner `k` of `t`; the caller has checked that there is a neighbour and no such
  /// edge yet.
  void flip(std::int32_t t, int k);

  /// Splits the edge opposite corner `k` of `t` by a new vertex. @return the vertex
  std::uint32_t split_edge(std::int32_t t, int k, const Vertex& vertex);

  /// Replaces the star of `v` by `patch` (triangles over the ring's vertices, at most as many as the fan has) and
  /// removes `v`.
  void replace_star(std::uint32_t v, const Star& star, std::span<const Triangle> patch);

  /// Replaces the triangles `old`, which form one disc, by `patch`, at most as many. Every corner keeps a triangle, in
  /// the patch or beyond the region.
  void replace(std::span<const std::int32_t> old, std::span<const Triangle> patch);
};

}  // namespace tri

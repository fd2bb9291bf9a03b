#include "meshops/holes/ring_filling.hpp"

#include <algorithm>

#include "meshops/holes/ring_triangulation.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

/// Triangles in a piece that is triangulated anew. On random knotted loops pieces of 10 end up to a quarter heavier
/// than those of 30, on long noisy ones a tenth, which is not worth five times the time.
constexpr int piece_size = 30, piece_size_of_long_rings = 10;
constexpr std::size_t long_ring = 1000;
/// 1 - cos of 20 degrees: below it flips have left nothing to gain.
constexpr double least_turn = 0.06;

/// Triangulates what `cut_nearest_diagonals` left. Beyond each of its edges counts the mean normal of the surface along
/// the stretch of rim that the edge stands for, since the ears between them will be flipped away.
bool fill_rest(const Ring& ring, std::span<const std::int32_t> left, RingObjective objective,
               std::vector<RingTriangle>& triangles) {
  const std::size_t n = ring.points.size(), m = left.size();
  std::vector<Vec3> points, normals;
  for (std::size_t i = 0; i < m; ++i) {
    points.push_back(ring.points[left[i]]);
    Vec3 sum(0, 0, 0);
    if (!ring.edge_normals.empty())
      for (auto at = static_cast<std::size_t>(left[i]); at != static_cast<std::size_t>(left[(i + 1) % m]);
           at = (at + 1) % n)
        sum += ring.edge_normals[at] * (ring.points[(at + 1) % n] - ring.points[at]).norm();
    normals.push_back(unit_or_zero(sum));
  }
  ChordTest allowed;
  if (ring.chord_allowed) allowed = [&](int i, int j) { return ring.chord_allowed(left[i], left[j]); };
  std::vector<RingTriangle> inner;
  if (!triangulate_ring(points, normals, allowed, objective, inner, bending_scale(ring.points))) return false;
  for (const RingTriangle& t : inner) triangles.push_back({left[t[0]], left[t[1]], left[t[2]]});
  return true;
}

}  // namespace

RingFilling fill_ring(const Ring& ring, HoleStrategy strategy, int max_dynamic_edges, const Context& context) {
  context.checkpoint();
  RingFilling filling;
  std::vector<std::int32_t> left;
  if (ring.points.size() < 3) return filling;
  if (strategy == HoleStrategy::nearest_diagonal) {
    cut_nearest_diagonals(ring.points, ring.vertex_normals, ring.chord_allowed, 2, filling.triangles, left);
    return filling;
  }
  const RingObjective objective = strategy == HoleStrategy::minimum_area    ? RingObjective::area
                                  : strategy == HoleStrategy::least_bending ? RingObjective::bending
                                                                            : RingObjective::dihedral_area;
  if (ring.points.size() <= static_cast<std::size_t>(max_dynamic_edges)) {
    triangulate_ring(ring.points, ring.edge_normals, ring.chord_allowed, objective, filling.triangles);
    return filling;
  }
  filling.in_pieces = true;
  std::vector<RingTriangle> ears, rest;
  if (!cut_nearest_diagonals(ring.points, ring.vertex_normals, ring.chord_allowed, max_dynamic_edges, ears, left))
    return filling;
  context.checkpoint();
  if (!fill_rest(ring, left, objective, rest)) {
    // The ears took what the rest needed: all ears but one then, if there are as many.
    ears.clear();
    left.clear();
    if (!cut_nearest_diagonals(ring.points, ring.vertex_normals, ring.chord_allowed, 3, ears, left)) return filling;
    rest.push_back({left[0], left[1], left[2]});
  }
  RingTriangulation surface(ring.points, ring.edge_normals, ring.chord_allowed, objective, left, rest);
  for (std::size_t i = ears.size(); i-- > 0;) {
    if (i % 1024 == 0) context.checkpoint();
    surface.add_ear(ears[i]);
  }
  surface.improve_pieces(ring.points.size() > long_ring ? piece_size_of_long_rings : piece_size, least_turn, context);
  filling.triangles = surface.triangles();
  return filling;
}

}  // namespace tri

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// Corners of a triangle of a polygon: 0-based positions in the ring, in the ring's direction.
using RingTriangle = std::array<std::int32_t, 3>;

/// `(i, j)` with i < j, never a ring edge: whether the chord between two positions of a ring may be an edge. Empty
/// allows every chord.
using ChordTest = std::function<bool(int, int)>;

namespace detail {

/// Rings of at most this many vertices are triangulated without touching the heap (but for the output).
inline constexpr int small_ring = 64;

inline constexpr std::size_t ring_pairs(int n) {
  return static_cast<std::size_t>(n) * static_cast<std::size_t>(n - 1) / 2;
}

/// The tables hold one entry per pair i < j; row j begins at j (j - 1) / 2.
inline std::size_t ring_pair(int i, int j) {
  return ring_pairs(j) + static_cast<std::size_t>(i);
}

template <class Weight, class ChordAllowed, class TriangleWeight>
std::optional<Weight> triangulate_ring(int n, Weight* best, std::int32_t* apex, ChordAllowed& chord_allowed,
                                       TriangleWeight& triangle_weight, std::vector<RingTriangle>& triangles,
                                       std::int32_t* stack) {
  // apex: -1 for a ring edge, -2 for a chord that is forbidden or cannot be completed.
  for (int j = 1; j < n; ++j) {
    best[ring_pair(j - 1, j)] = Weight{};
    apex[ring_pair(j - 1, j)] = -1;
  }
  for (int span = 2; span < n; ++span) {
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      const std::size_t ij = ring_pair(i, j);
      apex[ij] = -2;
      if (span < n - 1 && !chord_allowed(i, j)) continue;
      for (int k = i + 1; k < j; ++k) {
        const std::size_t ik = ring_pair(i, k), kj = ring_pair(k, j);
        if (apex[ik] == -2 || apex[kj] == -2) continue;
        const Weight parts = best[ik] + best[kj];
        if (apex[ij] != -2 && !(parts < best[ij])) continue;  // a triangle never makes it lighter
        std::optional<Weight> own;
        if constexpr (std::is_invocable_v<TriangleWeight&, int, int, int, int, int, bool (*)(const Weight&)>)
          own = triangle_weight(i, k, j, apex[ik], apex[kj],
                                [&](const Weight& least) { return apex[ij] == -2 || parts + least < best[ij]; });
        else
          own = triangle_weight(i, k, j, apex[ik], apex[kj]);
        if (!own) continue;
        const Weight sum = parts + *own;
        if (apex[ij] == -2 || sum < best[ij]) {
          best[ij] = sum;
          apex[ij] = k;
        }
      }
    }
  }
  const std::size_t whole = ring_pair(0, n - 1);
  if (apex[whole] == -2) return std::nullopt;
  int depth = 0;
  stack[depth++] = 0;
  stack[depth++] = n - 1;
  while (depth > 0) {
    const int j = stack[--depth], i = stack[--depth];
    const std::int32_t k = apex[ring_pair(i, j)];
    if (k < 0) continue;
    triangles.push_back({i, k, j});
    stack[depth++] = i, stack[depth++] = k;
    stack[depth++] = k, stack[depth++] = j;
  }
  return best[whole];
}

}  // namespace detail

/// Triangulates a closed polygon of `n` vertices with the least total weight, by dynamic programming over its chords
/// [Klincsek 1980; Barequet & Sharir 1995; Liepa 2003]. Time n^3 / 6 calls of `triangle_weight`, memory
/// n^2 / 2 entries; on the stack up to 64 vertices. The caller bounds n.
///
/// @param n  number of ring vertices, at least 3. Vertex 0 and n - 1 are neighbours.
/// @param chord_allowed  `bool(int i, int j)`, i < j, j - i >= 2, never the ring edge (0, n - 1): whether the chord may
/// be an edge.
/// @param triangle_weight  `std::optional<Weight>(int i, int k, int j, int apex_ik, int apex_kj)`, i < k < j: the
/// weight that
///   triangle (i, k, j) brings. `apex_ik` is the third corner of the triangle already chosen beyond chord (i, k), or -1
///   if (i, k) is a ring edge; the same for `apex_kj`. The edge (0, n - 1) is closed by the one call with i = 0 and j =
///   n - 1. No value forbids the triangle. It may take a sixth argument, `bool useful(const Weight& least)`: whether
///   the triangle could still be chosen if it brought no less than that; no value may be returned where it could not.
/// @tparam Weight  trivial type with `Weight{}` the neutral element, `+` that never lightens (a + b is not < a), and
/// `<`; sums, maxima and
///   lexicographic pairs of them fit. (With a weight that depends on the apexes the result is Liepa's
///   heuristic: each chord keeps its best part.)
/// @param triangles  receives n - 2 triangles, appended; each but the first shares a chord with an earlier one.
/// @return the total weight, or nothing if no triangulation is allowed; then `triangles` is as it was.
template <class Weight, class ChordAllowed, class TriangleWeight>
std::optional<Weight> triangulate_polygon(int n, ChordAllowed&& chord_allowed, TriangleWeight&& triangle_weight,
                                          std::vector<RingTriangle>& triangles) {
  if (n < 3) return std::nullopt;
  if (n <= detail::small_ring) {
    constexpr std::size_t pairs = detail::ring_pairs(detail::small_ring);
    std::array<Weight, pairs> best;
    std::array<std::int32_t, pairs> apex;
    std::array<std::int32_t, 4 * detail::small_ring> stack;
    return detail::triangulate_ring<Weight>(n, best.data(), apex.data(), chord_allowed, triangle_weight, triangles,
                                            stack.data());
  }
  std::vector<Weight> best(detail::ring_pairs(n));
  std::vector<std::int32_t> apex(detail::ring_pairs(n)), stack(4 * static_cast<std::size_t>(n));
  return detail::triangulate_ring<Weight>(n, best.data(), apex.data(), chord_allowed, triangle_weight, triangles,
                                          stack.data());
}

/// Largest dihedral angle first, area second [Liepa 2003].
struct DihedralAreaWeight {
  double turn = 0;  ///< largest angle between normals of neighbours, as 1 - cos in [0, 2]
  double area = 0;  ///< model units squared

  /// Of two parts together: the sharper turn and the sum of the areas.
  friend DihedralAreaWeight operator+(const DihedralAreaWeight& a, const DihedralAreaWeight& b) {
    return {a.turn > b.turn ? a.turn : b.turn, a.area + b.area};
  }
  /// Angles that differ by less than 1e-9 count as equal, so that flat polygons are decided by area.
  friend bool operator<(const DihedralAreaWeight& a, const DihedralAreaWeight& b) {
    if (a.turn < b.turn - 1e-9) return true;
    if (a.turn > b.turn + 1e-9) return false;
    return a.area < b.area;
  }
};

/// What a triangulation of a ring is to keep small.
enum class RingObjective {
  dihedral_area,  ///< the largest dihedral angle, then the area; Liepa's heuristic
  bending,        ///< area + `bending_scale` * sum over the edges of length * `bending`; Liepa's heuristic
  area,           ///< the area alone; the least there is
};

/// How much area a unit of bending is worth in `RingObjective::bending`, in model units: 0.03 of the ring's length.
/// With less the filling is smaller and sharper, with more the reverse; at that value it has both less area and lower
/// angles than the least largest angle gives.
double bending_scale(std::span<const Vec3> ring);

/// Triangulates a ring in space by dynamic programming; cost as `triangulate_polygon`, about 30 ns for each triangle
/// looked at.
///
/// @param ring  at least 3 positions, in the direction in which the new triangles run.
/// @param edge_normals  ring.size() vectors: unit normal of the surface beyond ring edge (i, i + 1), or zero where
/// there is none; or empty for a ring without neighbours.
/// @param triangles  receives ring.size() - 2 triangles, appended.
/// @param scale  of bending; 0 stands for `bending_scale(ring)`
/// @return the weight (the turn is 0 but with `RingObjective::dihedral_area`), or nothing if no triangulation is
/// allowed; then `triangles` is as it was.
std::optional<DihedralAreaWeight> triangulate_ring(std::span<const Vec3> ring, std::span<const Vec3> edge_normals,
                                                   const ChordTest& chord_allowed, RingObjective objective,
                                                   std::vector<RingTriangle>& triangles, double scale = 0);

/// Cuts ears off a ring in space, the one with the shortest diagonal first, until `rest` vertices are left: the
/// nearest-diagonal triangulation of [Ristic et al. 2000, step (g)].
///
/// An ear that would fold over (its normal against `vertex_normals` and the ring's own mean normal) or that covers
/// another vertex of the ring waits until no other is left. Time O(n log n) unless many long ears reach across many
/// vertices.
///
/// @param ring  at least 3 positions, in the direction in which the new triangles run.
/// @param vertex_normals  ring.size() unit normals of the surface around the ring, zero where unknown; or empty.
/// @param rest  at least 3 to leave a ring of that many vertices (if the ring is not smaller already); 2 to triangulate
/// it all.
/// @param triangles  receives ring.size() - max(rest, 2) triangles, appended, each sharing an edge with the ring or an
/// earlier one.
/// @param left  receives the positions of the vertices that are left, ascending (none with rest 2).
/// @return false if forbidden chords leave no ear; then `triangles` is as it was.
bool cut_nearest_diagonals(std::span<const Vec3> ring, std::span<const Vec3> vertex_normals,
                           const ChordTest& chord_allowed, int rest, std::vector<RingTriangle>& triangles,
                           std::vector<std::int32_t>& left);

}  // namespace tri

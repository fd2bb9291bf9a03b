#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/editing/plain_vector.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Which sides of a triangle list lie together on an edge. Side i is side i % 3 of triangle i / 3 and runs from that
/// corner to the next one.
struct SidePairs {
  static constexpr std::int32_t none = -1;  ///< in place of a side
  using Sides = PlainVector<std::int32_t>;  ///< `resize` leaves new entries unset

  /// 3 x triangles entries: the side that runs the other way along the same edge, or `none`.
  Sides twin;
  /// Two sides alone on an edge that run the same way; they have no twin yet.
  std::vector<std::array<std::int32_t, 2>> same_way;
  /// Three or more sides on one edge, in increasing order; they have no twin yet.
  std::vector<std::vector<std::int32_t>> crowded;

  // Without branches: which corner comes next is as good as random.
  /// The side after this one in its triangle.
  static std::int32_t next(std::int32_t side) { return side + 1 - 3 * static_cast<std::int32_t>(side % 3 == 2); }
  /// The side before this one in its triangle.
  static std::int32_t previous(std::int32_t side) { return side - 1 + 3 * static_cast<std::int32_t>(side % 3 == 0); }
};

/// Pairs the sides by a counting sort on the smaller vertex of each. O(sides), but O(d log d) for d sides at one
/// vertex.
/// @param triangles no index twice in one triangle, every index below `points`; fewer than 2^31 / 3 triangles
SidePairs pair_sides(std::span<const Triangle> triangles, std::size_t points, Context& context);

/// What `make_manifold` did; empty where nothing had to be done.
struct ManifoldRepairs {
  std::vector<std::uint32_t> reversed_triangles;      ///< increasing
  std::vector<std::uint32_t> copied_points;           ///< point of each appended vertex
  std::vector<std::array<std::uint32_t, 2>> crowded;  ///< edges that had three or more sides
  std::vector<std::array<std::uint32_t, 2>> cut;      ///< edges cut because no orientation fits both sides
  std::vector<std::uint32_t> detached_triangles;      ///< cut loose on all sides because nothing less made edges unique
};

/// Turns triangles with any topology into oriented manifold ones, by reversing triangles and by copying vertices.
///
/// Reversal: within each set of triangles joined over edges of two sides, all run the same way afterwards, and the
/// majority keeps its direction. A set that is not orientable is cut along edges. Edges of three or more sides: see
/// `pair_crowded_sides` (two solids that touch in an edge come apart, a fin comes off); what is left over becomes
/// boundary. Every further fan of triangles about a vertex gets a copy of
/// the vertex, appended after the points. No edge is there twice afterwards. No triangle is dropped.
/// @param triangles changed in place; their order stays
/// @param pairs of `triangles`; on return `twin` fits the result and the other two are empty
ManifoldRepairs make_manifold(std::vector<Triangle>& triangles, std::span<const Vec3> points, SidePairs& pairs,
                              Context& context);

/// Vertices whose triangles form more than one fan. With `crowded` and `same_way` empty as well, the list is manifold.
/// @throws Cancelled
std::vector<std::uint32_t> vertices_with_several_fans(std::span<const Triangle> triangles, std::size_t points,
                                                      std::span<const std::int32_t> twin, const Context& context);

}  // namespace tri

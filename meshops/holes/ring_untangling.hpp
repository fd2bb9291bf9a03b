#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/holes/ring_filling.hpp"

namespace tri {

/// What the filling of a ring may run into.
struct RingSurroundings {
  /// For each position of the ring the lowest one in the same place: itself, unless the ring meets itself.
  std::vector<std::int32_t> same_as;
  /// How many triangles around the ring one of the filling meets in more than what they share.
  std::function<int(const RingTriangle&)> crossings;
  /// For each triangle of a whole filling 0 if it is known to meet neither anything around the ring nor another one of
  /// the filling in more than what they share, else 1. May be null: nothing is known.
  std::function<std::vector<char>(std::span<const RingTriangle>)> in_doubt;
  /// By ring edge (i, i + 1): how many of the triangles around the ring every triangle at this edge meets; or empty.
  std::vector<int> unavoidable;
  /// Whether a triangle of the filling without area counts as if it met one triangle; else it counts as nothing.
  bool areas_wanted = false;
};

/// Where a filling meets something in more than what they share. Triangles by their places in the filling.
struct FillingCrossings {
  /// A triangle that meets some around the ring.
  struct Around {
    std::int32_t triangle;  ///< its place in the filling
    int count;              ///< how many it meets, at least one
  };
  std::size_t count = 0;                            ///< pairs of both kinds
  std::vector<Around> around;                       ///< ascending
  std::vector<std::array<std::int32_t, 2>> inside;  ///< pairs within the filling
};

/// Looks for pairs of triangles that meet in more than what they share: in the filling, and with its surroundings.
/// @throws Cancelled between some 256 triangles
FillingCrossings find_crossings(std::span<const Vec3> ring, const RingSurroundings& surroundings,
                                std::span<const RingTriangle> triangles, const Context& context);

/// Takes connected pieces around crossings out of a filling and triangulates them with the fewest crossings, then the
/// least area, by dynamic programming; first pieces of 12 triangles, then larger ones. Crossings that are known to be
/// unavoidable, where the faces at the rim cross each other, are left alone. At most 50,000 triangles and 10 more for
/// each edge are weighed, and a size of pieces that helps nothing is the last.
/// @param crossings  what `find_crossings` says about `triangles`
/// @return how many crossings are left; if no fewer than there were, `triangles` is unchanged
/// @throws Cancelled between pieces; then `triangles` is unchanged
std::size_t untangle_filling(const Ring& ring, const RingSurroundings& surroundings, const FillingCrossings& crossings,
                             std::vector<RingTriangle>& triangles, const Context& context);

}  // namespace tri

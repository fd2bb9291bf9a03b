#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/search/closest_triangle.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A place of one surface that is farther from another than it may be.
struct FarPlace {
  std::uint32_t triangle = 0;  ///< of the first surface
  Vec3 at{0, 0, 0};            ///< on it
  double distance = 0;         ///< from the other surface, model units
};

/// Whether a triangle stays within reach of a surface.
struct ReachOfTriangle {
  /// Whether every place of the triangle lies within reach.
  enum class Verdict {
    within,    ///< all of it, proven
    beyond,    ///< `far` is a place of it that is farther away
    undecided  ///< after as many pieces as were allowed
  };
  Verdict verdict = Verdict::within;  ///< of all its places
  FarPlace far;                       ///< its `triangle` is 0
};

/// Looks for a place of a triangle that is farther than `reach` from a surface.
///
/// A piece of the triangle is within reach if its corners are within it of one triangle, as distance from that is
/// largest in a corner; others are cut into four, larger ones first.
/// @param hint  a triangle of the surface that may be near, which saves the search; on return one that is
ReachOfTriangle reach_of(const std::array<Vec3, 3>& triangle, const ClosestTriangle& surface, double reach,
                         std::size_t most_pieces, std::uint32_t& hint);

/// Where triangles reach farther than they may.
struct PlacesBeyond {
  std::vector<FarPlace> places;  ///< one of each triangle that has any, in order of the triangles
  std::size_t undecided = 0;     ///< triangles of which no place was found, and not proven that there is none
};

/// Looks for triangles of one surface that have places farther than `reach` from another. Triangles that are in both,
/// by the coordinates of their corners, cost next to nothing; the others get searches by their area, a few thousand
/// together and some for each.
/// @param left_out  of the triangles of `from`: increasing, not looked at
/// @throws InvalidInput if `to` has no triangle or a coordinate is not finite; Cancelled
PlacesBeyond places_beyond(const Soup& from, std::span<const std::uint32_t> left_out, const Soup& to, double reach,
                           Context& context);

}  // namespace tri

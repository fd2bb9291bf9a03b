#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// Result of `delaunay`.
struct Delaunay {
  std::vector<Triangle> triangles;  ///< counter-clockwise, indices into the input points
  /// triangles.size() triples: neighbour t of triangle i across the edge opposite corner k, or -1 on the hull.
  std::vector<std::array<std::int32_t, 3>> neighbors;
  /// (duplicate, kept): points equal to an earlier one; they are in no triangle.
  std::vector<std::array<std::uint32_t, 2>> duplicates;
};

/// Delaunay triangulation of points in the plane by divide and conquer [Guibas & Stolfi 1985] with exact predicates.
///
/// Any input is right: grids, collinear and cocircular sets, duplicates; fewer than three distinct or only collinear
/// points give no triangle. Among cocircular points the choice depends on the points alone.
/// @throws InvalidInput if a coordinate is not finite.
Delaunay delaunay(std::span<const Vec2> points, Context& context);

}  // namespace tri

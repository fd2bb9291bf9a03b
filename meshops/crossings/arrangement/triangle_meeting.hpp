#pragma once

#include <array>
#include <vector>

#include "meshops/crossings/arrangement/grid_geometry.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Where on a triangle a point lies: 0 to 2 at that corner, 3 to 5 inside side k - 3 (from corner k - 3 to the next), 6
/// in the interior.
using TrianglePlace = int;
inline constexpr TrianglePlace in_interior = 6;

/// A point that two triangles have in common.
struct CommonPoint {
  TrianglePlace on_first, on_second;
  ExactPoint point;
};

/// A segment that two triangles have in common, or that a side of one cuts out of the other where both lie in one
/// plane.
struct CommonSegment {
  int from, to;     ///< indices into `points`
  GridPlane plane;  ///< holds the segment and is not the plane of the triangle to be cut
  bool in_first;    ///< cuts the first triangle, else the second
};

/// What two triangles with area have in common beyond the corners and sides that they share by number. Exact. Points of
/// equal coordinates must have equal numbers.
struct TriangleMeeting {
  std::vector<CommonPoint> points;
  std::vector<CommonSegment> segments;

  void clear() { points.clear(), segments.clear(); }
  /// Whether one of the triangles has to be cut.
  bool cuts() const { return !points.empty(); }
};

/// @param first, second            corners
/// @param first_ids, second_ids    numbers of the corners; the triangles differ in at least one
void meet(const GridTriangle& first, const Triangle& first_ids, const GridTriangle& second, const Triangle& second_ids,
          TriangleMeeting& meeting);

}  // namespace tri

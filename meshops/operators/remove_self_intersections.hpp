#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What is done where triangles cross.
enum class CrossingMethod {
  automatic,  ///< `refill` where that can be, else `split`
  refill,     ///< they are cut out and the hole is filled; elsewhere they stay
  split,      ///< they are cut along each other, and all pieces stay
};

/// What is done, and how far the surface may move.
struct RemoveSelfIntersectionsOptions {
  CrossingMethod method = CrossingMethod::automatic;  ///< what is done where triangles cross
  /// Share of the diagonal of the bounding box. A filling and what was cut out for it are nowhere farther apart, and no
  /// vertex moves farther when triangles are cut along each other. With `automatic`, where both are done, three
  /// quarters are for the one and a quarter for the other.
  double max_deviation = 5e-4;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Removes crossings of triangles place by place. Open sheets stay open, no side of a triangle that had a neighbour
/// ends without.
///
/// Refilling (`refill_crossings`): the triangles that cross, and up to three rings around them, are cut out where they
/// make a disk, and the hole is triangulated between the corners of its rim so that nothing crosses anew, as
/// `fill_holes` does. Where the filling would cross something, or be too far from what was there, all stays as it was;
/// notes say where.
///
/// Splitting (`split_crossings`): triangles are cut along each other, so that they meet only in corners and sides.
/// Cutting is exact; new vertices are rounded to 2^-28 of the extent, and what that makes cross is cut again
/// (`resolve_crossings`). Vertices that were there keep their coordinates, unless that makes their triangles cross:
/// then they move to the grid, too, and by up to 2^-20 of the extent (rarely 2^-13) where triangles cross at small
/// angles. Edges along which sheets cross have four triangles afterwards: `split_non_manifold` takes them apart. A
/// place that would end with as many crossings as before stays as it was.
///
/// Attributes of fillings come from what was cut out; else they are interpolated in the triangle that a new vertex lies
/// on. Triangles without area are left to `remove_degenerate`, but may go where something is cut.
///
/// Figures: "crossing pairs", "places refilled", "faces cut". `skipped`: "pairs that still cross", of which notes name
/// up to ten places. `touched_faces` are those that are new.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report remove_self_intersections(Soup& soup, const RemoveSelfIntersectionsOptions& options, Context& context);

}  // namespace tri

#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// How far vertices may move.
struct RemoveSelfIntersectionsOptions {
  /// Share of the diagonal of the bounding box: no vertex moves farther than this.
  double max_deviation = 5e-4;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Cuts triangles along each other where they cross, so that they meet only in corners and sides; all pieces stay, open sheets
/// stay open. Pieces that fall together become one.
///
/// Cutting is exact; new vertices are rounded to 2^-28 of the extent, and what that makes cross is cut again (`resolve_crossings`).
/// Vertices that were there keep their coordinates, unless that makes something cross: then they move to the grid, too, and by up
/// to 2^-20 of the extent (rarely 2^-13) where triangles cross at small angles. Edges along which sheets cross have four triangles
/// afterwards: `split_non_manifold` takes them apart. What would end with as many crossings as before, or beyond
/// `max_deviation`, is not done. Attributes are interpolated in the triangle that a new vertex lies on. Triangles without area
/// are left to `remove_degenerate`, but may go where something is cut.
///
/// Figures: "crossing pairs", "faces cut". `skipped`: "pairs that still cross". `touched_faces` are
/// the pieces.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it was.
Report remove_self_intersections(Soup& soup, const RemoveSelfIntersectionsOptions& options, Context& context);

}  // namespace tri

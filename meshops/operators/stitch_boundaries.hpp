#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// How far apart boundaries may be that are sewn together.
struct StitchBoundariesOptions {
  double tolerance = 0;  ///< model units; widest gap that is closed; 0: only boundary edges that coincide

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Joins boundary edges that lie on one another, or face each other across a narrow gap.
///
/// Only edges of one triangle are looked at, and only those whose triangles run along them in opposite directions are
/// joined. First those with coincident ends. Then, up to the tolerance, boundary vertices that are mutually nearest (of
/// those that share no triangle's edge with them) meet in the middle between them, attributes interpolated, wherever
/// that joins an edge. Repeated until nothing more joins; a vertex that is not moved for it stays. A pair is left open
/// where meeting would turn a triangle over, give an edge a third triangle or only make vertices touch. No triangle is
/// added or removed. A gap whose sides are divided differently is closed by `resolve_t_junctions` first. O(triangles),
/// and a search tree of the boundary vertices.
///
/// Counts: `vertices_removed`, `vertices_moved`. Figures: "edges joined", "edges joined across a gap". `skipped`:
/// "edges that would be crowded, or run the same way", "triangle would turn over".
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report stitch_boundaries(Soup& soup, const StitchBoundariesOptions& options, Context& context);

}  // namespace tri

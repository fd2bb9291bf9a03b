#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// From what distance on a vertex counts as on a side.
struct ResolveTJunctionsOptions {
  double tolerance = 0;  ///< model units; how far from a boundary edge a vertex counts as being on it
  /// The same as a share of the diagonal of the bounding box; the larger of the two is used. 0 and 0: exactly on it.
  double relative_tolerance = 1e-6;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Splits boundary edges (edges of one triangle) where other boundary vertices lie on them, and joins what then
/// coincides.
///
/// A vertex is on an edge if it is within the tolerance of its inner part and farther than that from both ends. Each
/// edge is looked at once and split at all its vertices, in order along it; of vertices within the tolerance of each
/// other one is taken. The triangle at the edge is cut into as many more; the new corners lie exactly at the vertices,
/// their attributes are interpolated along the edge, those of the pieces are the triangle's. The edges that now lie
/// together are joined, as `stitch_boundaries` does; where that is not possible (an edge would get a third triangle)
/// they stay apart. Never turns a triangle over: the triangle then stays whole. Triangles without area are left alone.
/// Pieces come last. O((edges + vertices) log edges).
///
/// Counts: `vertices_added`, `faces_added` and, where ends were joined, `vertices_removed`. Figures: "edges split",
/// "T-junctions", "edges joined". `skipped`: "triangle would turn over". `touched_faces` are the pieces.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report resolve_t_junctions(Soup& soup, const ResolveTJunctionsOptions& options, Context& context);

}  // namespace tri

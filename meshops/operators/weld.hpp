#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Which vertices become one.
struct WeldOptions {
  /// Model units; 0: only vertices with identical coordinates (0 and -0 are identical). Above 0 also vertices on loose
  /// edges (edges of one triangle) that are no farther apart.
  double tolerance = 0;
  /// Vertices at the same place become one even if they only touch there, or if edges then have more than two
  /// triangles: all that lie together, whatever it does.
  bool touching = false;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Makes vertices that lie together one, where that joins edges.
///
/// Exactly coincident vertices first, then, with a tolerance, those within it, the closest pairs first. A set of
/// vertices never gets wider than the tolerance, so no chain of them can creep together; its position and attributes
/// are those of its first vertex. Never worse than before: an edge of two triangles never gets a third, vertices that
/// would only touch without a common edge stay apart (the mesh stays manifold there), two vertices of one triangle are
/// never welded by tolerance (so no triangle collapses; that is `remove_degenerate`'s work), and no triangle with an
/// area turns over. Three or more loose edges at identical places become one edge; within a tolerance they stay apart.
/// Triangles that come to name a vertex twice are dropped: loose ones without extent only. Vertices that no triangle
/// uses are welded as well. The order of what stays is kept. Exact: O(vertices + triangles); with a tolerance k-d tree
/// searches of the loose vertices come on top, and of each at most 32 neighbours are looked at.
///
/// Counts: `vertices_removed`, `vertices_moved`, `faces_removed`. Figures: "edges joined", "edges of three or more
/// triangles made". `skipped`: "vertices that only touch, or would crowd an edge", "triangle would turn over".
/// `touched_vertices` are those that others became one with.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report weld(Soup& soup, const WeldOptions& options, Context& context);

}  // namespace tri

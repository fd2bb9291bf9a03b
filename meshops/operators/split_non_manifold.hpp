#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// There is nothing to choose.
struct SplitNonManifoldOptions {
  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Takes sheets apart where more than two triangles meet in an edge or several fans in a vertex, by copying vertices.
///
/// As `build_mesh` does it, see `make_manifold`: triangles that disagree with their neighbours are turned first; then
/// the triangles around an edge are paired in angular order so that sheets come apart without crossing, two that touch
/// enclose their own material, and a fin comes off; then every fan of triangles at a vertex gets a vertex of its own.
/// No triangle is dropped, nothing moves; copies have the attributes of their vertex and come after all others.
/// Surfaces with one side only are cut open. Orient solids first: what is material is told from the orientation.
/// Triangles that name a vertex twice are left alone. O(triangles), if nearly everything is manifold.
///
/// Counts: `vertices_added`, `faces_reversed`. Figures: "edges of three or more triangles split", "edges cut",
/// "triangles detached". `touched_vertices` are the copies, `touched_faces` the triangles turned or detached.
/// @throws InvalidInput if the soup is inconsistent; Cancelled. The soup is then as it was.
Report split_non_manifold(Soup& soup, const SplitNonManifoldOptions& options, Context& context);

}  // namespace tri

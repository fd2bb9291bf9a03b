#pragma once

#include <numbers>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Where new and old vertices go.
enum class SubdivisionScheme {
  loop,       ///< smooths: the limit is C2 but for irregular vertices [Loop 1987]
  butterfly,  ///< smooth as well, through the vertices; wavier [Zorin, Schroeder & Sweldens 1996]
  midpoint,   ///< the same surface in smaller triangles
};

/// What keeps vertices back.
enum class SubdivisionGuard {
  folds,      ///< pieces that would be turned over
  crossings,  ///< these, and pieces that would cross others; every level is searched, which takes several times as long
  none,       ///< nothing
};

/// By which rules, how often, and what stays sharp.
struct SubdivideOptions {
  SubdivisionScheme scheme = SubdivisionScheme::loop;  ///< where new and old vertices go
  SubdivisionGuard guard = SubdivisionGuard::folds;    ///< not midpoint: what keeps vertices back
  int levels = 1;                                      ///< each makes four triangles of one
  /// Radians; not midpoint: edges with a larger angle between normals before the first level stay sharp, on every
  /// level.
  double feature_angle = 60 * std::numbers::pi / 180;
  /// Radians; not midpoint: where a crease or the boundary turns by more is a corner, which stays in its place.
  double corner_angle = 50 * std::numbers::pi / 180;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Splits every triangle into four, at new vertices on its edges.
///
/// `midpoint` puts them into the middle of the edges and moves nothing; `butterfly` moves no old vertex either, and
/// puts the new ones where a smooth surface through the old ones would run (`butterfly_edge_point`; where
/// triangles are very uneven it makes waves). `loop` smooths: it
/// moves the old vertices as well (`loop_edge_point`, `loop_vertex_point`). Boundary and creases become curves of their
/// own, for loop cubic B-splines [Hoppe et al. 1994, "Piecewise smooth surface reconstruction", without its special
/// weights beside corners]; corners stay; where a crease fades out it is smooth. Which edges and vertices these are is
/// found once, by `find_features` with both angles, and handed down from level to level. Where not all around a vertex
/// is split (at the rim of a selection) it stays; triangles that keep an edge whole are split into two or three. A
/// point whose stencil is not finite goes to the middle of the edge, or stays.
///
/// Unless `guard` is `none`, the vertices of pieces that would be turned over (by more than a quarter turn from the
/// triangle they are cut from) stay on the triangles of the level before. With `crossings` so do those of pieces that
/// would cross others, so that a mesh that does not intersect itself does not come to, but for rounding; without it
/// sheets that nearly touch may cross afterwards, and nothing says so. Vertices that stay are counted in `skipped`
/// ("vertices where triangles would fold or cross"; on each level anew), and a note names the first. Where triangles
/// are long and thin, as those of CAD models are, these may be many, and
/// `midpoint` is the better choice.
///
/// Handles of all elements stay; a face keeps its handle for one of its four pieces, an edge for one of its halves. New
/// vertices inherit the mean of the ends of their edge, faces what they are a piece of (see
/// meshops/editing/mesh_edit.hpp); the values of old vertices stay. Linear in what is made. `touched_faces`,
/// `touched_vertices`: all that changed or are new. `vertices_moved` counts old vertices. `skipped`: "edges of
/// triangles back to back", whose pieces would have edges twice. Points are computed in parallel, with the same result
/// for any number of threads; splitting is serial.
///
/// On cancel (checked every 1024 edges) the mesh is valid, and its surface is exactly that of the last whole level:
/// some edges are split, in their middle.
/// @throws InvalidInput if an option is out of range, or the mesh would get more than 500 million faces; it is
/// untouched.
Report subdivide(MeshView mesh, const SubdivideOptions& options, Context& context);

}  // namespace tri

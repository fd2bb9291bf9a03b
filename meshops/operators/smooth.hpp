#pragma once

#include <limits>
#include <numbers>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

/// How a vertex is moved.
enum class SmoothMethod {
  laplace,    ///< towards the mean of the neighbours; shrinks, and evens the triangles out
  taubin,     ///< the same with a step back after each, which keeps the volume [Taubin 1995]
  cotangent,  ///< implicit mean curvature flow: hardly moves vertices along the surface; shrinks
};

/// What becomes of vertices on creases and boundaries.
enum class LineRule {
  fixed,  ///< they stay where they are
  along,  ///< each line is smoothed as a curve of its own, by the same method, between corners that stay
};

/// How much is smoothed, and what stays in its place.
struct SmoothOptions {
  SmoothMethod method = SmoothMethod::taubin;  ///< how a vertex is moved
  int iterations = 10;                         ///< 1 to 100,000; taubin: each with its step back
  /// Part of the way to the mean of the neighbours that a vertex goes in one iteration, above 0; laplace: at most 1,
  /// taubin: at most 0.65. cotangent: a time step that does about as much as a laplace iteration of this strength, at
  /// most 100.
  double strength = 0.5;
  double feature_angle = 44 * std::numbers::pi / 180;  ///< radians; edges with a larger angle between normals are
                                                       ///< creases
  int min_feature_edges = 10;                          ///< creases that hang together in fewer edges are noise
  LineRule creases = LineRule::fixed;                  ///< what becomes of vertices on creases
  LineRule boundary = LineRule::fixed;                 ///< what becomes of vertices on the boundary
  double max_distance = std::numeric_limits<double>::infinity();  ///< model units; no vertex ends farther from its
                                                                  ///< start

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Smooths by moving vertices; links and handles stay.
///
/// Taubin, the default, takes noise off and keeps the volume: a pass forward with `strength`, one back with 1 / (0.1 -
/// 1 / strength) [Taubin 1995, "A signal processing approach to fair surface design", pass band 0.1]. On spheres with
/// noise of a tenth of the edge length, 10 iterations leave 0.37 of the noise (laplace 0.20, cotangent 0.17), whether
/// the triangles are even or not, and change the volume of 20,000 triangles by 0.07% (laplace 1.1%, cotangent 1.0%).
/// Laplace and Taubin weigh all neighbours alike. Cotangent is the implicit flow of `CurvatureFlow`, with new weights
/// in every iteration: of the ways to use these weights it is the one that needles do not disturb (an explicit flow
/// with them left 0.44 of the noise and turned triangles over where a seventh of the edges had been split into needles;
/// the implicit one 0.16, turning over none). An iteration costs some 20 times that of laplace, several times
/// more with many needles.
///
/// Creases and corners are those of `find_features` with `feature_angle`, `min_feature_edges` and `Noise::unknown`,
/// looked for once, before anything moves. Below 45 degrees the angle keeps chamfers. Where noise is above some three
/// tenths of the edge length it begins to look like creases, and wants a larger angle (180 degrees: none) or more
/// edges; the report has a note where creases hold more than a fifth of the vertices. Corners, ends of creases that are
/// fixed, and points that are not finite stay; the latter pull no neighbour. Where `max_distance` is finite, a vertex
/// that would end an iteration farther from its start than that stops on the way. After the last iteration the vertices
/// of triangles that were not folded over and now are (against the triangles beside them, creases apart) are taken back
/// by half of their way, up to three times, and then to where they were, so that none is folded over by smoothing.
///
/// A coordinate that all points share is kept bit for bit. No new point is NaN, whatever the triangles. Linear time for
/// each iteration; parallel, with the same result for any number of threads. `touched_vertices`: those that moved.
/// `skipped`: vertices "on a crease", "on the boundary", "at a corner", "not finite" that stay for that reason.
/// Figures: "mean distance" and "largest distance" (model units, of the vertices that moved), "held by max-distance"
/// and "held back from folding" (vertices, if any), "volume before" and "volume after" (of closed meshes), "faces
/// turned over" (normals turned by more than 90 degrees, if any).
///
/// On cancel (heeded within milliseconds) the mesh is untouched.
/// @throws InvalidInput if an option is out of range, or `strength` out of that of the method; the mesh is untouched.
Report smooth(MeshView mesh, const SmoothOptions& options, Context& context);

}  // namespace tri

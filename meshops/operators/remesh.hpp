#pragma once

#include <limits>
#include <numbers>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

/// How long edges are to be, and which lines stay.
struct RemeshOptions {
  /// Model units: the edge length aimed at. 0: the mean length of the edges; with `adaptive` a twentieth of the
  /// diagonal.
  double length = 0;
  int iterations = 6;  ///< rounds of splitting, collapsing, flipping and smoothing
  /// Edges as long as the curvature and `max_error` allow, and no longer than `length`.
  bool adaptive = false;
  double min_length = 0;  ///< model units; with `adaptive` no edge is aimed at that is shorter. 0: a twentieth of
                          ///< `length`
  /// Model units: nothing is done that takes the middle of an edge or triangle farther from the input, and edges that
  /// are farther off are split. No bound on other places, nor on how far the input is from the result: both are
  /// measured and reported. `adaptive` needs it.
  double max_error = std::numeric_limits<double>::infinity();
  double feature_angle = 44 * std::numbers::pi / 180;  ///< radians between normals above which an edge is a crease
  int min_feature_edges = 1;                           ///< creases that hang together in fewer edges are noise

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Makes triangles as equilateral and alike as the shape allows [Botsch & Kobbelt 2004, "A remeshing approach to
/// multiresolution modeling"; sizes after Dunyach, Vanderhaeghe, Barthe & Botsch 2013].
///
/// Each round splits edges longer than 4/3 of the length aimed at (longest first), collapses those shorter than 4/5
/// into one of their ends, flips towards even valences, moves vertices towards the centre of the triangles around them,
/// and puts them back on the input: the closest place of its triangles, or of its line. Boundaries, creases
/// (`feature_angle`) and seams of attributes are lines: their vertices slide along the input's polylines, from corner
/// to corner; corners (where lines meet, end, or turn by more than 50 degrees) stay, and no line is cut short by more
/// than a twentieth of the length: small holes and rounded corners keep shorter edges. So every vertex lies on the
/// input, on its polyline where it belongs to one, to rounding (or in the middle of an edge that was split, where
/// triangles would cross otherwise). Topology stays. Nothing is done that turns a triangle over, or makes more pairs of
/// triangles cross than did before (exact, `CrossingGuard`; only the middle of an edge that is split may be rounded
/// across something that touches the edge).
///
/// Values of vertices and corners are those of the input at the new places. With a selection the rim of it stays.
/// Figures: "length" (aimed at; adaptive: the mean), "greatest distance" (of vertices, middles of edges and of
/// triangles to the input), "edges in range" (share within 4/5 to 4/3 of what was aimed at), "smallest angle"
/// (degrees), "faces"; "crossing pairs" of triangles, if there are any, and a note if there are more than before; with
/// `max_error` those of `report_distance`.
///
/// Near-linear. Smoothing and projection use all threads, the rest is serial; the same result for any number of
/// threads. On cancel (checked every 256 edges) the mesh is valid, somewhere on the way; values are as far as they were
/// interpolated.
/// @throws InvalidInput if an option is out of range, `adaptive` comes without `max_error`, a coordinate is not finite
/// or more than 2^28 triangles would be made; the mesh is untouched.
Report remesh(MeshView mesh, const RemeshOptions& options, Context& context);

}  // namespace tri

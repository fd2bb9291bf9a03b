#pragma once

#include <limits>
#include <numbers>
#include <string>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/reference.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Where the pairs of contours come from.
enum class ContourPairs {
  automatic,  ///< given ones if there are any, else found
  given,      ///< from the reference; without one, from the edge property
  found,      ///< stretches of boundary that face each other
  both,       ///< given ones first, then found ones in what is left open
};

/// Which contours are joined, and over how wide a gap.
struct StitchContoursOptions {
  ContourPairs pairs = ContourPairs::automatic;  ///< where the pairs come from
  /// Found pairs: the widest gap, times the local spacing (`local_spacing`, the larger of both sides).
  double max_gap = 3;
  /// Found pairs: the widest gap in model units; takes the place of `max_gap` when finite.
  double max_distance = std::numeric_limits<double>::infinity();
  /// [rad] The largest angle between a new triangle and the face it is joined to; beyond it would be flipped.
  double max_turn = 130 * std::numbers::pi / 180;
  /// Loops of at most this many edges that stitching left, where three or more contours meet, are closed if they are no
  /// wider (4 area / circumference) than the widest gap; 0 closes none.
  int max_corner_edges = 16;
  /// Edge property (int): boundary edges with the same value >= 0 form the two contours of one pair, each unbroken.
  std::string pair_property = "e:contour_pair";
  /// Gives the pairs if not null. C++ only.
  const Reference* reference = nullptr;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Joins pairs of boundary contours by strips of triangles [Ganapathy & Dennehy 1982; Ristic et al. 2000, step (f)]:
/// open stretches and closed loops, of one component or of two (`triangulate_contours` says how, `FacingContours` how
/// pairs are found).
///
/// Adds faces and edges; no vertex is added or moved, existing handles and positions keep. New faces run with the faces
/// on both sides, so contours of two patches that are oriented differently are no pair. Small loops that are left where
/// three or more contours meet, and where a ragged stretch was passed over, are then closed as `fill_holes` would. No
/// edge gets more than two faces, no vertex becomes a bow-tie, no triangle of a strip lacks an area or turns by more
/// than `max_turn` against the face at its base. (Where the patches themselves overlap, what closes the small loop
/// between them folds with them.) Left open, in `skipped` by reason: "contour is not a free boundary" (a given contour
/// that is no run of boundary half-edges), "pair without two contours" (the edge property), "contours do not fit" (no
/// strip without such a triangle, edge or vertex), "corner larger than max-corner-edges", "corner without a
/// triangulation", "kept open by the reference" (corners only). Contours in the same place are not joined: that is a
/// weld. With a selection, only boundary edges that it allows to fill are joined. Figures: "contours joined", "corners
/// closed". On cancel (checked between contours): what was joined so far stays and the mesh is valid.
/// @throws InvalidInput if an option is out of range; the mesh is untouched.
Report stitch_contours(MeshView mesh, const StitchContoursOptions& options, Context& context);

}  // namespace tri

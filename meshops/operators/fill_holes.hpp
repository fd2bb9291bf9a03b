#pragma once

#include <limits>

#include "meshops/context.hpp"
#include "meshops/holes/hole.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/reference.hpp"
#include "meshops/report.hpp"

namespace tri {

/// How smoothly the filling of a hole goes on from its surroundings; see `Continuity`.
enum class Fairness { none, position, tangent, curvature };

/// Which loops are filled, and how.
struct FillHolesOptions {
  HoleStrategy strategy = HoleStrategy::least_bending;  ///< what is least in the filling
  int max_edges = 100000;                               ///< loops with more edges stay open
  /// Model units; loops with two vertices farther apart stay open.
  double max_diameter = std::numeric_limits<double>::infinity();
  /// Loops with more edges are optimised piece by piece (`fill_ring`), so that the cubic cost of searching all
  /// triangulations stays bounded: 128 edges take about 5 ms, 1000 edges a second or two (which no cancel interrupts).
  int max_dynamic_edges = 128;
  /// Also puts vertices into the holes, as dense as those at the rim (`refine_faces`).
  bool refine = false;
  /// By how much the length of edges grows for each unit of distance from the rim, when refining: with 0 the rim's
  /// spacing goes on through the whole hole, and a hole of 10,000 edges takes millions of triangles.
  double growth = 0.1;
  /// Also moves those vertices so that the filling goes on from its surroundings (`faired_points`); refines too.
  Fairness fair = Fairness::none;
  /// May say that a hole belongs to the part and stays open; null: none does. C++ only.
  const Reference* reference = nullptr;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Triangulates boundary loops of at most `max_edges` edges.
///
/// Adds faces and edges; existing handles and positions keep. No vertex is added unless `refine` or `fair` ask for it,
/// which they do not by default: in a mesh of measured points every vertex is a point that was measured. New elements
/// take their properties from the rim (see meshops/editing/mesh_edit.hpp). No chord is used that is an edge of the mesh
/// already, so no edge gets more than two faces and no triangle appears twice; if a hole cannot be triangulated the
/// mesh is not modified there. Finding a filling was near-linear up to 40,000 edges in measurements,
/// and so was the check for crossings below, which is a third of that where a filling and the surface around it can be
/// projected to a plane; where other parts of the mesh are in the way and consist of needles, it is the larger part.
///
/// Islands: the rim of a sheet that lies in a hole becomes an inner contour of the filling, and keeps every vertex.
/// `find_hole_islands` states the rule. A loop that meets itself in vertices is one outline if some of its simple parts
/// are rims of sheets (an island that touches the rim) and others are not; else each simple part is a loop of its own.
///
/// A filling goes round the rest of the mesh and earlier fillings, and does not cross itself, where that can be had:
/// where triangles cross, pieces around them are triangulated anew, then the other strategies are tried (`Hole::fill`).
/// Flips when refining make no new crossings with the mesh; where the faired filling would, it keeps the place it had
/// before.
///
/// Loops left open are counted in `skipped` by reason: "loop longer than max-edges", "loop wider than max-diameter",
/// "loop meets itself in a vertex" (a part of one that does not fit), "rim of a single triangle", "kept open by the
/// reference", "no triangulation without an existing edge", "rim of a sheet". The last is the outer rim of a sheet or
/// an island that is in no hole: the new faces would lie on the back of those at the rim (the mean cosine between the
/// loop's own normal and the normals of the faces along it is below -0.5). Every other loop counts as a hole, both ends
/// of an open tube too: bound them by `max_edges` or `max_diameter`. "island without a way to its hole": it stays as it
/// is, and the hole is filled without it. Figures: "holes filled", "islands joined", "loops cut apart where they meet
/// themselves", "holes optimised in pieces" (those above `max_dynamic_edges`), "fillings that cross the mesh" (or
/// themselves; up to ten notes say where), "fillings not faired" (fairing failed with cotangent and uniform weights,
/// see `FairingOutcome`; they stay refined), "fillings faired in part, since they would cross the mesh", "fillings not
/// faired, since they would cross the mesh".
///
/// On cancel: the holes finished so far stay filled, one may be filled and not yet refined or faired, and the mesh is
/// valid. Cancel is heeded between pieces, but not within the decomposition when fairing, while the trees for the check
/// of crossings are built, and within a search with `max_dynamic_edges` above 200.
/// @throws InvalidInput if an option is out of range; the mesh is untouched.
Report fill_holes(MeshView mesh, const FillHolesOptions& options, Context& context);

}  // namespace tri

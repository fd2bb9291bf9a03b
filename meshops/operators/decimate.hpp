#pragma once

#include <cstdint>
#include <limits>
#include <numbers>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

/// When decimation stops, and how well shaped what is left has to be.
struct DecimateOptions {
  std::int64_t faces = 0;  ///< stop at this many faces or one fewer; 0: no such target
  double ratio = 0;        ///< stop at this share of the faces, in [0,1]; 0: no such target
  /// Model units: no collapse whose error exceeds this. Error is the root of the mean squared distance of the new
  /// vertex to the planes of the triangles it stands for (and to those that stand on boundaries and creases). That is
  /// no bound on the distance between the surfaces, which may be some times more: it is measured and reported.
  double max_error = std::numeric_limits<double>::infinity();
  double feature_angle = 40 * std::numbers::pi / 180;  ///< radians between normals above which an edge is held as a
                                                       ///< crease
  /// Triangles less round than this are not made, unless the place had one as bad: 1 is equilateral, 0 has no area.
  double min_roundness = 0.05;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Simplifies by edge collapses in order of their quadric error [Garland & Heckbert 1997].
///
/// Each vertex has the area-weighted planes of the triangles around it, and planes that stand upright on boundaries,
/// creases (edges sharper than `feature_angle`) and seams of attributes; a collapse joins two, and the vertex goes
/// where the sum is least. Costs only grow when quadrics are added, so an edge is looked at again when its turn comes,
/// not whenever a neighbour changes, and buckets (of 1%) take the place of a heap. With several targets the first that
/// is reached ends the work; without any, half of the faces stay.
///
/// Never done: a collapse that would change the topology (link condition [Dey et al. 1999]; boundary loops and
/// components stay), turn a triangle over (more than about 75 degrees), make a needle (see `min_roundness`), join two
/// boundaries or seams, cut a chord between two places of one, or make more pairs of triangles cross than did before
/// (exact, `CrossingGuard`): a mesh that does not intersect itself does not do so afterwards. Corners at which three
/// seams or boundaries meet stay where they are. A boundary or crease moves within the error only; a straight one stays
/// straight.
///
/// With a selection only its faces count for the targets, and all vertices stay around which there is a face outside.
///
/// Of two ends, one is marked deleted, with its edge and the triangles beside it; the other stays, with its handle,
/// where the new vertex is. Values of the vertex and its corners are interpolated between those of the two ends.
/// Figures: "faces", "greatest error" (model units, as above); with `max_error` those of `report_distance` as well, if
/// anything was done. `skipped`, if no target stopped the work: edges that
/// stay, by reason.
///
/// Near-linear. Serial but for the preparation; the same result for any number of threads.
/// On cancel (checked every 256 collapses) the mesh is valid, with the collapses done so far.
/// @throws InvalidInput if an option is out of range; the mesh is untouched.
Report decimate(MeshView mesh, const DecimateOptions& options, Context& context);

}  // namespace tri

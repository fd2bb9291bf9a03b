#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/points/point_set.hpp"
#include "meshops/report.hpp"

namespace tri {

/// How close points may be.
struct ThinOptions {
  double voxel = 1;  ///< side of a voxel in the unit of the points, above 0

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Keeps one measured point in each voxel of a regular grid: the one nearest the mean of the voxel's points (the
/// earliest of those equally near, to a millionth). No point is invented or moved; all columns stay with their points,
/// which keep their order.
///
/// The grid starts at the origin, so that a point's voxel does not depend on the other points, and a second run changes
/// nothing. Parallel sorting by voxel; 16 bytes a point.
///
/// Counts: `vertices_removed`. Figures: "points kept", "points in the fullest voxel". `maps.vertices`: old to new
/// index.
/// @throws InvalidInput if an option is out of range, the set is inconsistent, or the voxel is so small that a
/// coordinate
///         is more than 2^50 of them; Cancelled. The set is then as it was.
Report thin(PointSet& set, const ThinOptions& options, Context& context);

}  // namespace tri

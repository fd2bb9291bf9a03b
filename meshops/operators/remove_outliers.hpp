#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/points/point_set.hpp"
#include "meshops/report.hpp"

namespace tri {

/// From what distance to its neighbours on a point goes.
struct RemoveOutliersOptions {
  int neighbors = 16;  ///< nearest points that are looked at, 1 or more
  double sigma = 3;    ///< standard deviations above the mean, 0 or more; infinity removes nothing

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Removes points that lie alone: those whose mean distance to their nearest points is more than `sigma` standard
/// deviations above the mean of these distances over all points [Rusu et al. 2008, "Towards 3D point cloud based object
/// maps for household environments", section 4.1].
///
/// One round, as in the paper; a further run looks at what is left and may remove more. The points that stay keep their
/// order and columns. A scan of uneven density loses points where it is thin: look at the figures. With fewer points
/// than neighbours all other points are looked at; fewer than two are left alone. O(N log N) by a k-d tree, whose
/// queries run on all threads; results do not depend on their number.
///
/// Counts: `vertices_removed`. Figures: "mean distance", "standard deviation", "limit", in the unit of the points.
/// `maps.vertices`: old to new index. Cancel: within 16,384 points.
/// @throws InvalidInput if an option is out of range or the set is inconsistent; Cancelled. The set is then as it was.
Report remove_outliers(PointSet& set, const RemoveOutliersOptions& options, Context& context);

}  // namespace tri

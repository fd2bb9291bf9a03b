#pragma once

#include "meshops/crossings/arrangement/grid_geometry.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// How points in space are rounded to the grid, and back without rounding.
class GridFrame {
 public:
  static constexpr int doubles = 51, floats = 23;

  /// The finest grid of a power of two that covers the box of the points that triangles use with 2^28 steps a side, and
  /// none of whose steps is less than 2^-`finest` of the power of two at the farthest coordinate, so that numbers of
  /// double or single precision hold it.
  GridFrame(const Soup& soup, int finest);

  GridPoint to_grid(const Vec3& p) const;
  Vec3 to_space(const GridPoint& p) const;
  double step() const { return step_; }  ///< model units
  /// Grid steps in a share of the next power of two above the extent, at least 2.
  double steps_in(double share) const;

 private:
  Vec3 origin_{0, 0, 0};
  double step_ = 1;
  double extent_ = 0;  ///< model units
};

}  // namespace tri

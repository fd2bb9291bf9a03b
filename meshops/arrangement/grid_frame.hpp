#pragma once

#include <span>

#include "meshops/arrangement/grid_geometry.hpp"

namespace tri {

/// How points in space are rounded to the grid, and back without rounding.
class GridFrame {
 public:
  /// The finest grid of a power of two that covers the box of `points` with 2^28 steps a side and that doubles can hold.
  explicit GridFrame(std::span<const Vec3> points);

  GridPoint to_grid(const Vec3& p) const;
  Vec3 to_space(const GridPoint& p) const;
  double step() const { return step_; }  ///< model units

 private:
  Vec3 origin_{0, 0, 0};
  double step_ = 1;
};

}  // namespace tri

#pragma once

#include <vector>

#include "meshops/arrangement/crossing_complex.hpp"
#include "meshops/arrangement/solid_boundary.hpp"

namespace tri {

/// A solid boundary on the grid, every vertex with a place of its own.
struct PlacedBoundary {
  std::vector<GridPoint> points;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> face;   ///< of each triangle: the face of the complex
  std::vector<std::uint32_t> point;  ///< of each vertex: the point of the complex, or none (0xffffffff)
  std::size_t parted = 0;            ///< triangles that were raised
  /// Faces of the complex whose sheets would cross something however little they are raised.
  std::vector<std::uint32_t> touching;
};

/// Parts the sheets that lie upon each other: each gets a vertex in its middle, raised off the other sheet by as much as
/// `height`, or by less where it would cross something.
/// @param height grid steps, at least 1
PlacedBoundary part_sheets(const CrossingComplex& complex, const SolidBoundary& boundary, double height, Context& context);

}  // namespace tri

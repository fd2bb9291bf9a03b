#pragma once

#include <map>
#include <vector>

#include "meshops/crossings/arrangement/crossing_complex.hpp"
#include "meshops/crossings/arrangement/solid_boundary.hpp"

namespace tri {

/// A solid boundary on the grid, every vertex with a place of its own.
struct PlacedBoundary {
  std::vector<GridPoint> points;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> face;   ///< of each triangle: the face of the complex
  std::vector<std::uint32_t> point;  ///< of each vertex: the point of the complex, or none (0xffffffff)
  std::vector<char> moved;           ///< of each vertex: whether it is not at its point
  std::size_t parted = 0;            ///< vertices that lay upon others, and triangles that were raised
  /// Faces of the complex whose sheets would cross something however little they are raised.
  std::vector<std::uint32_t> touching;
};

/// How far vertices moved, by place and direction, for the next time most of them are moved again.
using SheetMemory = std::map<std::array<double, 6>, double>;

/// Parts what lies upon each other: of vertices in one place each moves to its own side of the sheets at it, or into
/// its own solid, by as much as `height`, or by less where it would make something cross; where that cannot be, they
/// stay in one place. Sheets none of whose corners could move get a vertex in their middle, raised off the other sheet
/// likewise.
/// @param height grid steps, at least 1
/// @param memory of earlier calls with the same complex
PlacedBoundary part_sheets(const CrossingComplex& complex, const SolidBoundary& boundary, double height,
                           SheetMemory& memory, Context& context);

}  // namespace tri

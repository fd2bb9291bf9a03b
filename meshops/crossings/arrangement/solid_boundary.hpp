#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/crossings/arrangement/crossing_complex.hpp"
#include "meshops/soup.hpp"

namespace tri {

struct SolidBoundaryOptions {
  /// For each face: whether it stays, as two sheets with nothing between them, where the same lies on both its sides (a
  /// wall inside the solid, a sheet outside). Empty: none does.
  std::vector<char> keep_walls;
};

/// The oriented boundary of what closed triangles enclose.
struct SolidBoundary {
  std::vector<Triangle> triangles;
  /// Of each triangle: the face of the complex.
  std::vector<std::uint32_t> face;
  /// Of each triangle: 0, or which way it has to move to part from the second sheet that lies upon it: 1 along its
  /// normal (a sheet outside becomes a thin plate), -1 against it (a wall inside becomes a thin gap).
  std::vector<signed char> sheet;
  struct Vertex {
    std::uint32_t point;  ///< of the complex, or none (0xffffffff)
    GridPoint place;
  };
  /// Those in [0, points of the complex) are its points, used or not.
  std::vector<Vertex> vertices;

  std::size_t dropped_walls = 0;  ///< faces of the complex that have the same on both sides and did not stay
  std::size_t doubled = 0;        ///< faces that stay as two sheets
  std::size_t edges_halved = 0;   ///< because else two edges would join the same vertices
};

/// Which faces have the same on both sides; `in` and `out` are decided by winding numbers, which are found by going
/// from cell to cell [Zhou et al. 2016]: inside is whatever is wound round, either way.
struct CellLabels {
  /// Of each face: whether inside lies at its front (to which its normal points) and at its back.
  std::vector<std::array<char, 2>> inside;
  std::vector<std::uint32_t> part;  ///< of each face: faces that are joined over edges
};

/// @param complex without crossings
/// @param cavity  by `source` of the faces: whether they bound the inside of a cavity
CellLabels label_cells(const CrossingComplex& complex, std::span<const char> cavity, Context& context);

/// Closed, manifold and oriented with the inside behind each triangle: around every edge the sheets are joined in pairs
/// that do not cross, and vertices are copied for each fan.
SolidBoundary solid_boundary(const CrossingComplex& complex, const CellLabels& labels,
                             const SolidBoundaryOptions& options, Context& context);

}  // namespace tri

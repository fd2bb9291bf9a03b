#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Triangles of any topology, turned coherently and closed.
struct ClosedSurface {
  std::vector<Triangle> triangles;    ///< the given ones in their order, some reversed; then those that close the holes
  std::vector<std::uint32_t> source;  ///< of each: itself, or for those that close a hole a given one at its rim
  std::vector<char> cavity;           ///< of each: whether its component is inside out within another one
  std::size_t given = 0;              ///< how many of them are the given ones
  std::size_t holes = 0;              ///< loops that were closed
  std::size_t reversed = 0;           ///< triangles that were turned round
  std::size_t inside_out = 0;         ///< components that were turned round as a whole
  double boundary_length = 0;         ///< of all loops, model units
};

/// Pairs the sides of the triangles as `make_manifold` does, closes every loop that is left with triangles between its
/// own vertices (`fill_ring` for the least largest dihedral angle, then area) and turns each closed component outward,
/// unless it is a cavity: inside out and within another one.
///
/// The new triangles may cross anything and may lie upon others. As a chain the result has no boundary.
/// @param triangles none names a vertex twice
ClosedSurface close_surface(std::span<const Vec3> points, std::span<const Triangle> triangles, Context& context);

}  // namespace tri

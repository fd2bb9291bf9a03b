#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A few thousand of the measured points, evenly over the part, with the direction of the surface there.
struct ScanSubset {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;  ///< unit; (0,0,0) where the neighbours do not lie on a plane
  bool oriented = false;      ///< the normals tell the two sides apart
  Vec3 centre{0, 0, 0};       ///< median of the coordinates
  double radius = 0;          ///< mm: nine tenths of the points are nearer to the centre
  double half_radius = 0;     ///< mm: half of them are
};

/// Thins `points` to about `count` by cubes of one size, and finds a plane through the neighbours of each point left.
///
/// @param normals  those of the file, or empty
/// @param seed     chooses where there are more than some ten thousand points to look at
ScanSubset scan_subset(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t count,
                       std::uint64_t seed, const Context& context);

/// Where a set of points is and how far it reaches, regardless of a tenth of them.
struct PointExtent {
  Vec3 centre{0, 0, 0};    ///< median of the coordinates
  double radius = 0;       ///< mm: nine tenths of the points are nearer to the centre
  double half_radius = 0;  ///< mm: half of them are
};
PointExtent extent_of(std::span<const Vec3> points);

/// `count` different indices below `size`, ascending, drawn without bias [Knuth, selection sampling]; all if there are
/// fewer.
std::vector<std::uint32_t> random_indices(std::size_t size, std::size_t count, std::uint64_t seed);

}  // namespace tri

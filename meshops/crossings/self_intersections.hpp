#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What becomes of pairs of triangles that name a vertex in common.
enum class Neighbors {
  skip,   ///< they are not looked at
  judge,  ///< they intersect if they meet in more than the corners or the side they share
};

/// Pairs of triangles that have a point in common, each as (lower index, higher index), ascending.
///
/// Exact for any finite coordinates: signs are decided in double precision where an error bound allows it, else in
/// integers. Triangles without area are left out. Boxes are searched with a bounding-volume hierarchy; threads do not
/// change the result.
/// @param points     mm or any unit; finite
/// @param triangles  indices below points.size()
/// @throws Cancelled at the granularity of 1024 triangles
std::vector<std::array<std::uint32_t, 2>> self_intersections(std::span<const Vec3> points,
                                                             std::span<const Triangle> triangles,
                                                             const Context& context,
                                                             Neighbors neighbors = Neighbors::skip);

}  // namespace tri

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Pairs of triangles that share no vertex and have a point in common, each as (lower index, higher index), ascending.
///
/// Orientation signs are decided in double precision where an error bound allows it, else in 113-bit arithmetic. Triangles
/// without area are left out. Boxes are searched with a bounding-volume hierarchy; threads do not change the result.
/// @param points     mm or any unit; finite
/// @param triangles  indices below points.size()
/// @throws Cancelled at the granularity of 1024 triangles
std::vector<std::array<std::uint32_t, 2>> self_intersections(std::span<const Vec3> points, std::span<const Triangle> triangles,
                                                             const Context& context);

/// Whether two triangles, given by their corners, have a point in common.
bool triangles_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

}  // namespace tri

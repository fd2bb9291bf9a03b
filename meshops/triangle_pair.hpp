#pragma once

#include <array>

#include "meshops/vec.hpp"

namespace tri {

/// Whether two triangles that have an area have a point in common. Exact.
bool triangles_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles that have an area and share their first corner meet anywhere else: the side opposite to it of one of
/// them meets the other triangle. Exact.
bool fans_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles that have an area and share their first two corners lie on one another: their third corners are in
/// one plane and on the same side of the edge. Exact.
bool wings_overlap(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b);

}  // namespace tri

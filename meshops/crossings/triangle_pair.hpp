#pragma once

#include <array>
#include <cstdint>

#include "meshops/vec.hpp"

namespace tri {

/// Whether two triangles that have an area have a point in common. Exact.
bool triangles_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles that have an area and share their first corner meet anywhere else: the side opposite to it of
/// one of them meets the other triangle. Exact.
bool fans_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles that have an area and share their first two corners lie on one another: their third corners
/// are in one plane and on the same side of the edge. Exact.
bool wings_overlap(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b);

/// Whether a segment goes through a triangle: its ends lie on both sides, off the plane, and it passes within the
/// sides, off all three; never if the triangle has no area. Exact.
bool segment_pierces(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& triangle);

/// Whether the corners are not on one line. Exact.
bool triangle_has_area(const Vec3& a, const Vec3& b, const Vec3& c);

/// Whether two triangles that have an area meet in more than the corners or the side that they share by name; two with
/// the same three names do. Exact.
/// @param t, u  the names of their corners, three different ones each
/// @param at_t, at_u  where these are
bool triangles_meet(const std::array<std::uint32_t, 3>& t, const std::array<Vec3, 3>& at_t,
                    const std::array<std::uint32_t, 3>& u, const std::array<Vec3, 3>& at_u);

}  // namespace tri

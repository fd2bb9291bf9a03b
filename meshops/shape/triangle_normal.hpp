#pragma once

#include <algorithm>

#include "meshops/vec.hpp"

namespace tri {

/// The vector in the direction of `v` of length 1, or zero if `v` is.
inline Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? v / length : Vec3(0, 0, 0);
}

/// Unit normal of a triangle seen counter-clockwise, or zero if it has no area.
inline Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return unit_or_zero((b - a) % (c - a));
}

inline double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * ((b - a) % (c - a)).norm();
}

/// 1 - cos of the angle between two unit normals; a triangle without area has no normal and counts as a fold.
inline double normal_turn(const Vec3& a, const Vec3& b) {
  return a.sqrnorm() == 0 || b.sqrnorm() == 0 ? 2.0 : 1.0 - (a | b);
}

/// 2 tan^2 of half the angle between two unit normals: as 1 - cos where it is small, but a fold costs 2e4.
inline double bending(const Vec3& a, const Vec3& b) {
  const double turn = normal_turn(a, b);
  return 2 * turn / std::max(2 - turn, 2e-4);
}

}  // namespace tri

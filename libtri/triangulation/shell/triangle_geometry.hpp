#pragma once

#include <cmath>

#include "meshops/vec.hpp"

namespace tri {

/// Radians; faces of the model that meet at a larger angle meet in a sharp edge.
inline constexpr double sharp_angle = 0.5;

/// Unit normal of a triangle; zero if it has no area.
inline Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a) % (c - a);
  const double length = n.norm();
  return length > 0 ? Vec3(n / length) : Vec3(0, 0, 0);
}

}  // namespace tri

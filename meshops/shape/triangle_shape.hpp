#pragma once

#include <numbers>

#include "meshops/vec.hpp"

namespace tri {

/// How round a triangle is, from 0 (no area) to 1 (equilateral): its area by that of an equilateral triangle with the
/// same sum of squared sides.
inline double roundness(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double squares = (b - a).sqrnorm() + (c - b).sqrnorm() + (a - c).sqrnorm();
  return squares > 0 ? 2 * std::numbers::sqrt3 * ((b - a) % (c - a)).norm() / squares : 0;
}

/// Whether the angle between two vectors is at most a quarter turn and its cosine not below the given one. A vector
/// without length agrees with every other.
/// @param cosine  from 0 to 1
inline bool directions_agree(const Vec3& a, const Vec3& b, double cosine) {
  const double dot = a | b;
  return dot >= 0 && dot * dot >= cosine * cosine * a.sqrnorm() * b.sqrnorm();
}

}  // namespace tri

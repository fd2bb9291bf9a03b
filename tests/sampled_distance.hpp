#pragma once

#include <algorithm>
#include <cmath>

#include "meshops/soup.hpp"

namespace tri::test {

inline double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double length = (b - a).sqrnorm();
  const double share = length > 0 ? std::clamp(((p - a) | (b - a)) / length, 0.0, 1.0) : 0;
  return (a + (b - a) * share - p).norm();
}

inline double to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a) % (c - a);
  const bool above = (n | ((b - a) % (p - a))) >= 0 && (n | ((c - b) % (p - b))) >= 0 && (n | ((a - c) % (p - c))) >= 0;
  if (n.norm() > 0 && above) return std::abs((p - a) | n) / n.norm();
  return std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
}

/// The greatest distance of samples of one surface, corners among them, from every triangle of another.
inline double farthest(const Soup& from, const Soup& to) {
  constexpr int parts = 5;
  double most = 0;
  for (const Triangle& t : from.triangles)
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j) {
        const Vec3 p = (from.points[t[0]] * i + from.points[t[1]] * j + from.points[t[2]] * (parts - i - j)) / parts;
        double least = 1e300;
        for (const Triangle& u : to.triangles)
          least = std::min(least, to_triangle(p, to.points[u[0]], to.points[u[1]], to.points[u[2]]));
        most = std::max(most, least);
      }
  return most;
}

}  // namespace tri::test

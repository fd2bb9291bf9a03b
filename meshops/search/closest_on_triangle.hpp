#pragma once

#include <algorithm>
#include <array>

#include "meshops/vec.hpp"

namespace tri {

/// The point of the segment from `a` to `b` that is nearest to `x`; `a` if the two are equal.
inline Vec3 closest_on_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 ab = b - a;
  const double length2 = ab | ab;
  return length2 > 0 ? a + ab * std::clamp(((x - a) | ab) / length2, 0.0, 1.0) : a;
}

/// The point of triangle `t` that is nearest to `x` [Ericson, Real-Time Collision Detection (2005), 5.1.5].
/// Any triangle will do, degenerate ones too.
inline Vec3 closest_on_triangle(const std::array<Vec3, 3>& t, const Vec3& x) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = x - t[0];
  const double d1 = ab | ap, d2 = ac | ap;
  if (d1 <= 0 && d2 <= 0) return t[0];
  const Vec3 bp = x - t[1];
  const double d3 = ab | bp, d4 = ac | bp;
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t[0] + ab * (d1 > d3 ? d1 / (d1 - d3) : 0);
  const Vec3 cp = x - t[2];
  const double d5 = ab | cp, d6 = ac | cp;
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t[0] + ac * (d2 > d6 ? d2 / (d2 - d6) : 0);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double along = d4 - d3, sum = along + (d5 - d6);
    return t[1] + (t[2] - t[1]) * (sum > 0 ? along / sum : 0);
  }
  const double sum = va + vb + vc;
  Vec3 best = t[0] + ab * (vb / sum) + ac * (vc / sum);
  // In a sliver the barycentric coordinates are mostly rounding; its sides are not.
  if (!(sum > 1e-6 * ab.sqrnorm() * ac.sqrnorm())) {
    if (!(sum > 0)) best = t[0];
    for (int k = 0; k < 3; ++k) {
      const Vec3 on_side = closest_on_segment(t[k], t[(k + 1) % 3], x);
      if ((on_side - x).sqrnorm() < (best - x).sqrnorm()) best = on_side;
    }
  }
  return best;
}

}  // namespace tri

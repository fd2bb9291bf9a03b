#pragma once

#include <cmath>
#include <utility>

#include "meshops/vec.hpp"

namespace tri {

/// A weighted sum of squared distances to planes, as a function of a place [Garland & Heckbert 1997, "Surface
/// simplification using quadric error metrics"]: x A x + 2 b x + c.
///
/// Places are relative to an origin that whoever holds the quadric keeps, best nearby: what is subtracted in `value` is
/// then small, wherever the mesh lies and however small it is.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  ///< A
  Vec3 b{0, 0, 0};
  double c = 0;
  double area = 0;  ///< weight of what is surface; that of added planes does not count

  /// Adds a plane through the origin.
  /// @param normal of any length whose square is the weight
  void add_plane(const Vec3& normal) {
    xx += normal[0] * normal[0];
    xy += normal[0] * normal[1];
    xz += normal[0] * normal[2];
    yy += normal[1] * normal[1];
    yz += normal[1] * normal[2];
    zz += normal[2] * normal[2];
  }

  Vec3 times(const Vec3& x) const {
    return {xx * x[0] + xy * x[1] + xz * x[2], xy * x[0] + yy * x[1] + yz * x[2], xz * x[0] + yz * x[1] + zz * x[2]};
  }
  double value(const Vec3& x) const { return ((times(x) + 2.0 * b) | x) + c; }

  /// Adds one whose origin lies at `-t` from that of this one.
  void add_from(const Quadric& q, const Vec3& t) {
    const Vec3 at = q.times(t);
    c += q.c + ((at + 2.0 * q.b) | t);
    b += q.b + at;
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    area += q.area;
  }

  /// Moves the origin by `t`.
  void move_origin(const Vec3& t) {
    const Vec3 at = times(t);
    c += (at + 2.0 * b) | t;
    b += at;
  }

  /// A place of least value. Where the planes leave a direction open (flat, or straight along a crease; a pivot below
  /// `flat` of the largest), it does not move from the origin that way: elimination with diagonal pivots.
  Vec3 least(double flat = 1e-3) const {
    double a[3][3] = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
    double r[3] = {-b[0], -b[1], -b[2]};
    int at[3] = {0, 1, 2};
    double greatest = 0;
    int rank = 0;
    for (; rank < 3; ++rank) {
      int best = rank;
      for (int k = rank + 1; k < 3; ++k)
        if (a[at[k]][at[k]] > a[at[best]][at[best]]) best = k;
      std::swap(at[rank], at[best]);
      const int p = at[rank];
      if (rank == 0) greatest = a[p][p];
      if (!(a[p][p] > flat * greatest)) break;
      for (int k = rank + 1; k < 3; ++k) {
        const double f = a[at[k]][p] / a[p][p];
        for (int l = rank + 1; l < 3; ++l) a[at[k]][at[l]] -= f * a[p][at[l]];
        r[at[k]] -= f * r[p];
      }
    }
    Vec3 x(0, 0, 0);
    for (int i = rank - 1; i >= 0; --i) {
      const int p = at[i];
      double sum = r[p];
      for (int k = i + 1; k < rank; ++k) sum -= a[p][at[k]] * x[at[k]];
      x[p] = sum / a[p][p];
    }
    return x;
  }
};

}  // namespace tri

#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "meshops/vec.hpp"

namespace tri {

/// Sign of the area of (a,b,c): 1 counter-clockwise, -1 clockwise, 0 collinear. Exact for any finite doubles.
int orientation_exact(const Vec2& a, const Vec2& b, const Vec2& c);

/// Sign of the volume of (a,b,c,d): 1 if d lies below the plane of a, b and c, that is on the side from which they run
/// clockwise; -1 above, 0 on it. Decided by a rounding-error bound where that suffices; exact for any finite doubles.
int orientation_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Whether three points lie on one line (or coincide). Exact for any finite doubles.
bool collinear_exact(const Vec3& a, const Vec3& b, const Vec3& c);

/// For (a,b,c) counter-clockwise: 1 if d lies inside their circle, -1 outside, 0 on it. Exact for any finite doubles.
int in_circle_exact(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// Which bits the coordinates of a set use: each is a multiple of 2^lowest and below 2^(top+1).
struct BitRange {
  int lowest = 0;  ///< exponent of the least bit; 0 if every coordinate is zero
  int top = 0;     ///< exponent of the greatest bit; likewise

  /// True if the differences, and the products of four of them, neither overflow nor underflow.
  bool safe() const { return lowest >= -255 && top <= 250; }
};
/// Of finite coordinates; linear time.
BitRange bit_range(std::span<const Vec2> points);

/// Orientation and in-circle tests on one set of points, decided by rounding-error bounds [Shewchuk 1997, stage A]
/// wherever these suffice and by integers of 256 bits or as many as it takes where they do not.
///
/// The bounds hold only without overflow and underflow, which is settled once for the whole set: from its largest
/// coordinate and the lowest bit that any coordinate uses follows whether a product of four differences can leave the
/// range of a double. Immutable, so that threads may share it.
class PlanePredicates {
 public:
  /// @param range the `bit_range` of finite points; the tests may be asked about these points only.
  explicit PlanePredicates(const BitRange& range);

  /// As `orientation_exact`.
  int orientation(const Vec2& a, const Vec2& b, const Vec2& c) const {
    const double left = (a[0] - c[0]) * (b[1] - c[1]);
    const double right = (a[1] - c[1]) * (b[0] - c[0]);
    const double det = left - right;
    const double magnitude = std::fabs(left) + std::fabs(right);
    const double error = orientation_error_ * magnitude;
    if (det > error) return 1;
    if (-det > error) return -1;
    return orientation_close(a, b, c, det, magnitude);
  }

  /// As `in_circle_exact`.
  int in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) const {
    const double ax = a[0] - d[0], ay = a[1] - d[1];
    const double bx = b[0] - d[0], by = b[1] - d[1];
    const double cx = c[0] - d[0], cy = c[1] - d[1];
    const double bxcy = bx * cy, cxby = cx * by;
    const double cxay = cx * ay, axcy = ax * cy;
    const double axby = ax * by, bxay = bx * ay;
    const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double det = a2 * (bxcy - cxby) + b2 * (cxay - axcy) + c2 * (axby - bxay);
    const double magnitude = (std::fabs(bxcy) + std::fabs(cxby)) * a2 + (std::fabs(cxay) + std::fabs(axcy)) * b2 +
                             (std::fabs(axby) + std::fabs(bxay)) * c2;
    const double error = circle_error_ * magnitude;
    if (det > error) return 1;
    if (-det > error) return -1;
    return in_circle_close(a, b, c, d, det, magnitude);
  }

 private:
  int orientation_close(const Vec2& a, const Vec2& b, const Vec2& c, double det, double magnitude) const;
  int in_circle_close(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double det, double magnitude) const;

  // Infinite where the set leaves the safe range: then every test is decided by integers.
  double orientation_error_, circle_error_;
  // Below these magnitudes every operation on multiples of the lowest bit was exact, so `det` has the true sign.
  double orientation_exact_below_ = 0, circle_exact_below_ = 0;
};

}  // namespace tri

#pragma once

#include <vector>

#include "libtri/surfaces/surface.hpp"
#include "meshops/vec.hpp"

namespace tri {

struct CurvePoint2 {
  Vec2 p, d, dd;
};

struct CurvePoint3 {
  Vec3 p, d, dd;
};

/// Upper bounds of |first|, |second| and |third| derivative over a parameter interval, for each coordinate by itself;
/// infinity where no bound is known.
template <class Vec>
struct CurveBounds {
  Vec d, dd, ddd;
};

/// A parametric curve in a face's (u,v). Immutable and free of caches: safe to share between threads.
class Curve2 {
 public:
  virtual ~Curve2() = default;
  virtual Vec2 point(double t) const = 0;
  virtual CurvePoint2 evaluate(double t) const = 0;
  virtual Vec2 third_derivative(double t) const {
    (void)t;
    return Vec2(0, 0);
  }
  /// Proven bounds over [t0,t1], taken from both sides of every break inside.
  virtual CurveBounds<Vec2> bounds(double t0, double t1) const {
    (void)t0, (void)t1;
    const Vec2 unknown(SurfaceBounds::unknown, SurfaceBounds::unknown);
    return {unknown, unknown, unknown};
  }
  /// Breaks strictly inside the curve's own range, ascending.
  virtual std::vector<ParameterBreak> breaks() const { return {}; }
};

/// A parametric curve in space. Immutable and free of caches: safe to share between threads.
class Curve3 {
 public:
  virtual ~Curve3() = default;
  virtual Vec3 point(double t) const = 0;
  virtual CurvePoint3 evaluate(double t) const = 0;
  virtual Vec3 third_derivative(double t) const {
    (void)t;
    return Vec3(0, 0, 0);
  }
  /// Proven bounds over [t0,t1], taken from both sides of every break inside.
  virtual CurveBounds<Vec3> bounds(double t0, double t1) const {
    (void)t0, (void)t1;
    const Vec3 unknown(SurfaceBounds::unknown, SurfaceBounds::unknown, SurfaceBounds::unknown);
    return {unknown, unknown, unknown};
  }
  /// Breaks strictly inside the curve's own range, ascending.
  virtual std::vector<ParameterBreak> breaks() const { return {}; }
  /// 0 where the curve does not close.
  virtual double period() const { return 0; }
};

}  // namespace tri

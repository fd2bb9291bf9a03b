#pragma once

#include <vector>

#include "libtri/surfaces/surface.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A place on a curve in a parameter plane, with its derivatives.
struct CurvePoint2 {
  Vec2 p;   ///< the place
  Vec2 d;   ///< first derivative by the parameter
  Vec2 dd;  ///< second derivative
};

/// A place on a curve in space, with its derivatives.
struct CurvePoint3 {
  Vec3 p;   ///< the place, mm
  Vec3 d;   ///< first derivative by the parameter
  Vec3 dd;  ///< second derivative
};

/// Upper bounds of |first|, |second| and |third| derivative over a parameter interval, for each coordinate by itself;
/// infinity where no bound is known.
template <class Vec>
struct CurveBounds {
  Vec d;    ///< of the first derivative, each coordinate for itself
  Vec dd;   ///< of the second
  Vec ddd;  ///< of the third
};

/// A parametric curve in a face's (u,v). Immutable and free of caches: safe to share between threads.
class Curve2 {
 public:
  virtual ~Curve2() = default;
  /// The place at t.
  virtual Vec2 point(double t) const = 0;
  /// The place and two derivatives at t.
  virtual CurvePoint2 evaluate(double t) const = 0;
  /// The third derivative at t; zero where the kind of curve has none.
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
  /// The place at t, mm.
  virtual Vec3 point(double t) const = 0;
  /// The place and two derivatives at t.
  virtual CurvePoint3 evaluate(double t) const = 0;
  /// The third derivative at t; zero where the kind of curve has none.
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

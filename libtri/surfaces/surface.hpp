#pragma once

#include <limits>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// Position and partial derivatives at one (u,v).
struct SurfacePoint {
  Vec3 p;    ///< position, mm
  Vec3 du;   ///< derivative by u
  Vec3 dv;   ///< by v
  Vec3 duu;  ///< twice by u
  Vec3 duv;  ///< by u and v
  Vec3 dvv;  ///< twice by v
};

/// Upper bounds of the lengths of partial derivatives over a parameter rectangle; infinity where no bound is known.
struct SurfaceBounds {
  static constexpr double unknown = std::numeric_limits<double>::infinity();  ///< no bound is known
  double du = unknown;                                                        ///< of the derivative by u
  double dv = unknown;                                                        ///< by v
  double duu = unknown;                                                       ///< twice by u
  double duv = unknown;                                                       ///< by u and v
  double dvv = unknown;                                                       ///< twice by v
  double duuu = unknown;                                                      ///< three times by u
  double duuv = unknown;                                                      ///< twice by u and once by v
  double duvv = unknown;                                                      ///< once by u and twice by v
  double dvvv = unknown;                                                      ///< three times by v
};

/// A parameter at which a curve or surface is less than infinitely smooth.
struct ParameterBreak {
  double at = 0;       ///< the parameter
  int continuity = 0;  ///< derivatives that still agree from both sides: 0 is a kink, 1 a jump of curvature
};

/// A parametric surface evaluated from flat arrays. Immutable and free of caches: safe to share between threads.
class Surface {
 public:
  virtual ~Surface() = default;
  /// The position at (u,v), mm.
  virtual Vec3 point(double u, double v) const = 0;
  /// The position and its derivatives at (u,v).
  virtual SurfacePoint evaluate(double u, double v) const = 0;
  /// Period in u; 0 where the direction does not close.
  virtual double u_period() const { return 0; }
  /// The same in v.
  virtual double v_period() const { return 0; }

  /// Proven bounds over [u0,u1] x [v0,v1], taken from both sides of every break inside.
  virtual SurfaceBounds bounds(double u0, double u1, double v0, double v1) const {
    (void)u0, (void)u1, (void)v0, (void)v1;
    return {};
  }
  /// Breaks in u strictly inside the surface's own range, ascending.
  virtual std::vector<ParameterBreak> u_breaks() const { return {}; }
  /// The same in v.
  virtual std::vector<ParameterBreak> v_breaks() const { return {}; }

  /// Every local minimum of the distance from `p` to the untrimmed surface, where a closed form gives them.
  /// @return the number written to `feet` (0 to 2), or -1 where this surface has no closed form. (u,v) of a periodic
  /// direction lie in [0, period). A pole or apex is no minimum of its own here.
  virtual int closest(const Vec3& p, Vec2 feet[2]) const {
    (void)p, (void)feet;
    return -1;
  }
};

}  // namespace tri

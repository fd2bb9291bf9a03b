#pragma once

#include "meshops/vec.hpp"

namespace tri {

/// Position and partial derivatives at one (u,v).
struct SurfacePoint {
  Vec3 p, du, dv, duu, duv, dvv;
};

/// A parametric surface evaluated from flat arrays. Immutable and free of caches: safe to share between threads.
class Surface {
 public:
  virtual ~Surface() = default;
  virtual Vec3 point(double u, double v) const = 0;
  virtual SurfacePoint evaluate(double u, double v) const = 0;
  /// Period in u or v; 0 where the direction does not close.
  virtual double u_period() const { return 0; }
  virtual double v_period() const { return 0; }
};

}  // namespace tri

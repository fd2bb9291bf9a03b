#pragma once

#include "meshops/vec.hpp"

namespace tri {

struct CurvePoint2 {
  Vec2 p, d, dd;
};

/// A parametric curve in a face's (u,v). Immutable and free of caches: safe to share between threads.
class Curve2 {
 public:
  virtual ~Curve2() = default;
  virtual Vec2 point(double t) const = 0;
  virtual CurvePoint2 evaluate(double t) const = 0;
};

}  // namespace tri

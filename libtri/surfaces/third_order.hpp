#pragma once

#include "libtri/surfaces/surface.hpp"

namespace tri {

/// A surface that gives third derivatives as well, which the second derivatives of its offset need.
class ThirdOrderSurface : public Surface {
 public:
  /// out = duuu, duuv, duvv, dvvv
  virtual void third_derivatives(double u, double v, Vec3 out[4]) const = 0;
};

}  // namespace tri

#pragma once

#include "meshops/vec.hpp"

namespace tri {

/// The float nearest to a number, as a double; infinite beyond the floats.
inline double rounded_to_float(double x) {
  // Out of the compiler's sight: GCC 12 at -O3 takes two such conversions beside each other, there and back, for none.
  const volatile float nearest = static_cast<float>(x);
  return nearest;
}

/// The same for each coordinate: what a format that holds floats keeps of a point.
inline Vec3 rounded_to_floats(const Vec3& p) {
  return {rounded_to_float(p[0]), rounded_to_float(p[1]), rounded_to_float(p[2])};
}

}  // namespace tri

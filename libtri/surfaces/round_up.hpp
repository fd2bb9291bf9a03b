#pragma once

#include <cmath>
#include <limits>

namespace tri {

/// A float above `x`: bounds are kept in single precision and must stay bounds.
inline float round_up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace tri

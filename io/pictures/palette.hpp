#pragma once

#include <cstdint>

#include "meshops/vec.hpp"

namespace tri {

/// Colours as linear mixes of sRGB values in [0,1]; every function is defined for every argument.

/// A colour for a category; neighbouring numbers get colours that are easy to tell apart. Repeats after a few hundred.
Vec3 category_color(std::int64_t category);

/// Blue at -1, near white at 0, red at 1; the end colours beyond.
Vec3 diverging_color(double t);

/// Dark violet at 0 through green to yellow at 1; the end colours beyond.
Vec3 sequential_color(double t);

/// How deviations are coloured: by `diverging_color` from blue at `low` through near white at 0 (at the middle, if 0 is
/// not between) to red at `high`.
struct DeviationScale {
  double low = -1;  ///< the value that is blue
  double high = 1;  ///< the value that is red; above `low`
  /// The ends are a tolerance: what is beyond has a colour of its own, cyan below, magenta above.
  bool tolerance = false;
};
/// RGB in [0,1] of a value; that of `missing_color` for NaN.
Vec3 deviation_color(double value, const DeviationScale& scale);

/// For what has no value.
inline Vec3 missing_color() {
  return {0.62, 0.62, 0.62};
}

}  // namespace tri

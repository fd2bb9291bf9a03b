#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "meshops/vec.hpp"

namespace tri {

/// The index of nothing, where 0 up to 4,294,967,294 are indices.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

inline constexpr double infinity = std::numeric_limits<double>::infinity();

inline bool is_finite(const Vec3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

}  // namespace tri

#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "meshops/soup.hpp"

namespace tri::io_detail {

/// The soup has the face scalars "red", "green" and "blue", by which triangles have colours.
inline bool has_face_colors(const Soup& soup) {
  return soup.face_scalars.contains("red") && soup.face_scalars.contains("green") && soup.face_scalars.contains("blue");
}

/// The colour of a triangle. @return false if it has none: a value that is no integer from 0 to 255 (NaN stands for
/// none)
inline bool face_color(const Soup& soup, std::size_t triangle, std::array<std::uint8_t, 3>& color) {
  static constexpr const char* names[] = {"red", "green", "blue"};
  for (std::size_t k = 0; k < 3; ++k) {
    const double value = soup.face_scalars.at(names[k])[triangle];
    if (!(value >= 0 && value <= 255) || value != std::floor(value)) return false;
    color[k] = static_cast<std::uint8_t>(value);
  }
  return true;
}

}  // namespace tri::io_detail

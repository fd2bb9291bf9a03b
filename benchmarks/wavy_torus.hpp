#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "meshops/soup.hpp"

namespace tri {

/// A torus of n x m vertices, 2 n m triangles, whose tube swells 20 times around.
/// @param ripple  height of finer waves, too fine to be kept everywhere
inline Soup wavy_torus(std::uint32_t n, std::uint32_t m, double ripple = 0) {
  Soup s;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t k = 0; k < m; ++k) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * k / m;
      const double r = 10 + std::sin(20 * a) + ripple * std::sin(31 * b + 17 * a);
      s.points.emplace_back((30 + r * std::cos(b)) * std::cos(a), (30 + r * std::cos(b)) * std::sin(a),
                            r * std::sin(b));
    }
  }
  const auto at = [=](std::uint32_t i, std::uint32_t k) { return i % n * m + k % m; };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t k = 0; k < m; ++k) {
      s.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      s.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return s;
}

}  // namespace tri

#pragma once

#include <cstdint>

namespace tri {

/// Spreads the lowest ten bits of `x` to every third bit: of three numbers a place on Morton's space-filling curve.
inline std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

}  // namespace tri

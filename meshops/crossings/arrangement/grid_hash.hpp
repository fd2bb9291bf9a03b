#pragma once

#include <cstddef>

#include "meshops/crossings/arrangement/grid_geometry.hpp"

namespace tri {

/// For hash tables by place on the grid.
struct GridHash {
  std::size_t operator()(const GridPoint& p) const {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const std::int64_t x : p) h = (h ^ static_cast<std::uint64_t>(x)) * 0xff51afd7ed558ccdu, h ^= h >> 29;
    return static_cast<std::size_t>(h);
  }
};

}  // namespace tri

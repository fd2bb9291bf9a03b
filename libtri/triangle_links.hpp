#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meshops/soup.hpp"

namespace tri {

/// Per triangle, the neighbour across the edge opposite corner k; -1 where there is none.
using TriangleNeighbors = std::vector<std::array<std::int32_t, 3>>;

/// Pairs triangles that share an edge and run it in opposite directions. An edge used by more than two triangles, or twice in
/// the same direction, stays unpaired.
TriangleNeighbors link_triangles(const std::vector<Triangle>& triangles, std::size_t vertices);

/// Gives every fan of triangles around a vertex a vertex of its own, so that each vertex has exactly one fan.
/// New vertices are appended; returns for each new vertex the one it was copied from.
std::vector<std::uint32_t> split_fans(std::vector<Triangle>& triangles, const TriangleNeighbors& neighbors, std::size_t vertices);

}  // namespace tri

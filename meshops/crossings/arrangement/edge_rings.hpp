#pragma once

#include <cstdint>
#include <vector>

#include "meshops/crossings/arrangement/crossing_complex.hpp"

namespace tri {

/// The faces around every edge, in angular order.
struct EdgeRings {
  struct Wing {
    std::uint32_t face;
    std::uint8_t side;  ///< from corner `side` to the next
    bool forward;  ///< runs from the lower to the higher vertex; then the front lies counter-clockwise of the face,
                   ///< seen against the edge's direction from lower to higher vertex
  };
  std::vector<Wing> wings;
  std::vector<std::uint32_t> first;  ///< of each edge, and the end: wings [first[e], first[e + 1]), counter-clockwise

  std::size_t edges() const { return first.size() - 1; }
};

/// Exact.
/// @param complex no two faces that share an edge lie upon each other
/// @throws Cancelled
EdgeRings edge_rings(const CrossingComplex& complex, const Context& context);

}  // namespace tri

#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A vertex in the inner part of a boundary edge.
struct TJunction {
  std::uint32_t triangle = 0;  ///< the one at the edge
  std::uint32_t side = 0;      ///< of it, from that corner to the next
  std::uint32_t vertex = 0;    ///< the lowest of those at the place
  double share = 0;            ///< how far along the side, in (0,1)
  /// True if all members are equal, `share` to the bit.
  bool operator==(const TJunction&) const = default;
};

/// All vertices of boundary edges (edges of one triangle) that lie on the inner part of another boundary edge: within
/// `tolerance` of it and farther than that from both ends; with a tolerance of 0 exactly on it. In order of triangle,
/// side and share; of several within the tolerance of each other the first. Triangles without an area have none.
/// O((edges + vertices) log edges).
std::vector<TJunction> find_t_junctions(const Soup& soup, double tolerance, Context& context);

/// A tolerance as a length: the larger of `absolute` and `relative` times the diagonal of the box of all points.
double length_tolerance(const Soup& soup, double absolute, double relative);

}  // namespace tri

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// Points of the plane along the Morton curve, with the alternating cuts between them.
struct SpatialOrder {
  std::vector<std::uint32_t> order;  ///< input index of each distinct point, along the curve
  /// cuts[i] separates order[i-1] from order[i]; the lower the number, the earlier the cut. In any range of points that
  /// shares all earlier cuts, the lowest number occurs once. Even numbers cut by x, odd ones by y: every point
  /// before the cut has a strictly smaller coordinate than every point after it. cuts[0] is unused.
  std::vector<std::uint16_t> cuts;
  /// (duplicate, kept): points equal to an earlier one, by ascending duplicate; they are not in `order`.
  std::vector<std::array<std::uint32_t, 2>> duplicates;
};

/// Sorts points by the interleaved bits of their coordinates, which orders them for alternating cuts [Dwyer 1987]
/// at the cost of a radix sort. Points that share a cell are sorted again within their own box, so the cuts separate
/// any two distinct points, however close.
/// @param points finite
SpatialOrder spatial_order(std::span<const Vec2> points, const Context& context);

}  // namespace tri

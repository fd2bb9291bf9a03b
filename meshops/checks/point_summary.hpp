#pragma once

#include <cstdint>
#include <span>

#include "meshops/vec.hpp"

namespace tri {

/// What a person wants to know about points before using them. Lengths are in the points' own unit.
struct PointSummary {
  std::uint64_t points = 0;      ///< all of them
  std::uint64_t duplicates = 0;  ///< points at exactly the place of an earlier one
  Vec3 box_min{0, 0, 0};         ///< least coordinates
  Vec3 box_max{0, 0, 0};         ///< greatest ones
  /// Distance to the nearest other place, over at most 20,000 points evenly chosen: the 5% quantile. On scan lines that
  /// is the spacing along the lines. 0 with fewer than two places.
  double spacing_5 = 0;
  double spacing_median = 0;  ///< the median of the same
  double spacing_95 = 0;      ///< its 95% quantile
};

/// @param points finite coordinates. O(N log N) time; the result does not depend on the number of threads.
PointSummary summarize(std::span<const Vec3> points);

}  // namespace tri

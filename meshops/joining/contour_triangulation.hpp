#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// Which of two contours takes the next step. From the diagonal (i, j), `first` makes the triangle of first[i], first[i
/// + 1] and second[j]; `second` that of second[j], second[j + 1] and first[i].
enum class ContourStep : char { first, second };

/// Joins two contours by a strip of triangles [Ganapathy & Dennehy 1982]: from the diagonal (0, 0) the contour advances
/// whose normalised arc length then stays closer to the other's.
///
/// Over a long ragged contour arc lengths drift apart. So the contours are first cut where two vertices are mutually
/// nearest (along a walk that always takes the shorter diagonal), and the rule is applied between the cuts. Where a
/// step is not allowed the other is taken; where neither is, the whole strip falls back on the shorter allowed
/// diagonal. Linear time.
///
/// @param first, second  positions, both running the same way in space; at least one each and three together. Of closed
/// contours the first
///   position is repeated at the end.
/// @param allowed  `(i, j, step)`: whether the triangle of that step may be made; empty allows every one.
/// @return first.size() + second.size() - 2 steps, or nothing if it gets stuck.
std::optional<std::vector<ContourStep>> triangulate_contours(std::span<const Vec3> first, std::span<const Vec3> second,
                                                             const std::function<bool(int, int, ContourStep)>& allowed);

}  // namespace tri

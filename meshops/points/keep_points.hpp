#pragma once

#include <span>

#include "meshops/points/point_set.hpp"
#include "meshops/report.hpp"

namespace tri {

/// The end of every operator that takes points away: keeps those with these indices and writes into the report how many
/// went and where each of the others is now (`maps.vertices`). Without a change neither set nor report is touched.
/// @param kept  0-based, strictly ascending
void keep_and_report(PointSet& set, std::span<const std::uint32_t> kept, Report& report);

/// Original index of every point that is left after such an operator. @param before  number of points before it
std::vector<std::uint32_t> kept_points(const Report& report, std::size_t before);

}  // namespace tri

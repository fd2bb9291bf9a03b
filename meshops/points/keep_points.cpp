#include "meshops/points/keep_points.hpp"

#include <numeric>

namespace tri {

void keep_and_report(PointSet& set, std::span<const std::uint32_t> kept, Report& report) {
  const std::size_t before = set.size();
  if (kept.size() == before) return;
  std::vector<std::uint32_t> map(before, ElementMaps::removed);
  for (std::size_t k = 0; k < kept.size(); ++k) map[kept[k]] = static_cast<std::uint32_t>(k);
  keep(set, kept);
  report.vertices_removed = before - kept.size();
  report.maps.vertices = std::move(map);
}

std::vector<std::uint32_t> kept_points(const Report& report, std::size_t before) {
  std::vector<std::uint32_t> kept;
  if (report.maps.vertices.empty()) {
    kept.resize(before);
    std::iota(kept.begin(), kept.end(), 0);
    return kept;
  }
  for (std::size_t i = 0; i < report.maps.vertices.size(); ++i)
    if (report.maps.vertices[i] != ElementMaps::removed) kept.push_back(static_cast<std::uint32_t>(i));
  return kept;
}

}  // namespace tri

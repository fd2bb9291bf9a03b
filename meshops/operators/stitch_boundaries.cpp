#include "meshops/operators/stitch_boundaries.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "meshops/joining/joined_points.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/nearest_points.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr JoinRules rules{.join_crowds = false, .opposite_only = true};

std::vector<std::uint32_t> own_clusters(std::size_t points) {
  std::vector<std::uint32_t> cluster(points);
  for (std::uint32_t i = 0; i < points; ++i) cluster[i] = i;
  return cluster;
}

/// Clusters of loose points at the same place.
std::vector<std::uint32_t> coincident(const Soup& soup, Context& context) {
  const std::vector<char> loose = points_on_loose_edges(soup, context);
  std::vector<std::uint32_t> source;
  std::vector<Vec3> places;
  for (std::uint32_t i = 0; i < loose.size(); ++i) {
    if (!loose[i]) continue;
    source.push_back(i);
    places.push_back(soup.points[i]);
  }
  std::vector<std::uint32_t> cluster = own_clusters(soup.points.size());
  const std::vector<std::uint32_t> first = points_at_same_place(places, &context);
  for (std::size_t i = 0; i < first.size(); ++i) cluster[source[i]] = source[first[i]];
  return cluster;
}

/// Clusters of two loose points each that are mutually nearest.
std::vector<std::uint32_t> mutually_nearest(const Soup& soup, double tolerance, Context& context) {
  constexpr std::size_t looked_at = 8;
  const std::vector<char> loose = points_on_loose_edges(soup, context);
  std::vector<std::vector<std::uint32_t>> neighbors(soup.points.size());
  Pace pace(context);
  for (const Triangle& t : soup.triangles) {
    pace();
    for (int k = 0; k < 3; ++k)
      if (loose[t[k]])
        for (int m = 1; m < 3; ++m) neighbors[t[k]].push_back(t[(k + m) % 3]);
  }
  std::vector<std::uint32_t> source;
  std::vector<Vec3> places;
  for (std::uint32_t i = 0; i < loose.size(); ++i) {
    if (!loose[i]) continue;
    source.push_back(i);
    places.push_back(soup.points[i]);
  }
  const NearestPoints tree(places, &context);
  std::vector<std::uint32_t> nearest(places.size(), no_index);
  std::vector<NearestPoints::Neighbor> near;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    if (i % 4096 == 0) context.checkpoint();
    tree.nearest(places[i], looked_at, near);
    for (const auto& n : near) {
      if (n.squared_distance > tolerance * tolerance) break;
      const auto& beside = neighbors[source[i]];
      if (n.index == i || std::ranges::find(beside, source[n.index]) != beside.end()) continue;
      nearest[i] = n.index;
      break;
    }
  }
  std::vector<std::uint32_t> cluster = own_clusters(soup.points.size());
  for (std::uint32_t i = 0; i < nearest.size(); ++i)
    if (nearest[i] != no_index && nearest[nearest[i]] == i && i < nearest[i]) cluster[source[nearest[i]]] = source[i];
  return cluster;
}

bool joins_nothing(const JoinedPoints& joined) {
  for (std::size_t i = 0; i < joined.first.size(); ++i)
    if (joined.first[i] != i) return false;
  return true;
}

/// Both points of each pair at the middle between them.
std::vector<Vec3> at_middle(const Soup& soup, const JoinedPoints& joined) {
  std::vector<Vec3> moved = soup.points;
  for (std::size_t i = 0; i < moved.size(); ++i)
    if (const std::uint32_t first = joined.first[i]; first != i)
      moved[i] = moved[first] = (soup.points[first] + soup.points[i]) / 2;
  return moved;
}

/// Sets position and attributes of the first of each pair to the middle.
void meet(Soup& soup, const JoinedPoints& joined, Report& report) {
  for (std::uint32_t i = 0; i < joined.first.size(); ++i) {
    const std::uint32_t first = joined.first[i];
    if (first == i || soup.points[first] == soup.points[i]) continue;
    move_point_between(soup, first, i, 0.5);
    ++report.vertices_moved;
  }
}

}  // namespace

const OptionSchema& StitchBoundariesOptions::schema() {
  using O = StitchBoundariesOptions;
  static const OptionSchema schema = Schema<O>().number(
      "tolerance", &O::tolerance,
      {.unit = "mm", .min = 0, .help = "widest gap that is closed; 0: only boundary edges that coincide"});
  return schema;
}

Report stitch_boundaries(Soup& soup, const StitchBoundariesOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("stitch-boundaries", 0);
  check_soup(soup, &context);
  Report report;
  report.operation = "stitch-boundaries";
  const std::size_t points_before = soup.points.size();
  JoinedPoints joined = join_points(soup, coincident(soup, context), rules, context);
  const auto figure = [&](const char* name, std::uint64_t count) {
    if (count > 0) report.figures[name] += static_cast<double>(count);
  };
  const auto skipped = [&](const char* name, std::uint64_t count) {
    if (count > 0) report.skipped[name] += count;
  };
  figure("edges joined", joined.edges_joined);
  skipped("edges that would be crowded, or run the same way", joined.edges_refused);
  if (options.tolerance == 0) {
    if (!joins_nothing(joined)) {
      Soup work = soup;
      apply_join(work, joined.first, &context);
      soup = std::move(work);
    }
    report.vertices_removed = points_before - soup.points.size();
    context.progress("stitch-boundaries", 1);
    return report;
  }

  Soup work = soup;
  if (!joins_nothing(joined)) apply_join(work, joined.first, &context);
  context.progress("stitch-boundaries", 0.5);
  while (true) {
    context.checkpoint();
    std::vector<std::uint32_t> cluster = mutually_nearest(work, options.tolerance, context);
    joined = join_points(work, cluster, rules, context);
    const std::uint64_t turned = keep_from_turning_over(work, cluster, rules, context, joined,
                                                        [&](const JoinedPoints& j) { return at_middle(work, j); });
    if (joins_nothing(joined)) {
      skipped("triangle would turn over", turned);
      skipped("edges that would be crowded, or run the same way", joined.edges_refused);
      break;
    }
    figure("edges joined across a gap", joined.edges_joined);
    meet(work, joined, report);
    apply_join(work, joined.first, &context);
  }
  report.vertices_removed = points_before - work.points.size();
  if (report.vertices_removed > 0) soup = std::move(work);
  context.progress("stitch-boundaries", 1);
  return report;
}

}  // namespace tri

#include "meshops/repair.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>

#include "meshops/checks/mesh_distance.hpp"
#include "meshops/crossings/solid_check.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/make_solid.hpp"
#include "meshops/operators/orient.hpp"
#include "meshops/operators/remove_degenerate.hpp"
#include "meshops/operators/remove_duplicates.hpp"
#include "meshops/operators/remove_self_intersections.hpp"
#include "meshops/operators/resolve_t_junctions.hpp"
#include "meshops/operators/split_non_manifold.hpp"
#include "meshops/operators/stitch_boundaries.hpp"
#include "meshops/operators/weld.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/single_precision.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr double most_boundary = 4;      ///< of a solid: squared length of the loops over the area
constexpr double stitched_share = 0.02;  ///< of the deviation that is allowed: widest gap that is stitched

double diagonal(const Soup& soup) {
  Vec3 low = Vec3(1, 1, 1) * std::numeric_limits<double>::infinity(), high = -low;
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) low.minimize(soup.points[v]), high.maximize(soup.points[v]);
  return soup.triangles.empty() ? 0 : (high - low).norm();
}

bool rounds_to_floats(const Soup& soup) {
  return std::ranges::any_of(soup.points, [](const Vec3& p) { return p != rounded_to_floats(p); });
}

/// The squared lengths of the connected boundaries, over the area.
double boundary_share(const Soup& soup) {
  std::map<std::array<std::uint32_t, 2>, int> sides;
  double area = 0;
  for (const Triangle& t : soup.triangles) {
    area += area_vector(soup, t).norm() / 2;
    for (std::size_t k = 0; k < 3; ++k) ++sides[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  }
  DisjointSets loops(soup.points.size());
  for (const auto& [side, count] : sides)
    if (count == 1) loops.join(side[0], side[1]);
  std::map<std::size_t, double> length;
  for (const auto& [side, count] : sides)
    if (count == 1) length[loops.find(side[0])] += (soup.points[side[0]] - soup.points[side[1]]).norm();
  double sum = 0;
  for (const auto& [loop, l] : length) sum += l * l;
  return area > 0 ? sum / area : 0;
}

std::vector<RepairPlace> places_of(const Soup& soup, const Report& report) {
  std::vector<RepairPlace> places;
  for (const std::uint32_t t : report.touched_faces) {
    if (places.size() == RepairResult::most_places || t >= soup.triangles.size()) break;
    const Triangle& v = soup.triangles[t];
    places.push_back({true, t, (soup.points[v[0]] + soup.points[v[1]] + soup.points[v[2]]) / 3.0});
  }
  for (const std::uint32_t v : report.touched_vertices) {
    if (places.size() == RepairResult::most_places || v >= soup.points.size()) break;
    places.push_back({false, v, soup.points[v]});
  }
  return places;
}

std::optional<RepairDeviation> deviation_of(const Soup& before, const Soup& after, Context& context) {
  if (before.triangles.empty() || after.triangles.empty()) return std::nullopt;
  const MeshDistance d = mesh_distance(before, after, {.samples = 1000, .relative_error = 0.05, .max_searches = 50'000}, context);
  return RepairDeviation{d.forward.max, d.forward.place, d.backward.max, d.backward.place};
}

}  // namespace

RepairResult repair(Soup& soup, const RepairOptions& options, Context& context) {
  if (!(options.max_deviation >= 0 && options.max_deviation <= 0.1))
    throw InvalidInput("max-deviation is a share of the diagonal: between 0 and 0.1");
  check_soup(soup);
  RepairResult result;
  if (options.goal != RepairGoal::surface && is_clean_solid(soup, options.single_precision, context) &&
      !(options.single_precision && rounds_to_floats(soup)))
    return result;
  Soup work = soup;
  const double size = diagonal(work);
  const auto step = [&](auto operation, const auto& with) {
    const auto start = std::chrono::steady_clock::now();
    Report report = operation(work, with, context);
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.changed |= !report.unchanged();
    result.places.push_back(places_of(work, report));
    result.steps.push_back(std::move(report));
  };
  step(weld, WeldOptions{});
  // Sheets drawn from both sides are for `make_solid` to judge, which sees what lies around them.
  step(remove_duplicates, RemoveDuplicatesOptions{.opposite = options.goal == RepairGoal::solid ? OppositePairs::keep
                                                                                             : OppositePairs::automatic});
  step(resolve_t_junctions, ResolveTJunctionsOptions{});
  step(stitch_boundaries, StitchBoundariesOptions{.tolerance = stitched_share * options.max_deviation * size});
  result.goal = options.goal;
  if (result.goal == RepairGoal::automatic)
    result.goal = boundary_share(work) < most_boundary ? RepairGoal::solid : RepairGoal::surface;
  if (result.goal == RepairGoal::solid) {
    step(make_solid, MakeSolidOptions{.max_deviation = options.max_deviation, .single_precision = options.single_precision});
    for (const auto& [reason, count] : result.steps.back().skipped) result.left += count;
  } else {
    step(remove_degenerate, RemoveDegenerateOptions{.max_deviation = options.max_deviation * size});
    step(remove_self_intersections, RemoveSelfIntersectionsOptions{.max_deviation = options.max_deviation});
    for (const auto& [reason, count] : result.steps.back().skipped) result.left += count;
    step(orient, OrientOptions{});
    step(split_non_manifold, SplitNonManifoldOptions{});
  }
  if (!result.changed) return result;
  result.deviation = deviation_of(soup, work, context);
  if (result.deviation && result.deviation->lost > options.max_deviation * size * (1 + 1e-9)) ++result.left;
  soup = std::move(work);
  return result;
}

}  // namespace tri

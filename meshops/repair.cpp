#include "meshops/repair.hpp"

#include <chrono>
#include <limits>
#include <map>

#include "meshops/disjoint_sets.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/make_solid.hpp"
#include "meshops/operators/orient.hpp"
#include "meshops/operators/remove_degenerate.hpp"
#include "meshops/operators/remove_duplicates.hpp"
#include "meshops/operators/resolve_t_junctions.hpp"
#include "meshops/operators/split_non_manifold.hpp"
#include "meshops/operators/stitch_boundaries.hpp"
#include "meshops/operators/weld.hpp"
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

}  // namespace

RepairResult repair(Soup& soup, const RepairOptions& options, Context& context) {
  if (!(options.max_deviation >= 0 && options.max_deviation <= 0.1))
    throw InvalidInput("max-deviation is a share of the diagonal: between 0 and 0.1");
  check_soup(soup);
  RepairResult result;
  Soup work = soup;
  const double size = diagonal(work);
  const auto step = [&](auto operation, const auto& with) {
    const auto start = std::chrono::steady_clock::now();
    Report report = operation(work, with, context);
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.changed |= !report.unchanged();
    result.steps.push_back(std::move(report));
  };
  step(weld, WeldOptions{});
  step(remove_duplicates, RemoveDuplicatesOptions{});
  step(resolve_t_junctions, ResolveTJunctionsOptions{});
  step(stitch_boundaries, StitchBoundariesOptions{.tolerance = stitched_share * options.max_deviation * size});
  result.goal = options.goal;
  if (result.goal == RepairGoal::automatic)
    result.goal = boundary_share(work) < most_boundary ? RepairGoal::solid : RepairGoal::surface;
  if (result.goal == RepairGoal::solid) {
    step(make_solid, MakeSolidOptions{.max_deviation = options.max_deviation});
    for (const auto& [reason, count] : result.steps.back().skipped) result.left += count;
  } else {
    step(remove_degenerate, RemoveDegenerateOptions{.max_deviation = options.max_deviation * size});
    step(orient, OrientOptions{});
    step(split_non_manifold, SplitNonManifoldOptions{});
  }
  if (result.changed) soup = std::move(work);
  return result;
}

}  // namespace tri

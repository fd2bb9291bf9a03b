#include "meshops/repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "meshops/checks/mesh_distance.hpp"
#include "meshops/checks/surface_reach.hpp"
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
#include "meshops/pace.hpp"
#include "meshops/search/cancellable_sort.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/single_precision.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr double most_boundary = 4;      ///< of a solid: squared length of the loops over the area
constexpr double stitched_share = 0.02;  ///< of the deviation that is allowed: widest gap that is stitched
constexpr const char* undone_name = "beyond max-deviation, undone";
constexpr double left_for_later = 0.45;  ///< of it: for each of two steps that follow

bool rounds_to_floats(const Soup& soup) {
  return std::ranges::any_of(soup.points, [](const Vec3& p) { return p != rounded_to_floats(p); });
}

/// The squared lengths of the connected boundaries, over the area.
double boundary_share(const Soup& soup, const Context& context) {
  Pace pace(context);
  using Side = std::pair<std::uint32_t, std::uint32_t>;  // the lower vertex first
  struct Found {
    Side side;
    std::size_t number;
  };
  std::vector<Found> sides;
  double area = 0;
  for (const Triangle& t : soup.triangles) {
    pace();
    area += area_vector(soup, t).norm() / 2;
    for (std::size_t k = 0; k < 3; ++k) sides.push_back({std::minmax(t[k], t[(k + 1) % 3]), sides.size()});
  }
  cancellable_sort(sides.begin(), sides.end(), &context, [](const Found& a, const Found& b) {
    return a.side != b.side ? a.side < b.side : a.number < b.number;
  });
  const auto for_open_sides = [&](const auto& visit) {
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      pace();
      while (end < sides.size() && sides[end].side == sides[i].side) ++end;
      if (end - i == 1) visit(sides[i].side);
    }
  };
  DisjointSets loops(soup.points.size());
  for_open_sides([&](const Side& side) { loops.join(side.first, side.second); });
  std::map<std::size_t, double> length;
  for_open_sides([&](const Side& side) {
    length[loops.find(side.first)] += (soup.points[side.first] - soup.points[side.second]).norm();
  });
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
  const MeshDistance d =
      mesh_distance(before, after, {.samples = 1000, .relative_error = 0.05, .max_searches = 50'000}, context);
  return RepairDeviation{d.forward.max, d.forward.place, d.backward.max, d.backward.place};
}

/// The steps on one soup.
class Repairer {
 public:
  /// @param watched  every step that may move the surface is undone where it does by more than it may
  Repairer(const Soup& given, const RepairOptions& options, bool watched, Context& context)
      : given_(given), options_(options), watched_(watched), context_(context), work_(given),
        size_(soup_diagonal(given)) {}

  void run() {
    const double farthest = options_.max_deviation * size_;
    step(weld, WeldOptions{}, stays);
    // Sheets drawn from both sides are for `make_solid` to judge, which sees what lies around them.
    step(remove_duplicates,
         RemoveDuplicatesOptions{.opposite = options_.goal == RepairGoal::solid ? OppositePairs::keep
                                                                                : OppositePairs::automatic},
         stays);
    ResolveTJunctionsOptions junctions;
    junctions.relative_tolerance = std::min(junctions.relative_tolerance, stitched_share * options_.max_deviation);
    step(resolve_t_junctions, junctions, moves);
    step(stitch_boundaries, StitchBoundariesOptions{.tolerance = stitched_share * farthest}, moves);
    result_.goal = options_.goal;
    if (result_.goal == RepairGoal::automatic)
      result_.goal = boundary_share(work_, context_) < most_boundary ? RepairGoal::solid : RepairGoal::surface;
    if (result_.goal == RepairGoal::solid) {
      const auto solid = [this](Soup& soup, const MakeSolidOptions& with, Context& context) {
        return make_solid_naming_fillings(soup, with, fillings_, context);
      };
      step(solid,
           MakeSolidOptions{.max_deviation = options_.max_deviation, .single_precision = options_.single_precision},
           moves);
    } else {
      step(remove_degenerate, RemoveDegenerateOptions{.max_deviation = left_for_later * farthest}, moves);
      step(remove_self_intersections,
           RemoveSelfIntersectionsOptions{.max_deviation = left_for_later * options_.max_deviation}, moves);
    }
    for (const auto& [reason, count] : result_.steps.back().skipped)
      if (reason != undone_name) result_.left += count;
    if (result_.goal == RepairGoal::solid) return;
    step(orient, OrientOptions{}, stays);
    step(split_non_manifold, SplitNonManifoldOptions{}, stays);
  }

  /// Places of what was given that are too far from what there is now; then the other way round.
  std::array<std::vector<FarPlace>, 2> beyond() const {
    if (given_.triangles.empty()) return {};
    // What rounding does is no movement.
    const double reach = options_.max_deviation * size_ + 0x1p-50 * farthest_coordinate();
    if (work_.triangles.empty()) return {places_of_all(), {}};
    return {places_beyond(given_, {}, work_, reach, context_).places,
            places_beyond(work_, fillings_, given_, reach, context_).places};
  }

  RepairResult& result() { return result_; }
  Soup& soup() { return work_; }

 private:
  static constexpr bool moves = true, stays = false;

  void step(auto operation, const auto& with, bool may_move) {
    const auto start = std::chrono::steady_clock::now();
    const Soup before = watched_ && may_move ? work_ : Soup{};
    const std::vector<std::uint32_t> fillings_before = fillings_;
    Report report = operation(work_, with, context_);
    if (watched_ && may_move && !report.unchanged()) {
      if (const auto [lost, added] = beyond(); !lost.empty() || !added.empty()) {
        work_ = before;
        fillings_ = fillings_before;
        report = undone(report.operation, lost, added);
        ++result_.left;
      }
    }
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result_.changed |= !report.unchanged();
    result_.places.push_back(places_of(work_, report));
    result_.steps.push_back(std::move(report));
  }

  Report undone(const std::string& operation, const std::vector<FarPlace>& lost,
                const std::vector<FarPlace>& added) const {
    constexpr std::size_t named = 10;
    Report report;
    report.operation = operation;
    report.skipped[undone_name] = 1;
    const auto name = [&](const std::vector<FarPlace>& places, const char* of, const char* from) {
      for (std::size_t i = 0; i < std::min(named, places.size()); ++i)
        report.notes.push_back(fmt::format(
            "({:.6g}, {:.6g}, {:.6g}) of {} would have been {:.3g} from {}, {:.3g} are allowed", places[i].at[0],
            places[i].at[1], places[i].at[2], of, places[i].distance, from, options_.max_deviation * size_));
    };
    name(lost, "what was given", "the result");
    name(added, "the result", "what was given");
    return report;
  }

  std::vector<FarPlace> places_of_all() const {
    std::vector<FarPlace> all;
    for (std::uint32_t t = 0; t < given_.triangles.size(); ++t)
      all.push_back({t, given_.points[given_.triangles[t][0]], std::numeric_limits<double>::infinity()});
    return all;
  }

  double farthest_coordinate() const {
    double most = 0;
    for (const Vec3& p : given_.points) most = std::max({most, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
    return most;
  }

  const Soup& given_;
  const RepairOptions& options_;
  const bool watched_;
  Context& context_;
  Soup work_;
  const double size_;
  std::vector<std::uint32_t> fillings_;
  RepairResult result_;
};

}  // namespace

RepairResult repair(Soup& soup, const RepairOptions& options, Context& context) {
  if (!(options.max_deviation >= 0 && options.max_deviation <= 0.1))
    throw InvalidInput("max-deviation is a share of the diagonal: between 0 and 0.1");
  check_soup(soup, &context);
  RepairResult result;
  if (options.goal != RepairGoal::surface && is_clean_solid(soup, options.single_precision, context) &&
      !(options.single_precision && rounds_to_floats(soup)))
    return result;
  Repairer repairer(soup, options, false, context);
  repairer.run();
  if (!repairer.result().changed) return std::move(repairer.result());
  std::optional<RepairDeviation> deviation = deviation_of(soup, repairer.soup(), context);
  const auto finish = [&](Repairer& done) {
    done.result().deviation = std::move(deviation);
    if (done.result().changed) soup = std::move(done.soup());
    return std::move(done.result());
  };
  if (const auto [lost, added] = repairer.beyond(); lost.empty() && added.empty()) return finish(repairer);
  // Once more, with an eye on every step.
  Repairer watched(soup, options, true, context);
  watched.run();
  deviation.reset();
  if (watched.result().changed) deviation = deviation_of(soup, watched.soup(), context);
  return finish(watched);
}

}  // namespace tri

#include "libtri/triangulation/empty_discs.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "meshops/pace.hpp"

namespace tri {
namespace {

constexpr double other_way = 1.9;  // radians: normals farther apart are those of two sides of a wall

}  // namespace

EmptyDiscs::EmptyDiscs(const CadModel& model, std::span<const Foot> feet, std::span<const Foot> probes, double reach,
                       double step, const Context& context)
    : feet_(feet), reach_(reach), farthest_(model.diagonal), few_(probes.size() < feet.size() / 16) {
  std::unordered_set<std::uint64_t> near_probes;
  const auto cell = [&](const Vec3& p, int dx, int dy, int dz) {
    const auto at = [&](int k, int d) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(p[k] / reach)) + d) & 0x1fffff;
    };
    return at(0, dx) << 42 | at(1, dy) << 21 | at(2, dz);
  };
  // Few probes, as on a part that was measured everywhere, need few points; trees over all would cost more than all
  // else.
  if (few_)
    for (const Foot& probe : probes)
      for (int i = 0; i < 27; ++i) near_probes.insert(cell(probe.point, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
  fill_bins([&](const Foot& foot) { return !few_ || near_probes.contains(cell(foot.point, 0, 0, 0)); }, context);
  for (const CadEdge& edge : model.edges)
    if (edge.faces.size() == 1 && !edge.degenerate)
      for (std::size_t k = 0; k + 1 < edge.polyline.size(); ++k) {
        const Vec3 d = edge.polyline[k + 1] - edge.polyline[k];
        const int n = std::clamp(static_cast<int>(std::ceil(d.norm() / step)), 1, 10000);
        for (int i = 0; i <= n; ++i) rim_.push_back(edge.polyline[k] + d * (static_cast<double>(i) / n));
      }
  if (!rim_.empty()) rim_tree_.emplace(rim_);
}

std::vector<EmptyDiscs::End> EmptyDiscs::ends(std::span<const Foot> places, const Context& context) {
  std::vector<End> result(places.size());
  const auto for_all = [&](const auto& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, places.size(), 64), [&](const auto& range) {
      context.checkpoint();
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        if (places[i].face >= 0) visit(i);
    });
  };
  for_all([&](std::size_t i) { result[i] = end(places[i]); });
  const auto undecided = [&](const End& e) { return e.distance > reach_; };
  if (!few_ || std::none_of(result.begin(), result.end(), undecided)) return result;
  few_ = false;
  fill_bins([](const Foot&) { return true; }, context);
  for_all([&](std::size_t i) {
    if (undecided(result[i])) result[i] = end(places[i]);
  });
  return result;
}

EmptyDiscs::End EmptyDiscs::end(const Foot& at) const {
  End nearest{farthest_, at.point, -1};
  if (rim_tree_) {
    thread_local std::vector<NearestPoints::Neighbor> found;
    rim_tree_->nearest(at.point, 1, found);
    const double distance = std::sqrt(found[0].squared_distance);
    if (distance < nearest.distance) nearest = {distance, rim_[found[0].index], -1};
  }
  return nearest_point(at, nearest);
}

void EmptyDiscs::Bin::finish() {
  if (places.empty()) return;
  Vec3 sum(0, 0, 0);
  for (const Normal& n : normals) sum += Vec3(n[0], n[1], n[2]);
  if (sum.norm() > 0) sum /= sum.norm();
  for (int k = 0; k < 3; ++k) middle[k] = static_cast<float>(sum[k]);
  for (const Normal& n : normals) spread = std::max(spread, std::acos(std::clamp(cosine(n, middle), -1.0, 1.0)));
  low = high = places[0];
  for (const Vec3& p : places) low.minimize(p), high.maximize(p);
  tree = std::make_unique<NearestPoints>(places);
}

double EmptyDiscs::Bin::squared_distance(const Vec3& p) const {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double off = std::max({low[k] - p[k], p[k] - high[k], 0.0});
    sum += off * off;
  }
  return sum;
}

std::size_t EmptyDiscs::bin_of(const Normal& n) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
  const auto cell = [&](int k) {
    return n[axis] == 0 ? 0 : std::clamp(static_cast<int>((n[k] / std::abs(n[axis]) + 1) * 0.5f * cells), 0, cells - 1);
  };
  return static_cast<std::size_t>(((2 * axis + (n[axis] < 0)) * cells + cell((axis + 1) % 3)) * cells +
                                  cell((axis + 2) % 3));
}

template <class Wanted>
void EmptyDiscs::fill_bins(Wanted wanted, const Context& context) {
  Pace pace(context);
  for (Bin& bin : bins_) bin = Bin();
  std::vector<std::uint8_t> in_bin(feet_.size());  // its number + 1; 0 for a point that is not wanted
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, feet_.size(), 4096), [&](const auto& range) {
    context.checkpoint();
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      if (feet_[i].face >= 0 && wanted(feet_[i])) in_bin[i] = static_cast<std::uint8_t>(bin_of(feet_[i].normal) + 1);
  });
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    pace();
    if (in_bin[i] == 0) continue;
    Bin& bin = bins_[in_bin[i] - 1u];
    bin.places.push_back(feet_[i].point);
    bin.normals.push_back(feet_[i].normal);
    bin.points.push_back(static_cast<std::int32_t>(i));
  }
  tbb::parallel_for(std::size_t{0}, bins_.size(), [&](std::size_t b) {
    context.checkpoint();
    bins_[b].finish();
  });
}

EmptyDiscs::End EmptyDiscs::nearest_point(const Foot& at, End nearest) const {
  thread_local std::vector<NearestPoints::Neighbor> found;
  // Bins of which every point counts come first: they bound the search in those of which only some do.
  for (const bool whole : {true, false})
    for (const Bin& bin : bins_) {
      if (bin.places.empty() || bin.squared_distance(at.point) >= nearest.distance * nearest.distance) continue;
      const double angle = std::acos(std::clamp(cosine(at.normal, bin.middle), -1.0, 1.0));
      if (angle - bin.spread > other_way || whole != (angle + bin.spread < other_way)) continue;
      for (std::size_t k = whole ? 1 : 8;; k *= 8) {
        bin.tree->nearest(at.point, k, found);
        const auto counts = std::find_if(found.begin(), found.end(), [&](const NearestPoints::Neighbor& n) {
          return whole || n.squared_distance >= nearest.distance * nearest.distance ||
                 cosine(bin.normals[n.index], at.normal) > std::cos(other_way);
        });
        if (counts != found.end() && counts->squared_distance < nearest.distance * nearest.distance)
          nearest = {std::sqrt(counts->squared_distance), bin.places[counts->index], bin.points[counts->index]};
        if (counts != found.end() || found.size() < k) break;
      }
    }
  return nearest;
}

}  // namespace tri

#include "meshops/operators/thin.hpp"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "meshops/error.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/points/keep_points.hpp"

namespace tri {
namespace {

constexpr double most_voxels = 1125899906842624.0;  // 2^50: cells are still told apart by doubles

/// Two points of a voxel are always equally near their mean; rounding is not to choose between them.
constexpr double equally_near = 1e-6;

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Vec3& p, double voxel) {
  return {static_cast<std::int64_t>(std::floor(p[0] / voxel)), static_cast<std::int64_t>(std::floor(p[1] / voxel)),
          static_cast<std::int64_t>(std::floor(p[2] / voxel))};
}

void check_range(const PointSet& set, double voxel) {
  for (std::size_t i = 0; i < set.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(set.points[i][k]) / voxel <= most_voxels))
        throw InvalidInput(fmt::format("voxel = {} is too small: coordinate {} of point {} is more than 2^50 voxels",
                                       voxel, set.points[i][k], i));
}

struct Thinned {
  std::vector<std::uint32_t> kept;  // ascending
  std::size_t fullest = 0;
};

/// The point of a voxel that is nearest to the mean of them. @param indices ascending
std::uint32_t nearest_to_mean(const PointSet& set, const std::vector<std::uint32_t>& indices) {
  const Vec3 origin = set.points[indices[0]];  // sums of small numbers, however far away the points are
  Vec3 sum(0, 0, 0);
  for (const std::uint32_t i : indices) sum += set.points[i] - origin;
  const Vec3 mean = sum / static_cast<double>(indices.size());
  const auto distance = [&](std::uint32_t i) { return (set.points[i] - origin - mean).norm(); };
  std::uint32_t best = indices[0];
  double least = distance(best);
  for (const std::uint32_t i : indices)
    if (const double d = distance(i); d < least * (1 - equally_near)) best = i, least = d;
  return best;
}

/// @param key_of  voxel of a point, equal for points of one voxel only
template <class Key, class KeyOf>
Thinned thin_by(const PointSet& set, const KeyOf& key_of, Context& context) {
  struct Entry {
    Key key;
    std::uint32_t point;
    bool operator<(const Entry& other) const { return key != other.key ? key < other.key : point < other.point; }
  };
  std::vector<Entry> entries(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) entries[i] = {key_of(set.points[i]), static_cast<std::uint32_t>(i)};
  context.checkpoint();
  context.progress("thin", 0.2);
  tbb::task_arena arena(worker_threads(context));
  arena.execute([&] { tbb::parallel_sort(entries.begin(), entries.end()); });
  context.checkpoint();
  context.progress("thin", 0.7);
  Thinned result;
  std::vector<std::uint32_t> voxel;
  for (std::size_t first = 0; first < entries.size();) {
    voxel.clear();
    std::size_t i = first;
    for (; i < entries.size() && entries[i].key == entries[first].key; ++i) voxel.push_back(entries[i].point);
    result.kept.push_back(nearest_to_mean(set, voxel));
    result.fullest = std::max(result.fullest, voxel.size());
    first = i;
  }
  context.checkpoint();
  std::sort(result.kept.begin(), result.kept.end());
  return result;
}

Thinned thin_points(const PointSet& set, double voxel, Context& context) {
  Cell low = cell_of(set.points[0], voxel), high = low;
  for (const Vec3& p : set.points) {
    const Cell cell = cell_of(p, voxel);
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], cell[k]), high[k] = std::max(high[k], cell[k]);
  }
  context.checkpoint();
  std::array<int, 3> bits{};
  for (std::size_t k = 0; k < 3; ++k) bits[k] = std::bit_width(static_cast<std::uint64_t>(high[k] - low[k]));
  if (bits[0] + bits[1] + bits[2] > 64)
    return thin_by<Cell>(
        set, [voxel](const Vec3& p) { return cell_of(p, voxel); }, context);
  return thin_by<std::uint64_t>(
      set,
      [&](const Vec3& p) {
        const Cell cell = cell_of(p, voxel);
        std::uint64_t key = 0;
        for (std::size_t k = 0; k < 3; ++k)
          key = (bits[k] == 64 ? 0 : key << bits[k]) | static_cast<std::uint64_t>(cell[k] - low[k]);
        return key;
      },
      context);
}

}  // namespace

const OptionSchema& ThinOptions::schema() {
  using O = ThinOptions;
  static const OptionSchema schema = Schema<O>().number(
      "voxel", &O::voxel,
      {.unit = "mm", .min = 0, .min_open = true, .help = "side of the cubes of which each keeps one point"});
  return schema;
}

Report thin(PointSet& set, const ThinOptions& options, Context& context) {
  validate(options);
  validate(set);
  check_range(set, options.voxel);
  context.checkpoint();
  context.progress("thin", 0);
  Report report;
  report.operation = "thin";
  if (set.empty()) return report;
  const Thinned thinned = thin_points(set, options.voxel, context);
  report.figures["points kept"] = static_cast<double>(thinned.kept.size());
  report.figures["points in the fullest voxel"] = static_cast<double>(thinned.fullest);
  keep_and_report(set, thinned.kept, report);
  context.progress("thin", 1);
  return report;
}

}  // namespace tri

#include "meshops/checks/point_summary.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace tri {
namespace {

constexpr int bits = 20;  // a coordinate is one of 2^20 cells along the longest side of the box
constexpr std::size_t sampled = 20000;

std::uint64_t spread_by_three(std::uint64_t v) {  // bit i to bit 3 i
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

// Cells of an octree in Morton order. A point's nearest neighbour is looked for in the 27 cells about it at some level;
// if it is farther away than a cell is wide, one level up.
class Octree {
 public:
  Octree(std::vector<Vec3> places, const Vec3& low, double side) : low_(low), cell_(side / (1 << bits)) {
    entries_.reserve(places.size());
    for (const Vec3& p : places) entries_.push_back({code(indices(p)), p});
    tbb::parallel_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return a.code != b.code ? a.code < b.code : before(a.place, b.place);
    });
    level_ = bits;
    // Coarser until cells hold two points each in the mean.
    while (level_ > 0 && occupied(level_) * 2 > entries_.size()) --level_;
  }

  std::size_t size() const { return entries_.size(); }

  double nearest(std::size_t i) const {
    const Vec3& p = entries_[i].place;
    for (int level = level_;; --level) {
      const double best = nearest_in_block(p, i, level);
      if (level == 0 || best <= cell_ * (1 << (bits - level))) return best;
    }
  }

 private:
  struct Entry {
    std::uint64_t code;
    Vec3 place;
  };

  static bool before(const Vec3& a, const Vec3& b) {
    return std::array{a[0], a[1], a[2]} < std::array{b[0], b[1], b[2]};
  }
  std::array<std::int64_t, 3> indices(const Vec3& p) const {
    std::array<std::int64_t, 3> index{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double cell = cell_ > 0 ? std::floor((p[k] - low_[k]) / cell_) : 0;
      index[k] = static_cast<std::int64_t>(std::clamp(cell, 0.0, double((1 << bits) - 1)));
    }
    return index;
  }
  static std::uint64_t code(const std::array<std::int64_t, 3>& index) {
    return spread_by_three(std::uint64_t(index[0])) | spread_by_three(std::uint64_t(index[1])) << 1 |
           spread_by_three(std::uint64_t(index[2])) << 2;
  }

  std::size_t occupied(int level) const {
    const int shift = 3 * (bits - level);
    std::size_t count = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i)
      count += i == 0 || entries_[i].code >> shift != entries_[i - 1].code >> shift;
    return count;
  }

  double nearest_in_block(const Vec3& p, std::size_t self, int level) const {
    const int down = bits - level;
    const std::int64_t cells = std::int64_t{1} << level;
    auto middle = indices(p);
    for (auto& index : middle) index >>= down;
    double best = std::numeric_limits<double>::infinity();
    for (int n = 0; n < 27; ++n) {
      const std::array<std::int64_t, 3> cell{middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1};
      if (std::any_of(cell.begin(), cell.end(), [&](std::int64_t c) { return c < 0 || c >= cells; })) continue;
      const std::uint64_t first = code(cell) << 3 * down, last = first + (std::uint64_t{1} << 3 * down);
      const auto at = [&](std::uint64_t c) {
        return std::lower_bound(entries_.begin(), entries_.end(), c,
                                [](const Entry& e, std::uint64_t v) { return e.code < v; });
      };
      for (auto entry = at(first); entry != entries_.end() && entry->code < last; ++entry)
        if (static_cast<std::size_t>(entry - entries_.begin()) != self)
          best = std::min(best, (entry->place - p).norm());
    }
    return best;
  }

  Vec3 low_;
  double cell_;
  int level_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace

PointSummary summarize(std::span<const Vec3> points) {
  PointSummary s;
  s.points = points.size();
  if (points.empty()) return s;
  s.box_min = s.box_max = points[0];
  for (const Vec3& p : points) {
    s.box_min.minimize(p);
    s.box_max.maximize(p);
  }
  std::vector<Vec3> places(points.begin(), points.end());
  tbb::parallel_sort(places.begin(), places.end(), [](const Vec3& a, const Vec3& b) {
    return std::array{a[0], a[1], a[2]} < std::array{b[0], b[1], b[2]};
  });
  places.erase(std::unique(places.begin(), places.end()), places.end());
  s.duplicates = points.size() - places.size();
  if (places.size() < 2) return s;

  const Octree tree(std::move(places), s.box_min, (s.box_max - s.box_min).max());
  const std::size_t count = std::min(sampled, tree.size());
  std::vector<double> distances(count);
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t i) { distances[i] = tree.nearest(i * tree.size() / count); });
  std::sort(distances.begin(), distances.end());
  const auto quantile = [&](double share) { return distances[static_cast<std::size_t>(share * double(count - 1))]; };
  s.spacing_5 = quantile(0.05);
  s.spacing_median = quantile(0.5);
  s.spacing_95 = quantile(0.95);
  return s;
}

}  // namespace tri

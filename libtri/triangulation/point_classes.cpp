#include "libtri/triangulation/point_classes.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "meshops/pace.hpp"
#include "meshops/search/cancellable_sort.hpp"
#include "meshops/search/nearest_points.hpp"

namespace tri {
namespace {

constexpr double sigmas = 8;
constexpr double least_share_of_diagonal = 1e-4;
constexpr std::size_t neighbors_asked = 9;

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = 0;
  for (int k = 0; k < 3; ++k) {
    h ^= std::bit_cast<std::uint64_t>(p[k] + 0.0);  // -0 and 0 are the same place
    h *= 0x9E3779B97F4A7C15ull;
    h ^= h >> 32;
  }
  return h;
}

/// The mean of the two middle values where their number is even: on a slope neither side may win.
double median(std::vector<double>& x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return x.size() % 2 == 1 ? *middle : 0.5 * (*middle + *std::max_element(x.begin(), middle));
}

}  // namespace

std::vector<std::uint32_t> find_duplicates(std::span<const Vec3> points, const Context* context) {
  Pace pace(context);
  // Half of the hash, and the point: few others share it, and these are told apart below.
  constexpr std::uint64_t half = 0xffffffff00000000;
  std::vector<std::uint64_t> keys(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) keys[i] = (hash(points[i]) & half) | i;
  });
  cancellable_sort(keys.begin(), keys.end(), context);
  std::vector<std::uint32_t> duplicates;
  for (std::size_t i = 0; i < keys.size();) {
    pace();
    std::size_t j = i + 1;
    while (j < keys.size() && (keys[j] & half) == (keys[i] & half)) ++j;
    for (std::size_t b = i + 1; b < j; ++b)
      for (std::size_t a = i; a < b; ++a)
        if (points[keys[a] & ~half] == points[keys[b] & ~half]) {
          duplicates.push_back(static_cast<std::uint32_t>(keys[b]));
          break;
        }
    i = j;
  }
  std::sort(duplicates.begin(), duplicates.end());
  return duplicates;
}

double robust_sigma(std::span<const Foot> feet) {
  std::vector<double> distances;
  for (const Foot& f : feet)
    if (f.face >= 0) distances.push_back(std::abs(f.deviation));
  return distances.empty() ? 0 : 1.4826 * median(distances);
}

std::vector<std::uint32_t> find_outliers(std::span<const Foot> feet, double diagonal, std::optional<double> distance) {
  return find_outliers(feet, diagonal, distance, distance ? 0 : robust_sigma(feet));
}

std::vector<std::uint32_t> find_outliers(std::span<const Foot> feet, double diagonal, std::optional<double> distance,
                                         double sigma) {
  const double limit = distance ? *distance : std::max(sigmas * sigma, least_share_of_diagonal * diagonal);
  std::vector<std::uint32_t> far;
  for (std::uint32_t i = 0; i < feet.size(); ++i)
    if (feet[i].face >= 0 && std::abs(feet[i].deviation) > limit) far.push_back(i);
  if (far.empty() || distance) return far;

  std::vector<Vec3> places;
  std::vector<std::uint32_t> index;
  for (std::uint32_t i = 0; i < feet.size(); ++i)
    if (feet[i].face >= 0) places.push_back(feet[i].point), index.push_back(i);
  const NearestPoints tree(places);
  std::vector<NearestPoints::Neighbor> near;
  std::vector<double> around;
  std::vector<std::uint32_t> outliers;
  for (std::uint32_t i : far) {
    tree.nearest(feet[i].point, neighbors_asked, near);
    around.clear();
    for (const auto& n : near)
      if (index[n.index] != i) around.push_back(feet[index[n.index]].deviation);
    if (around.empty() || std::abs(feet[i].deviation - median(around)) > limit) outliers.push_back(i);
  }
  return outliers;
}

}  // namespace tri

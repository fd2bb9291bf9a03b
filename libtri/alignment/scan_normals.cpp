#include "libtri/alignment/scan_normals.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "libtri/alignment/pose.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/nearest_points.hpp"

namespace tri {
namespace {

constexpr std::size_t normals_block = 128;
constexpr std::size_t most_looked_at = 40000;
constexpr double spread_wanted = 0.15;  // middle over largest variance: less is a line and no patch
constexpr double flatness = 0.1;        // smallest over middle variance: more is no plane

double percentile(std::vector<double> x, double share) {
  const auto at = x.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(x.size() - 1));
  std::nth_element(x.begin(), at, x.end());
  return *at;
}

// The first point of each cube of size `h`, in the order of the points.
std::vector<std::uint32_t> first_in_cubes(std::span<const Vec3> points, const Vec3& centre, double h) {
  std::unordered_set<std::uint64_t> seen;
  seen.reserve(points.size());
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      const double x = std::clamp(std::floor((points[i][k] - centre[k]) / h), -1e6, 1e6);
      key = (key << 21) | (static_cast<std::uint64_t>(static_cast<std::int64_t>(x) + (1 << 20)) & 0x1fffff);
    }
    if (seen.insert(key).second) kept.push_back(i);
  }
  return kept;
}

Vec3 plane_normal(std::span<const Vec3> points, const NearestPoints& tree, const Vec3& place) {
  std::vector<NearestPoints::Neighbor> near;
  for (std::size_t k = 9; k <= 72; k *= 2) {
    tree.nearest(place, k, near);
    if (near.size() < 6) break;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& n : near) mean += to_eigen(points[n.index]);
    mean /= static_cast<double>(near.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& n : near) {
      const Eigen::Vector3d d = to_eigen(points[n.index]) - mean;
      spread += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    const Eigen::Vector3d& values = solver.eigenvalues();
    if (values[1] < spread_wanted * values[2]) continue;
    if (values[0] > flatness * values[1]) break;
    return to_vec(solver.eigenvectors().col(0));
  }
  return {0, 0, 0};
}

}  // namespace

std::vector<std::uint32_t> random_indices(std::size_t size, std::size_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> chosen;
  chosen.reserve(std::min(size, count));
  RandomStream random(seed, 2);
  std::size_t needed = std::min(size, count);
  for (std::size_t i = 0; i < size && needed > 0; ++i) {
    if (random.below(size - i) < needed) {
      chosen.push_back(static_cast<std::uint32_t>(i));
      --needed;
    }
  }
  return chosen;
}

PointExtent extent_of(std::span<const Vec3> points) {
  PointExtent extent;
  if (points.empty()) return extent;
  std::vector<double> x(points.size());
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < points.size(); ++i) x[i] = points[i][k];
    extent.centre[k] = percentile(x, 0.5);
  }
  for (std::size_t i = 0; i < points.size(); ++i) x[i] = (points[i] - extent.centre).norm();
  extent.radius = percentile(x, 0.9);
  extent.half_radius = percentile(x, 0.5);
  return extent;
}

ScanSubset scan_subset(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t count,
                       std::uint64_t seed, const Context& context) {
  ScanSubset subset;
  const std::vector<std::uint32_t> looked_at = random_indices(points.size(), most_looked_at, seed);
  std::vector<Vec3> some;
  some.reserve(looked_at.size());
  for (const std::uint32_t i : looked_at) some.push_back(points[i]);
  const PointExtent extent = extent_of(some);
  subset.centre = extent.centre;
  subset.radius = extent.radius;
  subset.half_radius = extent.half_radius;
  context.checkpoint();

  std::vector<std::uint32_t> kept;
  if (some.size() > count && subset.radius > 0) {
    double h = subset.radius / 40;
    for (int i = 0; i < 5; ++i) {
      kept = first_in_cubes(some, subset.centre, h);
      const double ratio = static_cast<double>(kept.size()) / static_cast<double>(count);
      if (ratio > 0.8 && ratio < 1.2) break;
      h *= std::sqrt(ratio);
    }
  } else {
    kept.resize(some.size());
    for (std::uint32_t i = 0; i < kept.size(); ++i) kept[i] = i;
  }
  subset.oriented = !normals.empty();
  for (const std::uint32_t i : kept) {
    subset.points.push_back(some[i]);
    if (subset.oriented) subset.normals.push_back(normals[looked_at[i]]);
  }
  if (!subset.oriented) {
    subset.normals.resize(subset.points.size());
    const NearestPoints tree(subset.points);
    for_each_block(context, "", subset.points.size(), normals_block,
                   [&](std::size_t, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i)
                       subset.normals[i] = plane_normal(subset.points, tree, subset.points[i]);
                   });
  }
  return subset;
}

}  // namespace tri

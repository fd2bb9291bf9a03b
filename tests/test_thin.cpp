#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "meshops/error.hpp"
#include "meshops/operators/thin.hpp"

using namespace tri;

namespace {

std::vector<Vec3> random_points(std::size_t n, const Vec3& center, double half, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-half, half);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) points.push_back(center + Vec3(value(random), value(random), value(random)));
  return points;
}

/// The definition, voxel by voxel.
std::vector<Vec3> thinned_by_definition(const std::vector<Vec3>& points, double voxel) {
  std::map<std::array<double, 3>, std::vector<std::size_t>> voxels;
  for (std::size_t i = 0; i < points.size(); ++i)
    voxels[{std::floor(points[i][0] / voxel), std::floor(points[i][1] / voxel), std::floor(points[i][2] / voxel)}]
        .push_back(i);
  std::vector<std::size_t> kept;
  for (const auto& entry : voxels) {
    Vec3 mean(0, 0, 0);
    for (const std::size_t i : entry.second) mean += points[i] / static_cast<double>(entry.second.size());
    std::size_t best = entry.second[0];
    for (const std::size_t i : entry.second)
      if ((points[i] - mean).norm() < (points[best] - mean).norm() * (1 - 1e-6)) best = i;
    kept.push_back(best);
  }
  std::sort(kept.begin(), kept.end());
  std::vector<Vec3> result;
  for (const std::size_t i : kept) result.push_back(points[i]);
  return result;
}

}  // namespace

TEST_CASE("thin: of each voxel the point nearest the mean stays, also across zero and far from it") {
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(-1e6, 3e5, 17)})
    for (const double voxel : {0.5, 1.3, 40.0}) {
      CAPTURE(voxel);
      PointSet set;
      set.points = random_points(3000, center, 5, 1);
      const std::vector<Vec3> expected = thinned_by_definition(set.points, voxel);
      Context context;
      const Report report = thin(set, {.voxel = voxel}, context);
      CHECK(set.points == expected);
      CHECK(report.figures.at("points kept") == static_cast<double>(expected.size()));
      CHECK(report.vertices_removed == 3000 - expected.size());
    }
}

TEST_CASE("thin: a box too wide for one number per voxel gives the same") {
  PointSet set;
  set.points = random_points(500, Vec3(0, 0, 0), 5, 2);
  for (const double far : {1e9, -1e9}) set.points.emplace_back(far, -far, far);
  const std::vector<Vec3> expected = thinned_by_definition(set.points, 1e-3);
  const std::vector<Vec3> before = set.points;
  Context context;
  thin(set, {.voxel = 1e-3}, context);
  CHECK(set.points == expected);
  // The same with points to thin.
  set.points = before;
  for (std::size_t i = 0; i < 500; ++i) set.points.push_back(before[i] + Vec3(1e-7, 0, 0));
  const std::vector<Vec3> thinned = thinned_by_definition(set.points, 1e-3);
  thin(set, {.voxel = 1e-3}, context);
  CHECK(set.points == thinned);
}

TEST_CASE("thin: a voxel too small for the coordinates is refused") {
  PointSet set;
  set.points = {{1e10, 0, 0}, {1, 2, 3}};
  Context context;
  CHECK_THROWS_AS(thin(set, {.voxel = 1e-9}, context), InvalidInput);
  CHECK(set.size() == 2);
  CHECK_THROWS_AS(thin(set, {.voxel = 0}, context), InvalidInput);
}

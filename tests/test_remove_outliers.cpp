#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "meshops/operators/remove_outliers.hpp"

using namespace tri;

namespace {

/// The definition by brute force: indices that stay.
std::vector<std::size_t> outliers_by_definition(const std::vector<Vec3>& points, std::size_t neighbors, double sigma) {
  std::vector<double> distance;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<double> all;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i) all.push_back((points[j] - points[i]).norm());
    std::sort(all.begin(), all.end());
    all.resize(std::min(neighbors, all.size()));
    double sum = 0;
    for (const double d : all) sum += d;
    distance.push_back(sum / static_cast<double>(all.size()));
  }
  const auto n = static_cast<double>(points.size());
  double mean = 0, squares = 0;
  for (const double d : distance) mean += d / n;
  for (const double d : distance) squares += (d - mean) * (d - mean);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (distance[i] <= mean + sigma * std::sqrt(squares / (n - 1))) kept.push_back(i);
  return kept;
}

std::vector<Vec3> sheet_with_strays(std::vector<std::size_t>& strays) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> value(0, 20);
  std::vector<Vec3> points;
  for (int i = 0; i < 800; ++i) {
    if (i % 100 == 50) {
      strays.push_back(points.size());
      points.emplace_back(value(random), value(random), 12 + value(random));
    }
    points.emplace_back(value(random), value(random), 0);
  }
  return points;
}

}  // namespace

TEST_CASE("remove_outliers: what lies alone goes, as the definition says") {
  std::vector<std::size_t> strays;
  const std::vector<Vec3> points = sheet_with_strays(strays);
  for (const auto& option : {std::pair{16, 3.0}, {1, 1.0}, {5, 0.5}, {40, 0.0}}) {
    const int neighbors = option.first;
    const double sigma = option.second;
    CAPTURE(neighbors);
    PointSet set;
    set.points = points;
    Context context;
    const Report report = remove_outliers(set, {.neighbors = neighbors, .sigma = sigma}, context);
    std::vector<Vec3> expected;
    for (const std::size_t i : outliers_by_definition(points, static_cast<std::size_t>(neighbors), sigma))
      expected.push_back(points[i]);
    CHECK(set.points == expected);
    CHECK(report.vertices_removed == points.size() - expected.size());
    CHECK(report.figures.at("limit") ==
          doctest::Approx(report.figures.at("mean distance") + sigma * report.figures.at("standard deviation")));
  }
  PointSet set;
  set.points = points;
  Context context;
  const Report report = remove_outliers(set, {}, context);
  for (const std::size_t i : strays) CHECK(report.maps.vertices[i] == ElementMaps::removed);
}

TEST_CASE("remove_outliers: coincident points, few points and no limit") {
  Context context;
  PointSet set;
  set.points.assign(30, Vec3(1, 1, 1));
  CHECK(remove_outliers(set, {.neighbors = 4}, context).unchanged());
  set.points.emplace_back(9, 9, 9);
  CHECK(remove_outliers(set, {.neighbors = 4}, context).vertices_removed == 1);
  CHECK(set.size() == 30);
  set.points = {{0, 0, 0}, {1, 0, 0}};
  CHECK(remove_outliers(set, {.neighbors = 100}, context).unchanged());
  set.points.emplace_back(1000, 0, 0);
  CHECK(remove_outliers(set, {.neighbors = 1, .sigma = std::numeric_limits<double>::infinity()}, context).unchanged());
}

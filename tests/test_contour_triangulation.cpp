#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "meshops/joining/contour_triangulation.hpp"

using namespace tri;

namespace {

std::vector<Vec3> line(int n, double y, double length = 10) {
  std::vector<Vec3> points;
  for (int i = 0; i <= n; ++i) points.push_back({length * i / n, y, 0});
  return points;
}

double strip_area(const std::vector<Vec3>& first, const std::vector<Vec3>& second,
                  const std::vector<ContourStep>& steps) {
  double sum = 0;
  std::size_t i = 0, j = 0;
  for (const ContourStep s : steps) {
    const Vec3& apex = s == ContourStep::first ? second[j] : first[i];
    const Vec3& a = s == ContourStep::first ? first[i] : second[j];
    const Vec3& b = s == ContourStep::first ? first[i + 1] : second[j + 1];
    sum += 0.5 * ((b - a) % (apex - a)).norm();
    ++(s == ContourStep::first ? i : j);
  }
  CHECK(i + 1 == first.size());
  CHECK(j + 1 == second.size());
  return sum;
}

}  // namespace

TEST_CASE("triangulate_contours: a straight gap is covered exactly, whatever the numbers of points") {
  for (const int m : {1, 2, 7, 40})
    for (const int n : {1, 3, 7, 90}) {
      const auto first = line(m, 0), second = line(n, 1);
      const auto steps = triangulate_contours(first, second, {});
      REQUIRE(steps);
      CHECK(steps->size() == static_cast<std::size_t>(m + n));
      CHECK(strip_area(first, second, *steps) == doctest::Approx(10));
    }
}

TEST_CASE("triangulate_contours: a single point is joined to a contour by a fan") {
  const auto first = line(5, 0);
  const std::vector<Vec3> apex{{5, 2, 0}};
  const auto steps = triangulate_contours(first, apex, {});
  REQUIRE(steps);
  CHECK(std::count(steps->begin(), steps->end(), ContourStep::first) == 5);
  CHECK(strip_area(first, apex, *steps) == doctest::Approx(10));
}

TEST_CASE("triangulate_contours: equal contours advance in turn") {
  const auto first = line(30, 0), second = line(30, 0.5);
  const auto steps = triangulate_contours(first, second, {});
  REQUIRE(steps);
  for (std::size_t k = 0; k + 1 < steps->size(); k += 2) CHECK((*steps)[k] != (*steps)[k + 1]);
}

TEST_CASE("triangulate_contours: a contour whose one half is ragged does not slant the strip over the other half") {
  std::vector<Vec3> first, second = line(100, 1, 100);
  for (int i = 0; i <= 100; ++i) first.push_back({double(i), i < 50 && i % 2 ? -2.0 : 0.0, 0});
  const auto steps = triangulate_contours(first, second, {});
  REQUIRE(steps);
  int i = 0, j = 0;
  for (const ContourStep s : *steps) {
    ++(s == ContourStep::first ? i : j);
    CHECK(std::abs(first[i][0] - second[j][0]) < 6);
  }
}

TEST_CASE("triangulate_contours: takes no forbidden step, and says when it is stuck") {
  const auto first = line(10, 0), second = line(10, 1);
  std::mt19937 random(5);
  int stuck = 0;
  for (int round = 0; round < 50; ++round) {
    bool forbidden[11][11][2];
    for (auto& plane : forbidden)
      for (auto& row : plane)
        for (bool& f : row) f = random() % 100 < static_cast<unsigned>(round);
    const auto steps = triangulate_contours(
        first, second, [&](int i, int j, ContourStep s) { return !forbidden[i][j][s == ContourStep::second]; });
    if (!steps) {
      ++stuck;
      continue;
    }
    int i = 0, j = 0;
    for (const ContourStep s : *steps) {
      CHECK_FALSE(forbidden[i][j][s == ContourStep::second]);
      ++(s == ContourStep::first ? i : j);
    }
    CHECK(i == 10);
    CHECK(j == 10);
  }
  CHECK(stuck > 0);
  CHECK(stuck < 50);
  CHECK_FALSE(triangulate_contours(first, second, [](int, int, ContourStep) { return false; }));
  CHECK_FALSE(triangulate_contours(std::vector<Vec3>{{0, 0, 0}}, std::vector<Vec3>{{1, 0, 0}}, {}));
}

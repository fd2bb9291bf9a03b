#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "libtri/triangulation/point_order.hpp"

using namespace tri;

TEST_CASE("morton order: a permutation whose neighbours are near; points that are not finite come last") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points(20000);
  for (Vec3& p : points) p = Vec3(unit(random), unit(random), unit(random));
  points[3][1] = std::numeric_limits<double>::quiet_NaN();
  points[9] = Vec3(1e300, -5, 2);  // outside the box
  const auto order = morton_order(points, Vec3(0, 0, 0), Vec3(1, 1, 1));
  std::vector<std::uint32_t> sorted = order, all(points.size());
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0u);
  CHECK(sorted == all);
  CHECK(order.back() == 3);
  double along = 0, unordered = 0;
  for (std::size_t i = 10; i + 1 < points.size() - 1; ++i) {
    unordered += (points[i + 1] - points[i]).norm();
    if (order[i] != 9 && order[i + 1] != 9) along += (points[order[i + 1]] - points[order[i]]).norm();
  }
  CHECK(along < 0.1 * unordered);
}

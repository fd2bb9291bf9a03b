#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "meshops/checks/point_summary.hpp"

using namespace tri;

TEST_CASE("summarize: no points, one point and equal points have no spacing") {
  CHECK(summarize(std::vector<Vec3>{}).points == 0);
  CHECK(summarize(std::vector<Vec3>{{1, 2, 3}}).spacing_median == 0);
  const PointSummary s = summarize(std::vector<Vec3>(10, {1, 2, 3}));
  CHECK(s.points == 10);
  CHECK(s.duplicates == 9);
  CHECK(s.spacing_95 == 0);
}

TEST_CASE("summarize: scan lines have the spacing along the lines") {
  std::vector<Vec3> points;
  for (int line = 0; line < 20; ++line)
    for (int i = 0; i < 400; ++i) points.push_back({i * 0.5, line * 10.0, 7});
  points.push_back({1e4, 1e4, 1e4});  // an outlier must not matter
  const PointSummary s = summarize(points);
  CHECK(s.spacing_5 == doctest::Approx(0.5));
  CHECK(s.spacing_median == doctest::Approx(0.5));
  CHECK(s.spacing_95 == doctest::Approx(0.5));
  CHECK(s.box_max == Vec3(1e4, 1e4, 1e4));
}

TEST_CASE("summarize: spacings are those of brute force, for a uniform and a clustered cloud") {
  std::mt19937 random(5);
  for (const double power : {1.0, 6.0}) {
    std::vector<Vec3> points(900);
    for (Vec3& p : points)
      for (int k = 0; k < 3; ++k) p[k] = 50 * std::pow(double(random()) / 4294967296.0, power) - 3;
    std::vector<double> nearest;
    for (const Vec3& p : points) {
      double best = std::numeric_limits<double>::infinity();
      for (const Vec3& q : points)
        if (&p != &q) best = std::min(best, (p - q).norm());
      nearest.push_back(best);
    }
    std::sort(nearest.begin(), nearest.end());
    const PointSummary s = summarize(points);
    CHECK(s.spacing_5 == nearest[44]);  // 0.05 * 899
    CHECK(s.spacing_median == nearest[449]);
    CHECK(s.spacing_95 == nearest[854]);
  }
}

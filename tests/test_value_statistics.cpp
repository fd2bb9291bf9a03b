#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "meshops/checks/value_statistics.hpp"
#include "meshops/error.hpp"

using namespace tri;

TEST_CASE("value_statistics: the numbers of 1 to n have their closed forms") {
  for (const int n : {1, 2, 5, 16384, 16385, 100001}) {
    CAPTURE(n);
    std::vector<double> values(static_cast<std::size_t>(n));
    std::iota(values.begin(), values.end(), 1.0);
    std::shuffle(values.begin(), values.end(), std::mt19937(4));
    const double m = n;
    const ValueStatistics s = value_statistics(values, Tolerance{1, 3}, {});
    CHECK(s.count == values.size());
    CHECK(s.mean == doctest::Approx((m + 1) / 2).epsilon(1e-14));
    CHECK(s.rms == doctest::Approx(std::sqrt((m + 1) * (2 * m + 1) / 6)).epsilon(1e-13));
    CHECK(s.standard_deviation == doctest::Approx(n > 1 ? std::sqrt(m * (m + 1) / 12) : 0).epsilon(1e-13));
    CHECK(s.min == 1);
    CHECK(s.max == m);
    CHECK(values[s.min_index] == 1);
    CHECK(values[s.max_index] == m);
    CHECK(s.median == doctest::Approx((m + 1) / 2));
    CHECK(s.p5 == doctest::Approx(1 + 0.05 * (m - 1)));
    CHECK(s.p95 == doctest::Approx(1 + 0.95 * (m - 1)));
    CHECK(s.in_tolerance == static_cast<std::uint64_t>(std::min(n, 3)));
  }
}

TEST_CASE("value_statistics: a small spread far from 0 is not lost") {
  std::vector<double> values;
  for (int i = 0; i < 50000; ++i) values.push_back(1e8 + (i % 2 == 0 ? -0.5 : 0.5));
  const ValueStatistics s = value_statistics(values, std::nullopt, {});
  CHECK(s.mean == doctest::Approx(1e8).epsilon(1e-15));
  CHECK(s.standard_deviation == doctest::Approx(0.5 * std::sqrt(50000.0 / 49999)).epsilon(1e-9));
  CHECK(s.in_tolerance == 0);
}

TEST_CASE("value_statistics: to the last bit the same for any number of threads") {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.01, 0.1);
  std::vector<double> values(200000);
  for (double& v : values) v = normal(random);
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  const ValueStatistics a = value_statistics(values, std::nullopt, one),
                        b = value_statistics(values, std::nullopt, four);
  CHECK(a.mean == b.mean);
  CHECK(a.rms == b.rms);
  CHECK(a.standard_deviation == b.standard_deviation);
}

TEST_CASE("value_statistics: nothing has no numbers, equal values no spread, and a cancel is heeded") {
  CHECK(value_statistics({}, std::nullopt, {}).count == 0);
  const std::vector<double> equal(40000, 0.1);
  const ValueStatistics s = value_statistics(equal, Tolerance{0.1, 0.1}, {});
  CHECK(s.standard_deviation == 0);
  CHECK(s.mean == 0.1);
  CHECK(s.in_tolerance == 40000);
  Context cancelled;
  cancelled.cancel();
  CHECK_THROWS_AS(value_statistics(equal, std::nullopt, cancelled), Cancelled);
}

TEST_CASE("percentile: interpolates between neighbours") {
  std::vector<double> values{40, 10, 30, 20};
  CHECK(percentile(values, 0) == 10);
  CHECK(percentile(values, 1) == 40);
  CHECK(percentile(values, 0.5) == 25);
  CHECK(percentile(values, 1.0 / 3) == doctest::Approx(20));
  CHECK(percentile({}, 0.5) == 0);
}

TEST_CASE("histogram: every value is counted once, borders upward, the upper end in the last bin") {
  const std::vector<double> values{-0.1, 0, 0.25, 0.5, 0.99, 1, 1.01, 7};
  const Histogram h = histogram(values, 0, 1, 4);
  CHECK(h.bins == std::vector<std::uint64_t>{1, 1, 1, 2});
  CHECK(h.below == 1);
  CHECK(h.above == 2);
  CHECK_THROWS_AS(histogram(values, 1, 1, 4), InvalidInput);
  CHECK_THROWS_AS(histogram(values, 0, 1, 0), InvalidInput);
}

TEST_CASE("Tolerance: both ends belong to it, and the excess is the distance from it") {
  const Tolerance t{-0.1, 0.3};
  CHECK((t.holds(-0.1) && t.holds(0.3) && !t.holds(-0.11) && !t.holds(0.31)));
  CHECK(t.excess(0.5) == doctest::Approx(0.2));
  CHECK(t.excess(-0.5) == doctest::Approx(0.4));
  CHECK(t.excess(0.3) == 0);
  CHECK(t.excess(0.2) < 0);
}

TEST_CASE("range_to_show: what 98% do not exceed, in two digits") {
  std::vector<double> values;
  for (int i = 0; i <= 100; ++i) values.push_back((i % 2 == 0 ? -0.001 : 0.001) * i);
  CHECK(range_to_show(values) == 0.098);
  for (double& v : values) v *= 1.001;
  CHECK(range_to_show(values) == 0.099);
  for (double& v : values) v *= 1e6;
  CHECK(range_to_show(values) == 99000);
  CHECK(range_to_show(std::vector<double>{0, 0}) == 0);
  CHECK(range_to_show({}) == 0);
}

TEST_CASE("worst_places: the worst first, and none within the radius of a worse one") {
  const std::vector<Vec3> points{{0, 0, 0}, {0.5, 0, 0}, {2, 0, 0}, {2.5, 0, 0}, {9, 0, 0}, {7, 0, 0}};
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> severity{3, 4, 1, 2, std::nan(""), -infinity};
  using List = std::vector<std::uint32_t>;
  CHECK(worst_places(points, severity, 1, 9) == List{1, 3});
  CHECK(worst_places(points, severity, 0, 9) == List{1, 0, 3, 2});
  CHECK(worst_places(points, severity, 1, 1) == List{1});
  CHECK(worst_places({}, {}, 1, 3).empty());
}

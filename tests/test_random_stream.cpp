#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "meshops/random_stream.hpp"

using namespace tri;

TEST_CASE("RandomStream: the same seed and stream repeat, any other does not") {
  CHECK(RandomStream(7, 1, 2).bits() == RandomStream(7, 1, 2).bits());
  CHECK(RandomStream(7, 1, 2).bits() != RandomStream(8, 1, 2).bits());
  CHECK(RandomStream(7, 1, 2).bits() != RandomStream(7, 2, 1).bits());
  CHECK(RandomStream(7, 1, 2).bits() != RandomStream(7, 1, 3).bits());
  CHECK(RandomStream(0).bits() != RandomStream(0, 0, 1).bits());
}

TEST_CASE("RandomStream: below stays below and takes every value equally often") {
  RandomStream random(3);
  constexpr int values = 10, draws = 100000;
  std::vector<int> counts(values);
  for (int i = 0; i < draws; ++i) ++counts.at(random.below(values));
  double chi2 = 0;
  for (const int count : counts) chi2 += std::pow(count - draws / values, 2) / (draws / values);
  CHECK(chi2 < (values - 1) + 5 * std::sqrt(2.0 * (values - 1)));
  CHECK(random.below(1) == 0);
  const std::uint64_t huge = (1ULL << 63) + 12345;
  std::uint64_t largest = 0;
  for (int i = 0; i < 1000; ++i) largest = std::max(largest, random.below(huge));
  CHECK(largest < huge);
  CHECK(largest > huge / 100 * 97);  // missed with a probability of 1e-13
}

TEST_CASE("RandomStream: uniform, normal and direction have the moments of their distributions") {
  RandomStream random(4);
  constexpr int n = 200000;
  double u1 = 0, u2 = 0, n1 = 0, n2 = 0, n4 = 0, outside = 0;
  Vec3 d1(0, 0, 0), d2(0, 0, 0);
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform(), x = random.normal();
    const Vec3 d = random.direction();
    CHECK_UNARY(u >= 0 && u < 1);
    CHECK_UNARY(std::abs(d.norm() - 1) < 1e-12);
    u1 += u / n;
    u2 += u * u / n;
    n1 += x / n;
    n2 += x * x / n;
    n4 += x * x * x * x / n;
    outside += std::abs(x) > 1 ? 1.0 / n : 0;
    d1 += d / n;
    for (int k = 0; k < 3; ++k) d2[k] += d[k] * d[k] / n;
  }
  // Five standard deviations of each mean.
  const double tolerance = 5 / std::sqrt(double(n));
  CHECK(std::abs(u1 - 0.5) < tolerance * std::sqrt(1.0 / 12));
  CHECK(std::abs(u2 - 1.0 / 3) < tolerance * std::sqrt(4.0 / 45));
  CHECK(std::abs(n1) < tolerance);
  CHECK(std::abs(n2 - 1) < tolerance * std::sqrt(2.0));
  CHECK(std::abs(n4 - 3) < tolerance * std::sqrt(96.0));
  CHECK(std::abs(outside - std::erfc(std::sqrt(0.5))) < tolerance * 0.5);
  for (int k = 0; k < 3; ++k) {
    CHECK(std::abs(d1[k]) < tolerance * std::sqrt(1.0 / 3));
    CHECK(std::abs(d2[k] - 1.0 / 3) < tolerance * std::sqrt(4.0 / 45));
  }
}

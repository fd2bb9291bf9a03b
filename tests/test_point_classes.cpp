#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "libtri/triangulation/point_classes.hpp"

using namespace tri;

namespace {

// Feet on the plane z = 0, on a grid of spacing 1; the deviation is what each test makes it.
template <class Deviation>
std::vector<Foot> plane_feet(int side, Deviation deviation) {
  std::vector<Foot> feet;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      Foot f;
      f.point = Vec3(i, j, 0);
      f.normal = {0, 0, 1};
      f.deviation = deviation(i, j);
      f.face = 0;
      feet.push_back(f);
    }
  return feet;
}

constexpr int side = 100;
const double plane_diagonal = std::sqrt(2.0) * (side - 1);

}  // namespace

TEST_CASE("find_duplicates: every point that equals an earlier one, and no other") {
  CHECK(find_duplicates({}).empty());
  const double next = std::nextafter(1.0, 2.0);
  const std::vector<Vec3> few{{1, 2, 3},    {1, 2, 3}, {0.0, 0, 0}, {-0.0, 0, 0},
                              {next, 2, 3}, {1, 2, 3}, {2, 1, 3},   {0, 0, 0}};
  CHECK(find_duplicates(few) == std::vector<std::uint32_t>{1, 3, 5, 7});

  std::mt19937 random(2);
  std::vector<Vec3> points;
  std::vector<std::uint32_t> expected;
  std::map<std::tuple<double, double, double>, int> seen;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Vec3 p(static_cast<double>(random() % 20), static_cast<double>(random() % 30) / 7,
                 static_cast<double>(random() % 40) - 20);
    points.push_back(p);
    if (seen[{p[0], p[1], p[2]}]++ > 0) expected.push_back(i);
  }
  REQUIRE(expected.size() > 1000);
  CHECK(find_duplicates(points) == expected);

  const std::vector<Vec3> all(1000, Vec3(7, 8, 9));
  CHECK(find_duplicates(all).size() == 999);
}

TEST_CASE("robust_sigma: the standard deviation of Gaussian deviations, hardly moved by outliers") {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.02);
  std::vector<Foot> feet = plane_feet(side, [&](int, int) { return noise(random); });
  CHECK(robust_sigma(feet) == doctest::Approx(0.02).epsilon(0.05));
  for (std::size_t i = 0; i < feet.size(); i += 20) feet[i].deviation = 50;  // 5%
  CHECK(robust_sigma(feet) == doctest::Approx(0.02).epsilon(0.15));
  for (Foot& f : feet) f.face = -1;
  CHECK(robust_sigma(feet) == 0);
}

TEST_CASE("find_outliers: every planted outlier and nothing of the noise") {
  std::mt19937 random(4);
  for (const double sigma : {0.01, 0.05}) {
    std::normal_distribution<double> noise(0, sigma);
    std::vector<Foot> feet = plane_feet(side, [&](int, int) { return noise(random); });
    CHECK(find_outliers(feet, plane_diagonal, {}).empty());
    std::vector<std::uint32_t> planted;
    std::uniform_real_distribution<double> away(0.01 * plane_diagonal, 0.1 * plane_diagonal);
    for (std::uint32_t i = 0; i < feet.size(); ++i)
      if (random() % 100 == 0) {
        feet[i].deviation = (random() % 2 ? 1 : -1) * away(random);
        planted.push_back(i);
      }
    REQUIRE(planted.size() > 50);
    const bool only_planted = find_outliers(feet, plane_diagonal, {}) == planted;
    CHECK(only_planted);
  }
}

TEST_CASE("find_outliers: a dent of the part is no outlier, a point that stands apart within it is") {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.01);
  const auto dent = [&](int i, int j) { return -3 * std::exp(-(std::pow(i - 50, 2) + std::pow(j - 50, 2)) / 128.0); };
  std::vector<Foot> feet = plane_feet(side, [&](int i, int j) { return dent(i, j) + noise(random); });
  CHECK(std::count_if(feet.begin(), feet.end(), [](const Foot& f) { return std::abs(f.deviation) > 1; }) > 100);
  CHECK(find_outliers(feet, plane_diagonal, {}).empty());
  const std::uint32_t apart = 50 * side + 50;
  feet[apart].deviation = 2;
  CHECK(find_outliers(feet, plane_diagonal, {}) == std::vector<std::uint32_t>{apart});
}

TEST_CASE("find_outliers: a step of the deviation keeps both of its sides") {
  const std::vector<Foot> feet =
      plane_feet(side, [&](int i, int j) { return 1e-3 * ((7 * i + 3 * j) % 5) + (i > 70 ? 1.0 : 0.0); });
  CHECK(find_outliers(feet, plane_diagonal, {}).empty());
}

TEST_CASE("find_outliers: exact points leave a share of the diagonal") {
  std::vector<Foot> feet = plane_feet(side, [](int, int) { return 0.0; });
  feet[777].deviation = 0.9e-4 * plane_diagonal;
  feet[3333].deviation = -1.1e-4 * plane_diagonal;
  CHECK(find_outliers(feet, plane_diagonal, {}) == std::vector<std::uint32_t>{3333});
}

TEST_CASE("find_outliers: a given distance alone decides") {
  std::vector<Foot> feet = plane_feet(20, [](int i, int) { return i >= 10 ? -0.5 : 0.1; });
  const std::vector<std::uint32_t> got = find_outliers(feet, plane_diagonal, 0.4);
  CHECK(got.size() == 200);
  for (const std::uint32_t i : got) CHECK(i % 20 >= 10);
  CHECK(find_outliers(feet, plane_diagonal, 0.5).empty());
  feet[15].face = -1;
  CHECK(find_outliers(feet, plane_diagonal, 0.4).size() == 199);
}

TEST_CASE("find_outliers: points without a foot are not looked at, no points give none") {
  CHECK(find_outliers({}, 1, {}).empty());
  std::vector<Foot> feet = plane_feet(20, [](int, int) { return 0.0; });
  feet[30].face = -1;
  feet[30].deviation = 100;
  CHECK(find_outliers(feet, plane_diagonal, {}).empty());
}

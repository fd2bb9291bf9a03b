#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "meshops/search/nearest_points.hpp"

using namespace tri;

namespace {

struct Case {
  const char* name;
  std::vector<Vec3> points;
};

std::vector<Case> cases() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Case> result{{"one", {{1, 2, 3}}}, {"random", {}},           {"grid", {}},
                           {"line", {}},         {"all at one place", {}}, {"clusters", {}}};
  for (int i = 0; i < 600; ++i) {
    const double t = unit(random);
    result[1].points.emplace_back(unit(random), unit(random), unit(random));
    result[2].points.emplace_back(i % 10, i / 10 % 10, i / 100);
    result[3].points.emplace_back(1000 * t, 2000 * t, -500 * t);
    if (i < 50) result[4].points.emplace_back(4, 5, 6);
    result[5].points.push_back(Vec3(i % 3, 0, 0) + Vec3(unit(random), unit(random), unit(random)) * 1e-6);
  }
  return result;
}

std::vector<Vec3> places_for(const std::vector<Vec3>& points) {
  std::mt19937 random(9);
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) low.minimize(p), high.maximize(p);
  const double size = (high - low).norm() + 1;
  std::uniform_real_distribution<double> around(-0.5, 1.5);
  std::vector<Vec3> places{points.front(), points.back(), high + Vec3(size, size, size) * 1000};
  for (int i = 0; i < 40; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = low[k] + (high[k] - low[k]) * around(random);
    places.push_back(p);
  }
  return places;
}

}  // namespace

TEST_CASE("NearestPoints: the k nearest of an exhaustive search, nearest first, each once") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const NearestPoints tree(c.points);
    std::vector<NearestPoints::Neighbor> out(3);  // what it held is gone
    for (const Vec3& place : places_for(c.points)) {
      std::vector<double> squared;
      for (const Vec3& p : c.points) squared.push_back((p - place).sqrnorm());
      std::vector<double> sorted = squared;
      std::sort(sorted.begin(), sorted.end());
      for (const std::size_t k :
           {std::size_t{1}, std::size_t{2}, std::size_t{9}, c.points.size(), c.points.size() + 5}) {
        tree.nearest(place, k, out);
        REQUIRE(out.size() == std::min(k, c.points.size()));
        std::set<std::uint32_t> once;
        for (std::size_t i = 0; i < out.size(); ++i) {
          REQUIRE(once.insert(out[i].index).second);
          // Among equally distant points any may come: the distances are what is owed.
          REQUIRE(out[i].squared_distance == doctest::Approx(sorted[i]).epsilon(1e-12));
          REQUIRE(out[i].squared_distance == doctest::Approx(squared[out[i].index]).epsilon(1e-12));
        }
      }
    }
  }
}

TEST_CASE("NearestPoints: all points within a radius and no other") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const NearestPoints tree(c.points);
    std::vector<NearestPoints::Neighbor> out(3);
    for (const Vec3& place : places_for(c.points)) {
      std::vector<double> squared;
      for (const Vec3& p : c.points) squared.push_back((p - place).sqrnorm());
      std::vector<double> sorted = squared;
      std::sort(sorted.begin(), sorted.end());
      for (const std::size_t rank : {std::size_t{0}, c.points.size() / 3, c.points.size() - 1}) {
        const double radius = std::sqrt(sorted[rank]) * 1.000001;  // between two distances, unless they are equal
        std::set<std::uint32_t> expected, got;
        for (std::uint32_t i = 0; i < squared.size(); ++i)
          if (squared[i] < radius * radius) expected.insert(i);
        tree.within(place, radius, out);
        for (const auto& n : out) {
          REQUIRE(got.insert(n.index).second);
          REQUIRE(n.squared_distance == doctest::Approx(squared[n.index]).epsilon(1e-12));
        }
        REQUIRE(got == expected);
      }
    }
  }
}

TEST_CASE("NearestPoints: without points nothing is near; a moved tree keeps its points") {
  const std::vector<Vec3> none;
  const NearestPoints empty(none);
  std::vector<NearestPoints::Neighbor> out(3);
  empty.nearest(Vec3(0, 0, 0), 4, out);
  CHECK(out.empty());
  out.resize(3);
  empty.within(Vec3(0, 0, 0), 1e9, out);
  CHECK(out.empty());

  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {5, 0, 0}};
  NearestPoints first(points);
  const NearestPoints second(std::move(first));
  second.nearest(Vec3(4, 0, 0), 2, out);
  REQUIRE(out.size() == 2);
  CHECK(out[0].index == 2);
  CHECK(out[1].index == 1);
}

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "meshops/holes/polygon_triangulation.hpp"

namespace {

using tri::RingTriangle;
using tri::Vec3;
using Triangles = std::vector<RingTriangle>;

/// Every triangulation of the polygon i..j, by the recursion that defines them.
std::vector<Triangles> every_triangulation(int i, int j) {
  if (j - i < 2) return {{}};
  std::vector<Triangles> all;
  for (int k = i + 1; k < j; ++k)
    for (const Triangles& a : every_triangulation(i, k))
      for (const Triangles& b : every_triangulation(k, j)) {
        Triangles t = a;
        t.insert(t.end(), b.begin(), b.end());
        t.push_back({i, k, j});
        all.push_back(t);
      }
  return all;
}

double triangle_area_of(const std::vector<Vec3>& p, const RingTriangle& t) {
  return 0.5 * ((p[t[1]] - p[t[0]]) % (p[t[2]] - p[t[0]])).norm();
}

double total_area(const std::vector<Vec3>& p, const Triangles& ts) {
  double sum = 0;
  for (const auto& t : ts) sum += triangle_area_of(p, t);
  return sum;
}

/// n - 2 triangles, ring edges once each in the ring's direction, chords once in each direction.
void check_triangulates(int n, const Triangles& ts) {
  CHECK(static_cast<int>(ts.size()) == n - 2);
  std::set<std::pair<int, int>> directed;
  for (const auto& t : ts)
    for (int k = 0; k < 3; ++k) CHECK(directed.insert({t[k], t[(k + 1) % 3]}).second);
  for (int i = 0; i < n; ++i) {
    CHECK(directed.count({i, (i + 1) % n}) == 1);
    directed.erase({i, (i + 1) % n});
  }
  for (const auto& [a, b] : directed) CHECK(directed.count({b, a}) == 1);
}

std::vector<Vec3> random_ring(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(0, 1);
  std::vector<Vec3> ring(n);
  for (auto& p : ring) p = {coordinate(random), coordinate(random), coordinate(random)};
  return ring;
}

/// A star-shaped flat polygon whose radius alternates, so that every second vertex is reflex.
std::vector<Vec3> star(int n, double inner) {
  std::vector<Vec3> ring;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, radius = i % 2 ? inner : 1;
    ring.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return ring;
}

double shoelace(const std::vector<Vec3>& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3 &a = ring[i], &b = ring[(i + 1) % ring.size()];
    sum += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return sum;
}

/// Two combs of teeth that reach into each other's gaps: many reflex vertices, thin corridors.
std::vector<Vec3> comb(int teeth) {
  std::vector<Vec3> ring;
  for (int i = 0; i < teeth; ++i) {
    ring.push_back({2.0 * i, 0, 0});
    ring.push_back({2.0 * i + 1, 0, 0});
    ring.push_back({2.0 * i + 1.1, 8, 0});
    ring.push_back({2.0 * i + 1.9, 8, 0});
  }
  ring.push_back({2.0 * teeth, 0, 0});
  ring.push_back({2.0 * teeth, 9, 0});
  ring.push_back({0, 9, 0});
  return ring;
}

}  // namespace

TEST_CASE("triangulate_polygon: reaches the least area of all triangulations") {
  std::mt19937 random(1);
  for (int n = 3; n <= 9; ++n) {
    const auto all = every_triangulation(0, n - 1);
    for (int round = 0; round < 10; ++round) {
      const auto ring = random_ring(n, random);
      double least = 1e300;
      for (const auto& t : all) least = std::min(least, total_area(ring, t));
      Triangles found;
      const auto weight = tri::triangulate_polygon<double>(
          n, [](int, int) { return true; },
          [&](int i, int k, int j, int, int) -> std::optional<double> {
            return triangle_area_of(ring, {i, k, j});
          },
          found);
      REQUIRE(weight.has_value());
      check_triangulates(n, found);
      CHECK(*weight == doctest::Approx(least));
      CHECK(total_area(ring, found) == doctest::Approx(least));
    }
  }
}

TEST_CASE("triangulate_polygon: keeps forbidden chords out and reaches the least of what is left") {
  std::mt19937 random(2);
  const int n = 8;
  const auto all = every_triangulation(0, n - 1);
  int impossible = 0;
  for (int round = 0; round < 60; ++round) {
    const auto ring = random_ring(n, random);
    std::set<std::pair<int, int>> forbidden;
    for (int i = 0; i < n; ++i)
      for (int j = i + 2; j < n; ++j)
        if (!(i == 0 && j == n - 1) && random() % 100 < (round < 30 ? 30 : 65)) forbidden.insert({i, j});
    const auto allowed = [&](int i, int j) { return !forbidden.count({i, j}); };
    double least = 1e300;
    for (const auto& ts : all) {
      bool fine = true;
      for (const auto& t : ts)
        for (const auto& [a, b] : {std::pair{t[0], t[1]}, std::pair{t[1], t[2]}, std::pair{t[0], t[2]}})
          fine = fine && !forbidden.count({a, b});
      if (fine) least = std::min(least, total_area(ring, ts));
    }
    Triangles found{{7, 7, 7}};
    const auto weight = tri::triangulate_polygon<double>(
        n, allowed,
        [&](int i, int k, int j, int, int) -> std::optional<double> {
          return triangle_area_of(ring, {i, k, j});
        },
        found);
    CHECK(found[0] == RingTriangle{7, 7, 7});
    CHECK(weight.has_value() == (least < 1e300));
    impossible += !weight.has_value();
    if (weight) {
      CHECK(*weight == doctest::Approx(least));
      found.erase(found.begin());
      check_triangulates(n, found);
    } else {
      CHECK(found.size() == 1);
    }
  }
  CHECK(impossible > 0);
  CHECK(impossible < 60);
}

TEST_CASE("triangulate_polygon: the stack and the heap path agree beyond 64 vertices") {
  for (const int n : {63, 64, 65, 90}) {
    const auto ring = star(n - n % 2, 0.6);
    Triangles found;
    REQUIRE(tri::triangulate_ring(ring, {}, {}, tri::RingObjective::dihedral_area, found));
    check_triangulates(n - n % 2, found);
    CHECK(total_area(ring, found) == doctest::Approx(shoelace(ring)));
  }
}

TEST_CASE("triangulate_ring: tiles a flat concave polygon without a fold") {
  for (const auto& ring : {star(20, 0.3), comb(8)}) {
    const std::vector<Vec3> normals(ring.size(), Vec3(0, 0, 1));
    Triangles found;
    REQUIRE(tri::triangulate_ring(ring, normals, {}, tri::RingObjective::dihedral_area, found));
    check_triangulates(static_cast<int>(ring.size()), found);
    CHECK(total_area(ring, found) == doctest::Approx(shoelace(ring)));
  }
}

TEST_CASE("triangulate_ring: follows the surface around a hole, not the least area") {
  // A quadrilateral across a ridge of 30 degrees: its other diagonal makes a valley of less area. The surface beyond
  // falls away at 85 degrees: 55 degrees from the slopes of the ridge, 85 from those of the valley.
  const std::vector<Vec3> ring{{0, 0, 0.577}, {1.5, -1, 0}, {3, 0, 0.577}, {1.5, 1, 0}};
  CHECK(total_area(ring, {{0, 1, 2}, {0, 2, 3}}) > total_area(ring, {{0, 1, 3}, {1, 2, 3}}));
  const double steep = 85 * std::numbers::pi / 180;
  const Vec3 south(0, -std::sin(steep), std::cos(steep)), north(0, std::sin(steep), std::cos(steep));
  const std::vector<Vec3> normals{south, south, north, north};
  Triangles found;
  REQUIRE(tri::triangulate_ring(ring, normals, {}, tri::RingObjective::dihedral_area, found));
  bool ridge = false;
  for (const auto& t : found) {
    std::set<int> corners(t.begin(), t.end());
    ridge = ridge || corners == std::set<int>{0, 1, 2};
  }
  CHECK(ridge);
}

TEST_CASE("cut_nearest_diagonals: tiles flat polygons, convex and concave, without a fold") {
  for (const auto& ring : {star(6, 1), star(100, 1), star(40, 0.3), star(41, 0.9), comb(5), comb(60)}) {
    const std::vector<Vec3> normals(ring.size(), Vec3(0, 0, 1));
    for (const bool with_normals : {true, false}) {
      Triangles found;
      std::vector<std::int32_t> left;
      REQUIRE(tri::cut_nearest_diagonals(ring, with_normals ? normals : std::vector<Vec3>{}, {}, 2, found, left));
      CHECK(left.empty());
      check_triangulates(static_cast<int>(ring.size()), found);
      CHECK(total_area(ring, found) == doctest::Approx(shoelace(ring)));
    }
  }
}

TEST_CASE("cut_nearest_diagonals: cuts the ear with the shortest diagonal first") {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    // Convex, so that every vertex is an ear and the order is by length alone; compared with a search over all ears.
    std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
    std::set<double> angles;
    while (angles.size() < 15) angles.insert(angle(random));
    std::vector<Vec3> ring;
    for (const double a : angles) ring.push_back({std::cos(a), std::sin(a), 0});
    Triangles found;
    std::vector<std::int32_t> left;
    REQUIRE(tri::cut_nearest_diagonals(ring, {}, {}, 5, found, left));
    std::vector<int> rest(15);
    for (int i = 0; i < 15; ++i) rest[i] = i;
    for (const auto& t : found) {
      const int m = static_cast<int>(rest.size());
      int best = 0;
      const auto diagonal = [&](int i) { return (ring[rest[(i + 1) % m]] - ring[rest[(i + m - 1) % m]]).norm(); };
      for (int i = 1; i < m; ++i)
        if (diagonal(i) < diagonal(best)) best = i;
      CHECK(t[1] == rest[best]);
      rest.erase(rest.begin() + best);
    }
    CHECK(std::vector<int>(left.begin(), left.end()) == rest);
  }
}

TEST_CASE("cut_nearest_diagonals: never uses a forbidden chord, and says when none is left") {
  const auto ring = star(12, 1);
  Triangles found;
  std::vector<std::int32_t> left;
  REQUIRE(tri::cut_nearest_diagonals(
      ring, {}, [](int i, int j) { return !(i % 2 == 0 && j % 2 == 0); }, 2, found, left));
  check_triangulates(12, found);
  for (const auto& t : found)
    for (int k = 0; k < 3; ++k) {
      const int a = std::min(t[k], t[(k + 1) % 3]), b = std::max(t[k], t[(k + 1) % 3]);
      CHECK(!(a % 2 == 0 && b % 2 == 0));
    }
  found.clear();
  CHECK_FALSE(tri::cut_nearest_diagonals(
      ring, {}, [](int, int) { return false; }, 2, found, left));
  CHECK(found.empty());
}

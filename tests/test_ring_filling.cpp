#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "meshops/error.hpp"
#include "meshops/holes/awake_points.hpp"
#include "meshops/holes/ring_filling.hpp"

using namespace tri;

namespace {

constexpr HoleStrategy strategies[] = {HoleStrategy::nearest_diagonal, HoleStrategy::minimum_area_dihedral,
                                       HoleStrategy::minimum_area, HoleStrategy::least_bending};

using Triangles = std::vector<RingTriangle>;

/// Every triangulation of the polygon i, i + 1, ..., j.
std::vector<Triangles> all_triangulations(int i, int j) {
  if (j - i < 2) return {{}};
  std::vector<Triangles> result;
  for (int k = i + 1; k < j; ++k)
    for (const auto& left : all_triangulations(i, k))
      for (const auto& right : all_triangulations(k, j)) {
        Triangles t{{i, k, j}};
        t.insert(t.end(), left.begin(), left.end());
        t.insert(t.end(), right.begin(), right.end());
        result.push_back(std::move(t));
      }
  return result;
}

double area(const std::vector<Vec3>& ring, const Triangles& triangles) {
  double sum = 0;
  for (const auto& t : triangles) sum += 0.5 * ((ring[t[1]] - ring[t[0]]) % (ring[t[2]] - ring[t[0]])).norm();
  return sum;
}

/// n - 2 triangles that run with the ring, every chord twice and in both directions, every ring edge once.
void check_fills(std::size_t n, const Triangles& triangles) {
  REQUIRE(triangles.size() == n - 2);
  std::set<std::pair<int, int>> sides;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) CHECK(sides.insert({t[k], t[(k + 1) % 3]}).second);
  int rim = 0;
  const int last = static_cast<int>(n) - 1;
  for (const auto& [a, b] : sides) {
    if (b == (a == last ? 0 : a + 1))
      ++rim;
    else
      CHECK(sides.count({b, a}) == 1);
  }
  CHECK(rim == static_cast<int>(n));
}

/// A closed curve of random low waves, with noise.
std::vector<Vec3> random_loop(int n, double noise, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<std::array<double, 6>> waves;
  for (int k = 1; k <= 8; ++k) {
    auto& w = waves.emplace_back();
    for (double& x : w) x = normal(random) / (3 * k * k);
  }
  std::vector<Vec3> loop;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * i / n;
    Vec3 p(std::cos(t), std::sin(t), 0);
    for (int k = 1; k <= 8; ++k)
      for (int x = 0; x < 3; ++x)
        p[x] += waves[k - 1][x] * std::cos(k * t) + waves[k - 1][3 + x] * std::sin(k * t) + noise * normal(random);
    loop.push_back(p);
  }
  return loop;
}

}  // namespace

TEST_CASE("fill_ring: minimum-area reaches the least area of all triangulations of small rings") {
  std::mt19937 random(1);
  for (int n = 3; n <= 9; ++n) {
    const auto all = all_triangulations(0, n - 1);
    for (int round = 0; round < 20; ++round) {
      const Ring ring{random_loop(n, 0.3, random), {}, {}, {}};
      double least = 1e300;
      for (const auto& t : all) least = std::min(least, area(ring.points, t));
      Context context;
      const RingFilling filling = fill_ring(ring, HoleStrategy::minimum_area, 128, context);
      check_fills(n, filling.triangles);
      CHECK_FALSE(filling.in_pieces);
      CHECK(area(ring.points, filling.triangles) == doctest::Approx(least));
      // The other strategies cannot have less, nor has a ring that is optimised in pieces.
      for (const auto strategy : strategies) {
        const RingFilling other = fill_ring(ring, strategy, 3, context);
        check_fills(n, other.triangles);
        CHECK(area(ring.points, other.triangles) > least * (1 - 1e-12));
        CHECK(other.in_pieces == (n > 3 && strategy != HoleStrategy::nearest_diagonal));
      }
    }
  }
}

TEST_CASE("fill_ring: in pieces it comes within a tenth of the least area there is") {
  std::mt19937 random(2);
  for (int round = 0; round < 6; ++round) {
    const Ring ring{random_loop(150, 0.003, random), {}, {}, {}};
    Context context;
    const double least = area(ring.points, fill_ring(ring, HoleStrategy::minimum_area, 150, context).triangles);
    const RingFilling pieces = fill_ring(ring, HoleStrategy::minimum_area, 40, context);
    CHECK(pieces.in_pieces);
    CHECK(area(ring.points, pieces.triangles) >= least * (1 - 1e-12));
    CHECK(area(ring.points, pieces.triangles) <= least * 1.1);
  }
}

TEST_CASE("fill_ring: random loops of any length are filled, each chord between two triangles") {
  std::mt19937 random(3);
  for (const int n : {3, 4, 50, 129, 1000, 10000})
    for (const double noise : {0.0, 0.002, 0.1})
      for (const auto strategy : strategies) {
        if (n == 10000 && (noise == 0.1) != (strategy == HoleStrategy::least_bending)) continue;
        const Ring ring{random_loop(n, noise, random), {}, {}, {}};
        Context context;
        check_fills(n, fill_ring(ring, strategy, 64, context).triangles);
      }
}

TEST_CASE("fill_ring: a flat ring of many teeth is tiled without overlap") {
  for (const auto strategy : strategies)
    for (const int n : {200, 3000}) {
      Ring ring;
      double flat = 0;
      for (int i = 0; i < n; ++i) {
        const double r = i % 2 ? 1 : 0.9 + 0.05 * std::sin(7.0 * i), a = 2 * std::numbers::pi * i / n;
        ring.points.push_back({r * std::cos(a), r * std::sin(a), 0});
        ring.edge_normals.push_back({0, 0, 1});
      }
      for (int i = 0; i < n; ++i) flat += 0.5 * (ring.points[i] % ring.points[(i + 1) % n])[2];
      Context context;
      const RingFilling filling = fill_ring(ring, strategy, 128, context);
      check_fills(n, filling.triangles);
      CHECK(area(ring.points, filling.triangles) == doctest::Approx(flat));
    }
}

TEST_CASE("fill_ring: forbidden chords are kept out of long rings too") {
  std::mt19937 random(4);
  const int n = 600;
  for (const auto strategy : strategies) {
    Ring ring{random_loop(n, 0.002, random), {}, {}, {}};
    ring.chord_allowed = [](int i, int j) { return j - i != 2 || i % 3 != 0; };
    Context context;
    const RingFilling filling = fill_ring(ring, strategy, 64, context);
    check_fills(n, filling.triangles);
    for (const auto& t : filling.triangles)
      for (int k = 0; k < 3; ++k) {
        const int i = std::min(t[k], t[(k + 1) % 3]), j = std::max(t[k], t[(k + 1) % 3]);
        CHECK((j - i != 2 || i % 3 != 0));
      }
    ring.chord_allowed = [](int, int) { return false; };
    CHECK(fill_ring(ring, strategy, 64, context).triangles.empty());
  }
}

TEST_CASE("fill_ring: what is filled does not depend on place, turn and scale") {
  std::mt19937 random(5);
  const Ring ring{random_loop(400, 0.002, random), {}, {}, {}};
  // A turn about (1, 1, 1) that only permutes the axes, and a power of two: exact.
  Ring moved = ring;
  for (Vec3& p : moved.points) p = 1024.0 * Vec3(p[2], p[0], p[1]);
  for (const auto strategy : strategies) {
    Context context;
    const auto a = fill_ring(ring, strategy, 64, context).triangles,
               b = fill_ring(moved, strategy, 64, context).triangles;
    CHECK(area(moved.points, b) == doctest::Approx(1024.0 * 1024.0 * area(ring.points, a)).epsilon(1e-3));
  }
}

TEST_CASE("fill_ring: can be cancelled inside a long ring") {
  std::mt19937 random(6);
  const Ring ring{random_loop(2000, 0.002, random), {}, {}, {}};
  Context context;
  std::atomic<int> seen = 0;
  context.on_checkpoint = [&] { ++seen; };
  fill_ring(ring, HoleStrategy::least_bending, 128, context);
  REQUIRE(seen > 4);
  const int all = seen;
  for (const int stop : {1, 3, all - 1}) {
    seen = 0;
    Context stopped;
    stopped.on_checkpoint = [&] {
      if (++seen == stop) stopped.cancel();
    };
    CHECK_THROWS_AS(fill_ring(ring, HoleStrategy::least_bending, 128, stopped), Cancelled);
  }
}

TEST_CASE("AwakePoints: finds an awake point of a box whenever there is one") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const int n : {1, 7, 8, 9, 300}) {
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i) points.push_back({unit(random), unit(random), i % 5 ? unit(random) : 0.5});
    AwakePoints tree(points);
    std::vector<bool> awake(n, false);
    for (int round = 0; round < 300; ++round) {
      const int i = static_cast<int>(random() % n);
      awake[i] = random() % 2;
      tree.set(i, awake[i]);
      const Vec3 low(unit(random), unit(random), unit(random)), high = low + Vec3(0.3, 0.3, 0.3);
      const auto inside = [&](int p) {
        for (int k = 0; k < 3; ++k)
          if (points[p][k] < low[k] || points[p][k] > high[k]) return false;
        return p % 3 != 0;
      };
      bool expected = false;
      for (int p = 0; p < n; ++p) expected = expected || (awake[p] && inside(p));
      const auto found = tree.find(low, high, inside);
      CHECK((found >= 0) == expected);
      if (found >= 0) CHECK((awake[found] && inside(found)));
    }
  }
}

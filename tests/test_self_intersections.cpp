#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

using Integer = std::int64_t;
using Point = std::array<Integer, 3>;
using PointTriple = std::array<Point, 3>;
using Pair = std::array<std::uint32_t, 2>;

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Integer dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point normal(const PointTriple& t) {
  return cross(minus(t[1], t[0]), minus(t[2], t[0]));
}
bool has_area(const PointTriple& t) {
  return normal(t) != Point{0, 0, 0};
}

bool separates(const Point& axis, const PointTriple& a, const PointTriple& b) {
  Integer a_low = dot(axis, a[0]), a_high = a_low, b_low = dot(axis, b[0]), b_high = b_low;
  for (int k = 1; k < 3; ++k) {
    a_low = std::min(a_low, dot(axis, a[k])), a_high = std::max(a_high, dot(axis, a[k]));
    b_low = std::min(b_low, dot(axis, b[k])), b_high = std::max(b_high, dot(axis, b[k]));
  }
  return a_high < b_low || b_high < a_low;
}

// Two convex polytopes have no point in common exactly if an axis from this finite list separates them: the normals of
// the faces of their Minkowski difference, and, where that is flat, of its sides. Exact for coordinates below 2^12.
bool meet(const PointTriple& a, const PointTriple& b) {
  const Point na = normal(a), nb = normal(b);
  if (separates(na, a, b) || separates(nb, a, b)) return false;
  for (int i = 0; i < 3; ++i) {
    const Point ea = minus(a[(i + 1) % 3], a[i]), eb = minus(b[(i + 1) % 3], b[i]);
    if (separates(cross(na, ea), a, b) || separates(cross(nb, eb), a, b)) return false;
    for (int j = 0; j < 3; ++j)
      if (separates(cross(ea, minus(b[(j + 1) % 3], b[j])), a, b)) return false;
  }
  return true;
}

struct IntegerSoup {
  std::vector<Point> points;
  std::vector<Triangle> triangles;

  PointTriple corners(std::size_t t) const {
    return {points[triangles[t][0]], points[triangles[t][1]], points[triangles[t][2]]};
  }
  std::vector<Pair> brute_force() const {
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < triangles.size(); ++a) {
      if (!has_area(corners(a))) continue;
      for (std::uint32_t b = a + 1; b < triangles.size(); ++b) {
        const bool share = std::any_of(triangles[a].begin(), triangles[a].end(), [&](std::uint32_t v) {
          return std::find(triangles[b].begin(), triangles[b].end(), v) != triangles[b].end();
        });
        if (!share && has_area(corners(b)) && meet(corners(a), corners(b))) pairs.push_back({a, b});
      }
    }
    return pairs;
  }
  // Exact as long as scale and shift are powers of two within reach of the 53 bits.
  std::vector<Vec3> positions(double scale = 1, const Vec3& shift = Vec3(0, 0, 0)) const {
    std::vector<Vec3> result;
    for (const Point& p : points)
      result.push_back(shift +
                       Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])) * scale);
    return result;
  }
};

// Triangles without a vertex in common, at any density of coincidences: the smaller the extent, the more of them touch.
IntegerSoup random_soup(std::mt19937& random, int triangles, int extent, int depth) {
  IntegerSoup soup;
  for (int t = 0; t < triangles; ++t) {
    const auto n = static_cast<std::uint32_t>(soup.points.size());
    soup.triangles.push_back({n, n + 1, n + 2});
    for (int k = 0; k < 3; ++k)
      soup.points.push_back({static_cast<Integer>(random() % extent), static_cast<Integer>(random() % extent),
                             static_cast<Integer>(random() % depth)});
  }
  return soup;
}

std::vector<Pair> found(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, int threads = 0) {
  Context context;
  context.threads = threads;
  return self_intersections(points, triangles, context);
}

bool both_ways(const PointTriple& a, const PointTriple& b) {
  const auto place = [](const PointTriple& t) {
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k)
      p[k] = Vec3(static_cast<double>(t[k][0]), static_cast<double>(t[k][1]), static_cast<double>(t[k][2]));
    return p;
  };
  const bool result = triangles_intersect(place(a), place(b));
  CHECK(triangles_intersect(place(b), place(a)) == result);
  CHECK(meet(a, b) == result);
  return result;
}

}  // namespace

TEST_CASE("triangles_intersect: one point in common is enough, wherever it lies on the two") {
  const PointTriple flat{{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}};
  CHECK(both_ways(flat, {{{2, 2, 0}, {3, 4, 5}, {2, 5, 7}}}));         // a corner inside the other
  CHECK(both_ways(flat, {{{4, 0, 0}, {4, -3, 5}, {6, -5, 7}}}));       // a corner on an edge
  CHECK(both_ways(flat, {{{0, 0, 0}, {-4, -3, 5}, {-6, -5, 7}}}));     // a corner on a corner
  CHECK(both_ways(flat, {{{4, -1, -1}, {4, 1, 1}, {4, -9, 9}}}));      // an edge across an edge
  CHECK(both_ways(flat, {{{2, 2, -3}, {2, 3, 5}, {9, 9, 9}}}));        // through the middle
  CHECK(both_ways(flat, {{{0, 0, 0}, {8, 0, 0}, {3, 0, 7}}}));         // a whole edge
  CHECK_FALSE(both_ways(flat, {{{2, 2, 1}, {3, 4, 5}, {2, 5, 7}}}));   // one above the other
  CHECK_FALSE(both_ways(flat, {{{5, 5, -3}, {5, 5, 3}, {9, 9, 0}}}));  // past the long edge, whose plane it crosses
  CHECK(both_ways(flat, {{{4, 4, -3}, {4, 4, 3}, {9, 9, 0}}}));        // touching the long edge
}

TEST_CASE("triangles_intersect: in one plane") {
  const PointTriple flat{{{0, 0, 3}, {8, 0, 3}, {0, 8, 3}}};
  CHECK(both_ways(flat, {{{1, 1, 3}, {3, 1, 3}, {1, 3, 3}}}));    // nested
  CHECK(both_ways(flat, {{{-1, 3, 3}, {9, 3, 3}, {-1, 4, 3}}}));  // across, no corner inside either
  CHECK(both_ways(flat, {{{8, 0, 3}, {12, 0, 3}, {9, 5, 3}}}));   // corner to corner
  CHECK(both_ways(flat, {{{8, 0, 3}, {0, 8, 3}, {8, 8, 3}}}));    // edge to edge
  CHECK(both_ways(flat, flat));
  CHECK_FALSE(both_ways(flat, {{{5, 5, 3}, {9, 5, 3}, {5, 9, 3}}}));  // boxes overlap, triangles do not
  CHECK_FALSE(both_ways(flat, {{{1, 1, 4}, {3, 1, 4}, {1, 3, 4}}}));  // parallel planes
}

TEST_CASE("self_intersections: the pairs that exact arithmetic finds over all pairs") {
  std::mt19937 random(11);
  for (const auto& [extent, depth, rounds] :
       {std::array{4, 4, 60}, {4, 1, 20}, {8, 2, 40}, {30, 30, 40}, {2000, 2000, 20}}) {
    CAPTURE(extent);
    CAPTURE(depth);
    std::size_t pairs = 0;
    for (int round = 0; round < rounds; ++round) {
      const IntegerSoup soup = random_soup(random, 40, extent, depth);
      const std::vector<Pair> expected = soup.brute_force();
      pairs += expected.size();
      REQUIRE(found(soup.positions(), soup.triangles) == expected);
      // The same place far away and much smaller: nothing may be lost to rounding.
      REQUIRE(found(soup.positions(0x1p-30, Vec3(1024, -512, 2048)), soup.triangles) == expected);
    }
    CHECK(pairs > 0);
  }
}

TEST_CASE("self_intersections: triangles that share a vertex do not count") {
  std::mt19937 random(5);
  for (int round = 0; round < 40; ++round) {
    IntegerSoup soup = random_soup(random, 5, 6, 6);
    soup.triangles.clear();
    const auto n = static_cast<std::uint32_t>(soup.points.size());
    for (int t = 0; t < 60; ++t) {
      const Triangle q{static_cast<std::uint32_t>(random()) % n, static_cast<std::uint32_t>(random()) % n,
                       static_cast<std::uint32_t>(random()) % n};
      soup.triangles.push_back(q);  // some of them with a vertex twice: they have no area
    }
    REQUIRE(found(soup.positions(), soup.triangles) == soup.brute_force());
  }
  // A fan folded onto itself shares its hub.
  const std::vector<Vec3> fold{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {4, 1, 0}, {4, 3, 0}};
  CHECK(found(fold, {{0, 1, 2}, {0, 3, 4}}).empty());
}

TEST_CASE("self_intersections: no triangle, one triangle, triangles without area") {
  CHECK(found({}, {}).empty());
  const std::vector<Vec3> p{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {1, 1, 3}};
  CHECK(found(p, {{0, 1, 2}}).empty());
  CHECK(found(p, {{0, 1, 2}, {3, 4, 5}}).empty());  // a needle through the other, without area
}

TEST_CASE("self_intersections: order of triangles, their first corner and the number of threads change nothing") {
  std::mt19937 random(3);
  IntegerSoup soup = random_soup(random, 5000, 1000, 1000);
  for (std::size_t i = 0; i < soup.points.size(); i += 3)  // small triangles, a hundred of a thousand meet another
    for (std::size_t k = 1; k < 3; ++k)
      for (int c = 0; c < 3; ++c) soup.points[i + k][c] = soup.points[i][c] + static_cast<Integer>(random() % 61) - 30;
  const auto points = soup.positions();
  const std::vector<Pair> expected = found(points, soup.triangles, 1);
  CHECK(expected.size() > 100);
  CHECK(std::is_sorted(expected.begin(), expected.end()));
  CHECK(std::all_of(expected.begin(), expected.end(), [](const Pair& p) { return p[0] < p[1]; }));
  CHECK(found(points, soup.triangles, 2) == expected);
  CHECK(found(points, soup.triangles, 0) == expected);

  std::vector<std::uint32_t> order(soup.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<Triangle> shuffled;
  for (const std::uint32_t t : order) {
    Triangle q = soup.triangles[t];
    std::rotate(q.begin(), q.begin() + random() % 3, q.end());
    if (random() % 2) std::swap(q[0], q[1]);
    shuffled.push_back(q);
  }
  std::vector<Pair> mapped = found(points, shuffled);
  for (Pair& p : mapped) p = {std::min(order[p[0]], order[p[1]]), std::max(order[p[0]], order[p[1]])};
  std::sort(mapped.begin(), mapped.end());
  CHECK(mapped == expected);
}

TEST_CASE("self_intersections: a cancelled context throws") {
  std::mt19937 random(1);
  const IntegerSoup soup = random_soup(random, 30, 10, 10);
  Context context;
  context.cancel();
  CHECK_THROWS_AS(self_intersections(soup.positions(), soup.triangles, context), Cancelled);
}

#include <doctest/doctest.h>

#include <random>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/crossings/triangle_pair.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

using Corners = std::array<Vec3, 3>;

/// The same answer whichever triangle comes first and wherever its other corners begin.
void check_fans(const Corners& a, const Corners& b, bool expected) {
  const Corners c{a[0], a[2], a[1]}, d{b[0], b[2], b[1]};
  for (const Corners& x : {a, c})
    for (const Corners& y : {b, d}) {
      CHECK(fans_intersect(x, y) == expected);
      CHECK(fans_intersect(y, x) == expected);
    }
}

}  // namespace

TEST_CASE("fans_intersect: triangles with a corner in common") {
  const Corners flat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  check_fans(flat, {{{0, 0, 0}, {1, 1, 1}, {1, 1, -1}}}, true);       // through its inside
  check_fans(flat, {{{0, 0, 0}, {3, 3, 1}, {3, 3, -1}}}, true);       // reaches over its far side, which it crosses
  check_fans(flat, {{{0, 0, 0}, {-1, -1, 1}, {-1, -1, -1}}}, false);  // behind the corner
  check_fans(flat, {{{0, 0, 0}, {1, 1, 1}, {1, 1, 2}}}, false);       // above
  check_fans(flat, {{{0, 0, 0}, {1, 1, 0}, {1, 1, 2}}}, true);        // stands on it
  check_fans(flat, {{{0, 0, 0}, {2, 0, 0}, {1, -1, 2}}}, true);       // along half of a side
  check_fans(flat, {{{0, 0, 0}, {-2, 0, 0}, {-1, -1, 2}}}, false);    // along the side's other direction
  // In one plane: beside, overlapping, inside, around.
  check_fans(flat, {{{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}}}, false);
  check_fans(flat, {{{0, 0, 0}, {-1, 1, 0}, {-2, 1, 0}}}, false);
  check_fans(flat, {{{0, 0, 0}, {1, -1, 0}, {1, 1, 0}}}, true);
  check_fans(flat, {{{0, 0, 0}, {1, 1, 0}, {1, 2, 0}}}, true);
  check_fans(flat, {{{0, 0, 0}, {9, -1, 0}, {-1, 9, 0}}}, true);
}

TEST_CASE("wings_overlap: triangles with a side in common") {
  const Vec3 p(0, 0, 0), q(2, 0, 0), a(1, 1, 0);
  CHECK(wings_overlap(p, q, a, {1.5, 2, 0}));
  CHECK_FALSE(wings_overlap(p, q, a, {1.5, -2, 0}));
  CHECK_FALSE(wings_overlap(p, q, a, {1.5, 2, 5e-324}));
  CHECK(wings_overlap({0, 0, 0}, {0, 0, 2}, {1, 1, 0}, {2, 2, 7}));
}

TEST_CASE("self_intersections: with neighbours, those that meet in more than they share, and the others as before") {
  std::mt19937_64 random(11);
  std::uniform_int_distribution<int> any(0, 4);
  Soup soup;
  for (int i = 0; i < 60; ++i) soup.points.emplace_back(any(random), any(random), any(random));
  // Vertices by place, so that triangles share some.
  std::vector<Triangle> triangles;
  for (int i = 0; i < 300; ++i) {
    Triangle t;
    for (std::uint32_t& v : t) {
      v = std::uniform_int_distribution<std::uint32_t>(0, 59)(random);
      for (std::uint32_t k = 0; k < v; ++k)
        if (soup.points[k] == soup.points[v]) v = k;
    }
    const Vec3 n = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
    if (n.sqrnorm() > 0) triangles.push_back(t);
  }
  Context context;
  const auto all = self_intersections(soup.points, triangles, context, Neighbors::judge);
  std::vector<std::array<std::uint32_t, 2>> apart;
  std::size_t expected_neighbors = 0;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (std::uint32_t j = i + 1; j < triangles.size(); ++j) {
      Triangle t = triangles[i], u = triangles[j];
      // The shared corners first.
      std::size_t shared = 0;
      for (std::size_t a = shared; a < 3; ++a)
        for (std::size_t b = shared; b < 3; ++b)
          if (t[a] == u[b]) {
            std::swap(t[a], t[shared]);
            std::swap(u[b], u[shared]);
            ++shared;
            a = shared - 1;
            break;
          }
      const auto at = [&](const Triangle& x) {
        return Corners{soup.points[x[0]], soup.points[x[1]], soup.points[x[2]]};
      };
      const bool meet = shared == 0   ? triangles_intersect(at(t), at(u))
                        : shared == 1 ? fans_intersect(at(t), at(u))
                        : shared == 2
                            ? wings_overlap(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]], soup.points[u[2]])
                            : true;
      if (meet) {
        expected_neighbors += shared > 0;
        if (shared == 0) apart.push_back({i, j});
      }
    }
  }
  CHECK(self_intersections(soup.points, triangles, context) == apart);
  CHECK(all.size() == apart.size() + expected_neighbors);
  CHECK(expected_neighbors > 100);
}

TEST_CASE("segment_pierces: the two parameters of the crossing decide, on a grid with all special cases") {
  std::mt19937 random(4);
  const auto place = [&] {
    const auto one = [&] { return static_cast<double>(static_cast<int>(random() % 7) - 3); };
    const double x = one(), y = one(), z = one();
    return Vec3(x, y, z);
  };
  int pierced = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Corners t{place(), place(), place()};
    const Vec3 p = place(), q = place();
    // p + s (q - p) = t0 + u (t1 - t0) + v (t2 - t0), by Cramer's rule; the integers are small.
    const Vec3 d = p - q, e = t[1] - t[0], f = t[2] - t[0], g = p - t[0];
    const double det = d | (e % f), s = g | (e % f), u = d | (g % f), v = d | (e % g), sign = det < 0 ? -1 : 1;
    const bool expected = det != 0 && sign * s > 0 && sign * s < sign * det && sign * u > 0 && sign * v > 0 &&
                          sign * (u + v) < sign * det;
    CHECK(segment_pierces(p, q, t) == expected);
    CHECK(segment_pierces(q, p, {t[1], t[0], t[2]}) == expected);
    pierced += expected;
  }
  CHECK(pierced > 100);
}

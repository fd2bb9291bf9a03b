#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "libtri/triangulation/delaunay.hpp"
#include "meshops/error.hpp"

using tri::Delaunay;
using tri::Vec2;

namespace {

// The oracle computes on integers: coordinates below 2^28 keep the in-circle determinant below 2^126.
__extension__ using Wide = __int128;
using Lattice = std::vector<std::array<std::int64_t, 2>>;

Wide area2(const std::array<std::int64_t, 2>& a, const std::array<std::int64_t, 2>& b,
           const std::array<std::int64_t, 2>& c) {
  return Wide(b[0] - a[0]) * (c[1] - a[1]) - Wide(b[1] - a[1]) * (c[0] - a[0]);
}

bool strictly_inside(const Lattice& p, const tri::Triangle& t, std::uint32_t q) {
  Wide m[3][3];
  for (int i = 0; i < 3; ++i) {
    const Wide x = p[t[i]][0] - p[q][0], y = p[t[i]][1] - p[q][1];
    m[i][0] = x, m[i][1] = y, m[i][2] = x * x + y * y;
  }
  return m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) - m[1][2] * (m[0][0] * m[2][1] - m[0][1] * m[2][0]) +
             m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]) >
         0;
}

// Hull by monotone chain: twice its area, and how many points lie on its boundary.
struct Hull {
  Wide area2 = 0;
  std::size_t boundary = 0;
};
Hull hull_of(Lattice p) {
  std::sort(p.begin(), p.end());
  p.erase(std::unique(p.begin(), p.end()), p.end());
  if (p.size() < 2) return {};
  Lattice chain;
  for (int side = 0; side < 2; ++side) {
    const std::size_t base = chain.size();
    for (const auto& q : p) {
      while (chain.size() >= base + 2 && area2(chain[chain.size() - 2], chain.back(), q) < 0) chain.pop_back();
      chain.push_back(q);
    }
    chain.pop_back();
    std::reverse(p.begin(), p.end());
  }
  Hull hull;
  hull.boundary = chain.size();
  for (std::size_t i = 0; i < chain.size(); ++i) hull.area2 += area2(chain[0], chain[i], chain[(i + 1) % chain.size()]);
  return hull;
}

std::vector<Vec2> to_points(const Lattice& p, int exponent = 0) {
  std::vector<Vec2> points;
  for (const auto& q : p)
    points.emplace_back(std::ldexp(static_cast<double>(q[0]), exponent),
                        std::ldexp(static_cast<double>(q[1]), exponent));
  return points;
}

// Neighbours agree both ways, and number the edges without one.
std::size_t check_neighbors(const Delaunay& d) {
  std::size_t open = 0;
  REQUIRE(d.neighbors.size() == d.triangles.size());
  for (std::size_t i = 0; i < d.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t t = d.neighbors[i][k];
      if (t < 0) {
        CHECK(t == -1);
        ++open;
        continue;
      }
      const auto from = d.triangles[i][(k + 1) % 3], to = d.triangles[i][(k + 2) % 3];
      const auto& other = d.triangles[static_cast<std::size_t>(t)];
      bool found = false;
      for (int j = 0; j < 3; ++j)
        found |= other[(j + 1) % 3] == to && other[(j + 2) % 3] == from &&
                 d.neighbors[static_cast<std::size_t>(t)][j] == static_cast<std::int32_t>(i);
      REQUIRE(found);
    }
  }
  return open;
}

// All that makes a Delaunay triangulation: counter-clockwise triangles that cover the hull once, every distinct point a
// corner, no opposite corner inside a circle.
void check_delaunay(const Lattice& p, int exponent = 0) {
  tri::Context context;
  const Delaunay d = tri::delaunay(to_points(p, exponent), context);

  std::map<std::array<std::int64_t, 2>, std::uint32_t> first;
  std::vector<std::array<std::uint32_t, 2>> duplicates;
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    const auto [it, added] = first.try_emplace(p[i], i);
    if (!added) duplicates.push_back({i, it->second});
  }
  CHECK(d.duplicates == duplicates);

  const Hull hull = hull_of(p);
  if (hull.area2 == 0) {
    CHECK(d.triangles.empty());
    CHECK(d.neighbors.empty());
    return;
  }
  const std::size_t n = first.size();
  CHECK(d.triangles.size() == 2 * n - 2 - hull.boundary);
  CHECK(check_neighbors(d) == hull.boundary);
  std::set<std::uint32_t> used;
  Wide area = 0;
  for (std::size_t i = 0; i < d.triangles.size(); ++i) {
    const auto& t = d.triangles[i];
    used.insert(t.begin(), t.end());
    const Wide a = area2(p[t[0]], p[t[1]], p[t[2]]);
    REQUIRE(a > 0);
    area += a;
    for (int k = 0; k < 3; ++k) {
      if (d.neighbors[i][k] < 0) continue;
      for (const auto q : d.triangles[static_cast<std::size_t>(d.neighbors[i][k])])
        if (std::find(t.begin(), t.end(), q) == t.end()) REQUIRE_FALSE(strictly_inside(p, t, q));
    }
  }
  CHECK(area == hull.area2);
  CHECK(used.size() == n);
  for (const auto& [duplicate, kept] : duplicates) CHECK(used.count(duplicate) == 0);
}

Lattice random_lattice(std::size_t n, std::int64_t size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> any(-size, size);
  Lattice p(n);
  for (auto& q : p) q = {any(random), any(random)};
  return p;
}

Lattice grid(std::int64_t columns, std::int64_t rows, double angle, double spacing) {
  Lattice p;
  for (std::int64_t i = 0; i < columns; ++i)
    for (std::int64_t j = 0; j < rows; ++j) {
      const double x = spacing * static_cast<double>(i), y = spacing * static_cast<double>(j);
      p.push_back({std::llround(x * std::cos(angle) - y * std::sin(angle)),
                   std::llround(x * std::sin(angle) + y * std::cos(angle))});
    }
  return p;
}

using Corners = std::set<std::array<double, 6>>;
Corners corners_of(const std::vector<Vec2>& p, const Delaunay& d) {
  Corners corners;
  for (auto t : d.triangles) {
    const auto before = [&](auto a, auto b) { return std::pair(p[a][0], p[a][1]) < std::pair(p[b][0], p[b][1]); };
    std::rotate(t.begin(), std::min_element(t.begin(), t.end(), before), t.end());
    corners.insert({p[t[0]][0], p[t[0]][1], p[t[1]][0], p[t[1]][1], p[t[2]][0], p[t[2]][1]});
  }
  return corners;
}

}  // namespace

TEST_CASE("delaunay: empty circles, full cover and every point once on random points") {
  for (unsigned n = 3; n < 40; ++n)
    for (unsigned seed = 0; seed < 20; ++seed) check_delaunay(random_lattice(n, 1 << 27, 100 * n + seed));
  check_delaunay(random_lattice(20000, 1 << 27, 1));
}

TEST_CASE("delaunay: many duplicate, collinear and cocircular points in a small lattice") {
  for (unsigned n = 3; n < 60; ++n)
    for (unsigned seed = 0; seed < 20; ++seed) check_delaunay(random_lattice(n, 1 + seed % 5, 100 * n + seed));
  check_delaunay(random_lattice(5000, 20, 1));
}

TEST_CASE("delaunay: grids, straight and turned") {
  check_delaunay(grid(60, 50, 0, 1));
  check_delaunay(grid(60, 50, 0, 100003));
  check_delaunay(grid(120, 3, 0, 7));
  check_delaunay(grid(60, 50, 0.3, 100003));
  check_delaunay(grid(60, 50, std::acos(0.6), 5 * 12345));  // lands on the lattice: exactly cocircular
}

TEST_CASE("delaunay: collinear points give no triangle") {
  Lattice horizontal, vertical, diagonal;
  for (std::int64_t i = 0; i < 100; ++i) {
    horizontal.push_back({i * 37 % 101, 5});
    vertical.push_back({-3, i * 37 % 101});
    diagonal.push_back({3 * (i * 37 % 101), -7 * (i * 37 % 101)});
  }
  check_delaunay(horizontal);
  check_delaunay(vertical);
  check_delaunay(diagonal);
  diagonal.push_back({1, 1});
  check_delaunay(diagonal);
}

TEST_CASE("delaunay: many points on one circle, with and without its centre") {
  Lattice p;
  constexpr std::int64_t radius = 5 * 13 * 17 * 29 * 37;
  for (std::int64_t x = 0; x <= radius; ++x) {
    const std::int64_t yy = radius * radius - x * x;
    const auto y = static_cast<std::int64_t>(std::llround(std::sqrt(static_cast<double>(yy))));
    if (y * y != yy) continue;
    for (const int sx : {-1, 1})
      for (const int sy : {-1, 1}) p.push_back({sx * x, sy * y});
  }
  REQUIRE(p.size() > 300);
  check_delaunay(p);
  p.push_back({0, 0});
  check_delaunay(p);
}

TEST_CASE("delaunay: clusters with outliers, nested clusters, scan lines") {
  Lattice p = random_lattice(2000, 60, 3);
  p.push_back({1 << 27, 1 << 27});
  p.push_back({-(1 << 27), 5});
  check_delaunay(p);

  Lattice nested;
  for (int k = 0; k < 27; ++k)
    for (const auto& q : random_lattice(6, std::int64_t{1} << k, static_cast<unsigned>(k)))
      nested.push_back({q[0] + 12345, q[1] - 54321});
  check_delaunay(nested);

  Lattice doubling;
  for (int k = 0; k < 27; ++k) doubling.push_back({std::int64_t{1} << k, (std::int64_t{1} << k) / 3});
  check_delaunay(doubling);

  std::mt19937_64 random(5);
  Lattice scan;
  for (std::int64_t line = 0; line < 30; ++line)
    for (std::int64_t k = 0; k < 300; ++k)
      scan.push_back({10000 * k + static_cast<std::int64_t>(random() % 1000),
                      200000 * line + static_cast<std::int64_t>(random() % 100)});
  check_delaunay(scan);
}

TEST_CASE("delaunay: huge and tiny coordinates") {
  for (const int exponent : {950, 300, -300, -900, -1074}) {
    check_delaunay(random_lattice(300, 1 << 27, 7), exponent);
    check_delaunay(random_lattice(300, 4, 8), exponent);
    check_delaunay(grid(12, 12, 0.3, 100003), exponent);
  }
}

TEST_CASE("delaunay: huge and tiny coordinates in one set") {
  // A grid of side 2^-1070 around the origin within a square of side 2^1000: corners and grid joined by a fan around.
  std::vector<Vec2> p;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j) p.emplace_back(std::ldexp(i, -1070), std::ldexp(j, -1070));
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) p.emplace_back(std::ldexp(x, 1000), std::ldexp(y, 1000));
  tri::Context context;
  const Delaunay d = tri::delaunay(p, context);
  CHECK(d.duplicates.empty());
  CHECK(d.triangles.size() == 2 * p.size() - 2 - 4);
  CHECK(check_neighbors(d) == 4);
  std::size_t inner = 0;
  for (const auto& t : d.triangles) inner += t[0] < 25 && t[1] < 25 && t[2] < 25;
  CHECK(inner == 32);
  const double largest = std::numeric_limits<double>::max();
  CHECK(tri::delaunay(
            std::vector<Vec2>{{-largest, -largest}, {largest, -largest}, {largest, largest}, {-largest, largest}},
            context)
            .triangles.size() == 2);
}

TEST_CASE("delaunay: none, one and two points, and duplicates only") {
  for (std::size_t n = 0; n < 3; ++n) check_delaunay(random_lattice(n, 10, 1));
  check_delaunay(Lattice(50, {3, 4}));
  check_delaunay({{1, 2}, {3, 4}, {1, 2}, {3, 4}, {1, 2}});
  check_delaunay({{0, 0}, {1, 0}, {0, 1}});
  check_delaunay({{0, 0}, {0, 1}, {1, 0}, {0, 0}});
  CHECK_NOTHROW(check_delaunay({{0, 0}, {0, 0}, {0, 0}, {1, 0}, {0, 1}}));
}

TEST_CASE("delaunay: negative zero equals zero") {
  tri::Context context;
  const Delaunay d = tri::delaunay(std::vector<Vec2>{{0.0, 0.0}, {1, 0}, {0, 1}, {-0.0, 0.0}}, context);
  CHECK(d.triangles.size() == 1);
  CHECK(d.duplicates == std::vector<std::array<std::uint32_t, 2>>{{3, 0}});
}

TEST_CASE("delaunay: the order of the input does not matter, not even among cocircular points") {
  std::mt19937_64 random(11);
  for (const auto& lattice : {random_lattice(3000, 1 << 27, 9), grid(40, 40, 0, 3), random_lattice(400, 5, 9)}) {
    std::vector<Vec2> p = to_points(lattice);
    tri::Context context;
    const Corners before = corners_of(p, tri::delaunay(p, context));
    std::shuffle(p.begin(), p.end(), random);
    CHECK(corners_of(p, tri::delaunay(p, context)) == before);
  }
}

TEST_CASE("delaunay: the same triangles for any number of threads") {
  const std::vector<Vec2> p = to_points(random_lattice(200000, 1 << 27, 13));
  tri::Context context;
  context.threads = 1;
  const Delaunay one = tri::delaunay(p, context);
  context.threads = 2;
  const Delaunay two = tri::delaunay(p, context);
  CHECK(two.triangles == one.triangles);
  CHECK(two.neighbors == one.neighbors);
}

TEST_CASE("delaunay: refuses coordinates that are not finite") {
  tri::Context context;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_AS(tri::delaunay(std::vector<Vec2>{{0, 0}, {1, 0}, {0, bad}}, context), tri::InvalidInput);
    CHECK_THROWS_AS(tri::delaunay(std::vector<Vec2>{{bad, 0}}, context), tri::InvalidInput);
  }
}

TEST_CASE("delaunay: stops when cancelled") {
  tri::Context context;
  context.cancel();
  CHECK_THROWS_AS(tri::delaunay(to_points(random_lattice(100, 1000, 1)), context), tri::Cancelled);
}

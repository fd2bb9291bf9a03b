#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "meshops/crossings/predicates.hpp"

using tri::Vec2;
using tri::Vec3;

namespace {

// Both ways to the same answer: the exact functions, and the filtered ones that know the set.
void check_orientation(const Vec2& a, const Vec2& b, const Vec2& c, int expected) {
  const tri::PlanePredicates test(tri::bit_range(std::vector<Vec2>{a, b, c}));
  CHECK(tri::orientation_exact(a, b, c) == expected);
  CHECK(test.orientation(a, b, c) == expected);
  CHECK(test.orientation(b, c, a) == expected);
  CHECK(test.orientation(b, a, c) == -expected);
}
void check_in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, int expected) {
  const tri::PlanePredicates test(tri::bit_range(std::vector<Vec2>{a, b, c, d}));
  CHECK(tri::in_circle_exact(a, b, c, d) == expected);
  CHECK(test.in_circle(a, b, c, d) == expected);
  CHECK(test.in_circle(c, a, b, d) == expected);
}

}  // namespace

TEST_CASE("orientation: one unit in the last place off a line decides") {
  for (const double scale : {1.0, 0x1p-900, 0x1p900}) {
    const Vec2 a(0.1 * scale, 0.1 * scale), b(0.7 * scale, 0.7 * scale);
    for (const double t : {0.2, 0.3, 1e-20, 5e7}) {
      const double x = t * scale;
      check_orientation(a, b, {x, x}, 0);
      check_orientation(a, b, {x, std::nextafter(x, 2 * x)}, 1);
      check_orientation(a, b, {x, std::nextafter(x, 0)}, -1);
    }
  }
}

TEST_CASE("orientation: coordinates of very different size") {
  check_orientation({0, 0}, {1, 0}, {0.5, 5e-324}, 1);
  check_orientation({0, 0}, {1e300, 0}, {0.5, -5e-324}, -1);
  check_orientation({0, 0}, {1e300, 1e-300}, {1, 0}, -1);
  check_orientation({5e-324, 5e-324}, {1e-323, 1e-323}, {1.7e308, 1.7e308}, 0);
}

TEST_CASE("in_circle: the smallest step off a circle through lattice points decides") {
  // (3,4), (5,0), (-4,3), (0,-5) and their kind lie on a circle exactly; radial steps of one bit leave it.
  const Vec2 on[] = {{3, 4}, {-4, 3}, {-5, 0}, {-3, -4}, {0, -5}, {4, -3}, {5, 0}};
  for (const double scale : {1.0, 0x1p-40, 0x1p200, 0x1p-300, 0x1p-1060, 0x1p1000}) {
    for (int i = 3; i < 7; ++i) {
      const Vec2 a = on[0] * scale, b = on[1] * scale, c = on[2] * scale, d = on[i] * scale;
      check_in_circle(a, b, c, d, 0);
      const int k = std::fabs(d[0]) > std::fabs(d[1]) ? 0 : 1;
      Vec2 inside = d, outside = d;
      inside[k] = std::nextafter(d[k], 0.0);
      outside[k] = std::nextafter(d[k], 2 * d[k]);
      check_in_circle(a, b, c, inside, 1);
      check_in_circle(a, b, c, outside, -1);
    }
  }
}

TEST_CASE("in_circle: coordinates of very different size") {
  check_in_circle({1, 0}, {0, 1}, {-1, 0}, {0, -1}, 0);
  check_in_circle({1, 0}, {0, 1}, {-1, 0}, {1e-200, -1}, -1);
  check_in_circle({1, 0}, {0, 1}, {-1, 0}, {5e-324, -1}, -1);
  check_in_circle({1, 5e-324}, {0, 1}, {-1, 0}, {0, -1}, 1);  // farther out by the square of a hair: the circle grows
  check_in_circle({1e308, 0}, {0, 1e308}, {-1e308, 0}, {5e-324, 5e-324}, 1);
}

TEST_CASE("in_circle: the corners of any axis-parallel rectangle are cocircular, whatever their rounding") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-1000, 1000);
  for (int i = 0; i < 200; ++i) {
    const double x0 = any(random), x1 = x0 + std::fabs(any(random)) * std::pow(10, -(i % 12)), y0 = any(random),
                 y1 = y0 + std::fabs(any(random));
    check_in_circle({x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, 0);
    check_in_circle({x0, y0}, {x1, y0}, {x1, y1}, {x0, std::nextafter(y1, y0)}, 1);
  }
}

TEST_CASE("predicates: filtered and exact answers agree on nearly degenerate quadruples") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> turn(0, 6.28);
  for (int i = 0; i < 5000; ++i) {
    const Vec2 center(std::ldexp(turn(random), i % 30), turn(random));
    std::vector<Vec2> p;
    for (int k = 0; k < 4; ++k) {
      const double t = turn(random);
      p.emplace_back(center[0] + std::cos(t), center[1] + std::sin(t));
    }
    const tri::PlanePredicates test(tri::bit_range(p));
    CHECK(test.orientation(p[0], p[1], p[2]) == tri::orientation_exact(p[0], p[1], p[2]));
    CHECK(test.in_circle(p[0], p[1], p[2], p[3]) == tri::in_circle_exact(p[0], p[1], p[2], p[3]));
  }
}

TEST_CASE("bit_range: says which bits a set uses") {
  const auto range = tri::bit_range(std::vector<Vec2>{{0, -6}, {0.75, 1}});
  CHECK(range.lowest == -2);
  CHECK(range.top == 2);
  CHECK(range.safe());
  CHECK_FALSE(tri::bit_range(std::vector<Vec2>{{5e-324, 1}}).safe());
  CHECK_FALSE(tri::bit_range(std::vector<Vec2>{{1e300, 1}}).safe());
  CHECK(tri::bit_range({}).safe());
}

TEST_CASE("orientation in space: one unit in the last place off a plane decides, at any scale") {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> any(-1000, 1000);
  for (const double scale : {1.0, 0x1p-300, 0x1p300, 0x1p-1060}) {
    for (int i = 0; i < 300; ++i) {
      // On the plane z = x + y, whose points have coordinates without rounding.
      const auto place = [&] {
        const double x = any(random), y = any(random);
        return Vec3(x, y, x + y) * scale;
      };
      const Vec3 a = place(), b = place(), c = place(), d = place();
      CHECK(tri::orientation_exact(a, b, c, d) == 0);
      const double turn =
          (b[0] - a[0]) / scale * ((c[1] - a[1]) / scale) - (b[1] - a[1]) / scale * ((c[0] - a[0]) / scale);
      const int up = turn > 0 ? 1 : turn < 0 ? -1 : 0;
      Vec3 lower = d, higher = d;
      lower[2] = std::nextafter(d[2], -std::numeric_limits<double>::infinity());
      higher[2] = std::nextafter(d[2], std::numeric_limits<double>::infinity());
      CHECK(tri::orientation_exact(a, b, c, lower) == up);
      CHECK(tri::orientation_exact(a, b, c, higher) == -up);
      CHECK(tri::orientation_exact(b, a, c, lower) == -up);
      CHECK(tri::orientation_exact(a, c, lower, b) == up);  // two swaps of the first order
    }
  }
}

TEST_CASE("collinear: one unit in the last place decides") {
  const Vec3 a(0.5, 0.25, 3), b(2.5, 1.25, 15);  // b = 5 a
  const Vec3 c(1, 0.5, 6);
  CHECK(tri::collinear_exact(a, b, c));
  CHECK(tri::collinear_exact(a, a, c));
  for (int k = 0; k < 3; ++k) {
    Vec3 off = c;
    off[k] = std::nextafter(off[k], 100.0);
    CHECK_FALSE(tri::collinear_exact(a, b, off));
    CHECK_FALSE(tri::collinear_exact(off, a, b));
  }
}

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "meshops/search/closest_on_triangle.hpp"

using namespace tri;

namespace {

// The least distance by descent over barycentric coordinates: the nearest of a grid, which is then refined around it.
double by_grid(const std::array<Vec3, 3>& t, const Vec3& x) {
  double best = std::numeric_limits<double>::infinity(), u0 = 0, v0 = 0, step = 1.0 / 32;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  for (int round = 0; round < 12; ++round) {
    for (double u = u_low; u <= u_high + 1e-15; u += step)
      for (double v = v_low; v <= v_high + 1e-15; v += step) {
        if (u < 0 || v < 0 || u + v > 1 + 1e-15) continue;
        const double d = (t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v - x).norm();
        if (d < best) best = d, u0 = u, v0 = v;
      }
    u_low = u0 - 4 * step, u_high = u0 + 4 * step, v_low = v0 - 4 * step, v_high = v0 + 4 * step;
    step /= 4;
  }
  return best;
}

}  // namespace

TEST_CASE("closest_on_triangle: as near as a search over the triangle finds, from all around") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  const auto point = [&] { return Vec3(place(random), place(random), place(random)); };
  for (int i = 0; i < 300; ++i) {
    const std::array<Vec3, 3> t{point(), point(), point()};
    const Vec3 x = point() * 2, foot = closest_on_triangle(t, x);
    CHECK((foot - x).norm() == doctest::Approx(by_grid(t, x)).epsilon(1e-5));
  }
}

TEST_CASE("closest_on_triangle: of a needle, a segment and a point it finds the nearest point too") {
  const Vec3 x(0.3, 1, 0);
  for (const double width : {0.0, 1e-300, 1e-18, 1e-12, 1e-8})
    CHECK((closest_on_triangle({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0, width)}, x) - Vec3(0.3, 0, 0)).norm() <=
          1e-7);
  CHECK(closest_on_triangle({Vec3(2, 0, 0), Vec3(2, 0, 0), Vec3(2, 0, 0)}, x) == Vec3(2, 0, 0));
  CHECK(closest_on_segment(Vec3(1, 1, 1), Vec3(1, 1, 1), x) == Vec3(1, 1, 1));
  CHECK(closest_on_segment(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(7, 3, 0)) == Vec3(1, 0, 0));
}

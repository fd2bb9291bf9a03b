#include <doctest/doctest.h>

#include <random>

#include "meshops/checks/shells.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("find_shells: volume, area and closedness of boxes with closed forms") {
  Soup soup = joined(joined(box({0, 0, 0}, {1, 2, 3}), turned_around(cube({5, 5, 5}, 2))), sheet(2, 2));
  soup.triangles.push_back({0, 0, 1});
  Context context;
  const Shells s = find_shells(soup, context);
  REQUIRE(s.shells.size() == 3);
  CHECK(s.shells[0].closed);
  CHECK(s.shells[0].volume == doctest::Approx(6));
  CHECK(s.shells[0].area == doctest::Approx(22));
  CHECK(s.shells[1].volume == doctest::Approx(-8));
  CHECK_FALSE(s.shells[2].closed);
  CHECK(s.shells[2].volume == 0);
  CHECK(s.shells[2].area == doctest::Approx(4));
  CHECK(s.of_triangle.back() == Shells::none);
  CHECK(s.one_sided.empty());
}

TEST_CASE("find_depths: how many shells are around one, and how often they wind round it") {
  const Soup soup = joined(joined(cube({0, 0, 0}, 9), turned_around(cube({1, 1, 1}, 7))),
                           joined(cube({2, 2, 2}, 4), turned_around(cube({3, 3, 3}, 1))));
  Context context;
  Shells s = find_shells(soup, context);
  find_depths(soup, s, context);
  REQUIRE(s.shells.size() == 4);
  for (int i = 0; i < 4; ++i) {
    CHECK(s.shells[i].depth == i);
    CHECK(s.shells[i].winding == i % 2);
    CHECK_FALSE(is_inside_out(s.shells[i]));
  }
}

TEST_CASE("InsideTest: points of a fine grid against a box, faces, edges and corners included") {
  const Soup soup = joined(box({0, 0, 0}, {2, 2, 2}), cube({8, 8, 8}));
  std::vector<std::uint32_t> listed;
  for (std::uint32_t i = 0; i < 12; ++i) listed.push_back(i);
  const InsideTest test(soup, listed);
  // Lines through edges, vertices and diagonals of the faces all occur.
  for (int x = -1; x <= 5; ++x)
    for (int y = -1; y <= 5; ++y)
      for (int z = -1; z <= 5; ++z) {
        const Vec3 p(x * 0.5, y * 0.5, z * 0.5);
        const int low = std::min({x, y, z}), high = std::max({x, y, z});
        const auto expected = low < 0 || high > 4     ? InsideTest::Where::outside
                              : low == 0 || high == 4 ? InsideTest::Where::on
                                                      : InsideTest::Where::inside;
        CHECK(test.locate(p) == expected);
      }
}

TEST_CASE("InsideTest: random points against a sphere's planes") {
  const Soup soup = sphere(9, 6);
  std::vector<std::uint32_t> listed;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) listed.push_back(i);
  const InsideTest test(soup, listed);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-1.1, 1.1);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p(any(random), any(random), any(random));
    bool inside = true;  // the polyhedron is convex
    double nearest = 1;
    for (const Triangle& t : soup.triangles) {
      const Vec3 n = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
      const double side = (p - soup.points[t[0]]) | n.normalized();
      inside &= side < 0;
      nearest = std::min(nearest, std::abs(side));
    }
    if (nearest < 1e-9) continue;  // quadrilaterals of the sphere are flat only to rounding
    CHECK(test.locate(p) == (inside ? InsideTest::Where::inside : InsideTest::Where::outside));
  }
}

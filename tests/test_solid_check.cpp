#include <doctest/doctest.h>

#include "meshops/crossings/solid_check.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("is_clean_solid: a cube is, a cube without a triangle, inside out or with a triangle turned is not") {
  Context context;
  const Soup good = cube();
  CHECK(is_clean_solid(good, false, context));
  CHECK_FALSE(is_clean_solid(Soup{}, false, context));
  CHECK_FALSE(is_clean_solid(turned_around(good), false, context));
  Soup open = good;
  open.triangles.pop_back();
  CHECK_FALSE(is_clean_solid(open, false, context));
  Soup flipped = good;
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  CHECK_FALSE(is_clean_solid(flipped, false, context));
}

TEST_CASE("is_clean_solid: a cavity is part of a solid, a cube through another is not") {
  Context context;
  CHECK(is_clean_solid(joined(cube(Vec3(0, 0, 0), 3), turned_around(cube(Vec3(1, 1, 1), 1))), false, context));
  CHECK(is_clean_solid(joined(cube(Vec3(0, 0, 0), 3), cube(Vec3(1, 1, 1), 1)), false, context));
  CHECK_FALSE(is_clean_solid(joined(cube(), cube(Vec3(0.5, 0.4, 0.3))), false, context));
}

TEST_CASE("is_clean_solid: a solid within a cavity or within a solid is, one inside out in a cavity is not") {
  Context context;
  const Soup hollow = joined(cube({0, 0, 0}, 9), turned_around(cube({1, 1, 1}, 7)));
  CHECK(is_clean_solid(joined(hollow, cube({2, 2, 2}, 1)), true, context));
  CHECK(is_clean_solid(joined(cube({0, 0, 0}, 9), cube({2, 2, 2}, 1)), true, context));
  CHECK_FALSE(is_clean_solid(joined(hollow, turned_around(cube({2, 2, 2}, 1))), true, context));
}

TEST_CASE("is_clean_solid: cubes that touch in a corner are apart with indices and not without") {
  Context context;
  const Soup two = joined(cube(), cube(Vec3(1, 1, 1)));
  CHECK(is_clean_solid(two, false, context));
  CHECK_FALSE(is_clean_solid(two, true, context));
  CHECK(touching_vertices(two).size() == 1);
  CHECK(is_clean_solid(joined(cube(), cube(Vec3(2, 2, 2))), true, context));
}

TEST_CASE("surface_contacts: names triangles without area and pairs that meet") {
  Context context;
  const std::vector<Vec3> points{Vec3(0, 0, 0),      Vec3(2, 0, 0),     Vec3(0, 2, 0),
                                 Vec3(0.5, 0.5, -1), Vec3(0.5, 0.5, 1), Vec3(0.6, 0.7, 1),
                                 Vec3(0.1, 0.2, 9),  Vec3(0.2, 0.4, 9), Vec3(0.3, 0.6, 9)};
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 6}};
  const SurfaceContacts contacts = surface_contacts(points, triangles, context);
  CHECK(contacts.flat == std::vector<std::uint32_t>{2});
  REQUIRE(contacts.crossing.size() == 1);
  CHECK(contacts.crossing[0] == std::array<std::uint32_t, 2>{0, 1});
}

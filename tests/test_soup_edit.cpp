#include <doctest/doctest.h>

#include "meshops/error.hpp"
#include "meshops/soup_edit.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("soup edits: a triangle cut from another gets its group, and corner values by place") {
  Soup soup = with_attributes(sheet(1, 1));
  const std::uint32_t middle = add_point_between(soup, 0, 3, 0.25);
  CHECK(soup.points[middle] == Vec3(0.25, 0.25, 0));
  CHECK(soup.vertex_scalars.at("x")[middle] == 0.25);
  CHECK(soup.vertex_colors[middle][0] == 1);  // a quarter from 0 to 3, rounded
  CHECK(soup.vertex_normals[middle] == Vec3(0, 0, 1));
  add_triangle_in(soup, {0, 1, middle}, 0);
  CHECK(soup.face_scalars.at("id")[2] == 0);
  CHECK(soup.corner_scalars.at("x")[6] == 0);
  CHECK(soup.corner_scalars.at("x")[7] == 1);
  CHECK(soup.corner_scalars.at("x")[8] == doctest::Approx(0.25));
  CHECK_NOTHROW(check_soup(soup));
  reverse_triangle(soup, 2);
  CHECK(soup.triangles[2] == Triangle{0, middle, 1});
  CHECK(soup.corner_scalars.at("x")[7] == doctest::Approx(0.25));
  CHECK(soup.corner_scalars.at("x")[8] == 1);
}

TEST_CASE("soup edits: points renumbered keep the attributes of the first of each number") {
  Soup soup = with_attributes(sheet(1, 1));
  const std::uint32_t copy = copy_point(soup, 2);
  CHECK(copy == 4);
  const std::vector<std::uint32_t> number{1, 0, 2, 0, dropped_point};
  renumber_points(soup, number, 3);
  CHECK(soup.points == std::vector<Vec3>{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  CHECK(soup.vertex_scalars.at("x") == std::vector<double>{1, 0, 0});
  CHECK(soup.vertex_colors[0][0] == 1);
  CHECK(soup.triangles[0] == Triangle{1, 0, 0});
  keep_triangles(soup, {0, 1});
  CHECK(soup.face_scalars.at("id") == std::vector<double>{1});
  CHECK(soup.corner_scalars.at("x").size() == 3);
  CHECK_NOTHROW(check_soup(soup));
}

TEST_CASE("soup edits: check_soup names what does not fit") {
  Soup soup = with_attributes(sheet(1, 1));
  soup.face_scalars["id"].push_back(1);
  CHECK_THROWS_AS(check_soup(soup), InvalidInput);
  soup = sheet(1, 1);
  soup.triangles[1][2] = 4;
  CHECK_THROWS_AS(check_soup(soup), InvalidInput);
}

// Vertices in one place move apart: checked by comparing every place and every pair of triangles.

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "meshops/crossings/part_touching.hpp"
#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/single_precision.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// The names of places, and how many vertices there are beyond one in each.
std::size_t vertices_too_many(const Soup& soup, std::vector<std::uint32_t>& name) {
  std::map<std::array<double, 3>, std::uint32_t> places;
  for (const Vec3& p : soup.points)
    name.push_back(places.emplace(std::array{p[0], p[1], p[2]}, static_cast<std::uint32_t>(name.size())).first->second);
  return soup.points.size() - places.size();
}

std::size_t touching(const Soup& soup) {
  std::vector<std::uint32_t> name;
  return vertices_too_many(soup, name);
}

/// Pairs of triangles that meet in more than what they share by place.
std::size_t pairs_that_meet(const Soup& soup) {
  std::vector<std::uint32_t> name;
  vertices_too_many(soup, name);
  std::size_t count = 0;
  const auto names = [&](const Triangle& t) { return Triangle{name[t[0]], name[t[1]], name[t[2]]}; };
  const auto places = [&](const Triangle& t) {
    return std::array{soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]};
  };
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (std::size_t j = i + 1; j < soup.triangles.size(); ++j)
      count += triangles_meet(names(soup.triangles[i]), places(soup.triangles[i]), names(soup.triangles[j]),
                              places(soup.triangles[j]));
  return count;
}

/// Prisms of three sides round an axis, which touch in it.
Soup wedges(int count) {
  Soup soup;
  for (int i = 0; i < count; ++i) {
    const double from = 2 * std::numbers::pi * i / count, to = from + std::numbers::pi / count;
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    for (const double z : {0.0, 1.0})
      for (const Vec3& p :
           {Vec3(0, 0, z), Vec3(std::cos(from), std::sin(from), z), Vec3(std::cos(to), std::sin(to), z)})
        soup.points.push_back(rounded_to_floats(p + Vec3(3, 5, 7)));
    for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{3, 4, 5}, Triangle{0, 1, 4}, Triangle{0, 4, 3},
                              Triangle{1, 2, 5}, Triangle{1, 5, 4}, Triangle{2, 0, 3}, Triangle{2, 3, 5}})
      soup.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return soup;
}

}  // namespace

TEST_CASE("part_touching_vertices: solids that touch in corners and edges come apart, by no more than they may") {
  Context context;
  std::vector<Soup> cases{joined(cube(Vec3(1, 1, 1)), cube(Vec3(2, 2, 2))),
                          joined(cube(Vec3(1, 1, 1)), cube(Vec3(2, 2, 1))), wedges(2), wedges(5), wedges(9)};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    CAPTURE(i);
    Soup soup = cases[i];
    const std::size_t before = touching(soup);
    REQUIRE(before > 0);
    REQUIRE(pairs_that_meet(soup) == 0);
    Report report;
    const std::size_t moved = part_touching_vertices(soup, 0.001, report, context);
    CHECK(moved == before);
    CHECK(report.vertices_moved == moved);
    CHECK(touching(soup) == 0);
    CHECK(pairs_that_meet(soup) == 0);
    CHECK(soup.triangles == cases[i].triangles);
    std::size_t elsewhere = 0;
    for (std::size_t v = 0; v < soup.points.size(); ++v) {
      const double way = (soup.points[v] - cases[i].points[v]).norm();
      CHECK(way <= 0.001);
      elsewhere += way > 0;
      CHECK(rounded_to_floats(soup.points[v]) == soup.points[v]);
    }
    CHECK(elsewhere == moved);
    CHECK(soup_volume(soup) == doctest::Approx(soup_volume(cases[i])).epsilon(0.01));
  }
}

TEST_CASE("part_touching_vertices: where nothing may move, and where nothing touches, all stays") {
  Context context;
  for (Soup soup : {wedges(5), sphere(9, 5)}) {
    const Soup before = soup;
    Report report;
    CHECK(part_touching_vertices(soup, touching(soup) > 0 ? 1e-9 : 0.01, report, context) == 0);
    CHECK(same_soup(soup, before));
    CHECK(report.unchanged());
  }
}

TEST_CASE("part_touching_vertices: a vertex that would cross something goes where it does not") {
  Context context;
  // A needle from the cube's corner lies where the corner would go first: into the cube.
  Soup soup = cube(Vec3(0, 0, 0), 1);
  Soup needle;
  needle.points = {Vec3(0, 0, 0), Vec3(-0.5, -0.0625, 0), Vec3(-0.5, 0.0625, 0), Vec3(-0.5, 0, 0.0625)};
  needle.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  soup = joined(soup, needle);
  REQUIRE(touching(soup) == 1);
  REQUIRE(pairs_that_meet(soup) == 0);
  Report report;
  CHECK(part_touching_vertices(soup, 0.001, report, context) == 1);
  CHECK(touching(soup) == 0);
  CHECK(pairs_that_meet(soup) == 0);
}

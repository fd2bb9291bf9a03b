#include <doctest/doctest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "meshops/checks/mesh_check.hpp"
#include "meshops/error.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

MeshCheck check(const Soup& soup) {
  Context context;
  return check_mesh(soup, {}, context);
}

std::map<std::string, std::uint64_t> defects(const MeshCheck& c) {
  std::map<std::string, std::uint64_t> result;
  for (const auto& [name, count] : c.defects(true)) result[name] = count;
  return result;
}
using Defects = std::map<std::string, std::uint64_t>;

}  // namespace

TEST_CASE("check_mesh: a sphere is a solid without a defect") {
  const MeshCheck c = check(sphere(12, 7));
  CHECK(defects(c).empty());
  CHECK(c.watertight);
  CHECK(c.kind == SurfaceKind::solid);
  REQUIRE(c.components.size() == 1);
  CHECK(c.components[0].closed);
  CHECK(c.components[0].volume == doctest::Approx(soup_volume(sphere(12, 7))));
  CHECK(c.components[0].area == doctest::Approx(soup_area(sphere(12, 7))));
}

TEST_CASE("check_mesh: nothing, and points alone, are no surface") {
  CHECK(check({}).kind == SurfaceKind::none);
  Soup points;
  points.points = {{0, 0, 0}};
  CHECK(check(points).kind == SurfaceKind::none);
  CHECK(defects(check(points)) == Defects{{"unreferenced vertices", 1}});
}

TEST_CASE("check_mesh: a missing triangle is a loop of three vertices") {
  Soup soup = sphere(8, 5);
  const Triangle gone = soup.triangles[20];
  soup.triangles.erase(soup.triangles.begin() + 20);
  const MeshCheck c = check(soup);
  CHECK(defects(c) == Defects{{"boundary loops", 1}});
  CHECK(c.defects(false).empty());
  CHECK(c.kind == SurfaceKind::open_surface);
  REQUIRE(c.places.boundary_loops.size() == 1);
  Triangle loop{};
  std::ranges::copy(c.places.boundary_loops[0], loop.begin());
  std::ranges::sort(loop);
  Triangle sorted = gone;
  std::ranges::sort(sorted);
  CHECK(loop == sorted);
}

TEST_CASE(
    "check_mesh: holes that touch in a vertex are one loop, which follows the fans there; also where triangles disagree") {
  Soup soup = sheet(4, 4);
  std::erase_if(soup.triangles, [&](const Triangle& t) {
    const Vec3 m = (soup.points[t[0]] + soup.points[t[1]] + soup.points[t[2]]) / 3;
    return (m[0] > 1 && m[0] < 2 && m[1] > 1 && m[1] < 2) || (m[0] > 2 && m[0] < 3 && m[1] > 2 && m[1] < 3);
  });
  for (const bool turned : {false, true}) {
    if (turned) std::swap(soup.triangles[5][0], soup.triangles[5][1]);
    const MeshCheck c = check(soup);
    CHECK(c.summary.boundary_loops == 2);
    std::multiset<std::size_t> sizes;
    for (const auto& loop : c.places.boundary_loops) sizes.insert(loop.size());
    CHECK(sizes == std::multiset<std::size_t>{8, 16});
    CHECK(c.places.nonmanifold_vertices.size() == 1);
  }
}

TEST_CASE("check_mesh: every planted defect is found, counted and placed") {
  const Soup good = sphere(10, 5);
  const auto n = static_cast<std::uint32_t>(good.points.size());
  const auto last = static_cast<std::uint32_t>(good.triangles.size());
  SUBCASE("turned triangle") {
    Soup soup = good;
    std::swap(soup.triangles[7][0], soup.triangles[7][1]);
    CHECK(defects(check(soup)) == Defects{{"edges whose triangles run the same way", 3}});
  }
  SUBCASE("inside out, by itself and within a cavity") {
    CHECK(defects(check(turned_around(good))) == Defects{{"shells inside out", 1}});
    const Soup hollow = joined(cube({0, 0, 0}, 9), turned_around(cube({1, 1, 1}, 7)));
    CHECK(check(hollow).kind == SurfaceKind::solid);
    const MeshCheck c = check(joined(hollow, turned_around(cube({2, 2, 2}, 1))));
    CHECK(defects(c) == Defects{{"shells inside out", 1}});
    CHECK(c.inside_out == std::vector<std::uint32_t>{24});
    CHECK(c.kind == SurfaceKind::watertight);
    CHECK(check(joined(hollow, turned_around(cube({20, 2, 2}, 1)))).inside_out.size() == 1);
  }
  SUBCASE("shells within shells that are right") {
    // A solid in the cavity of another, with a cavity of its own.
    const Soup hollow = joined(cube({0, 0, 0}, 9), turned_around(cube({1, 1, 1}, 7)));
    Soup nested = joined(joined(hollow, cube({2, 2, 2}, 4)), turned_around(cube({3, 3, 3}, 1)));
    for (const Soup& soup : {nested, joined(cube({0, 0, 0}, 4), cube({6, 0, 0}, 4))}) {
      const MeshCheck c = check(soup);
      CHECK(defects(c).empty());
      CHECK(c.nested_solids.empty());
      CHECK(c.kind == SurfaceKind::solid);
    }
    // A solid in the material of another, and a cavity in that one, are listed but nothing wrong.
    const MeshCheck two =
        check(joined(joined(cube({0, 0, 0}, 9), cube({1, 1, 1}, 7)), turned_around(cube({2, 2, 2}, 1))));
    CHECK(defects(two).empty());
    CHECK(two.nested_solids == std::vector<std::uint32_t>{12});
    CHECK(two.kind == SurfaceKind::solid);
  }
  SUBCASE("fin") {
    Soup soup = good;
    soup.points.push_back(good.points[good.triangles[9][0]] * 2);
    soup.triangles.push_back({good.triangles[9][0], good.triangles[9][1], n});
    const MeshCheck c = check(soup);
    CHECK(c.summary.nonmanifold_edges == 1);
    CHECK(c.places.nonmanifold_edges[0] == std::array{std::min(good.triangles[9][0], good.triangles[9][1]),
                                                      std::max(good.triangles[9][0], good.triangles[9][1])});
    CHECK(c.self_intersections.empty());
  }
  SUBCASE("duplicates, one turned") {
    Soup soup = good;
    soup.triangles.push_back({good.triangles[3][1], good.triangles[3][2], good.triangles[3][0]});
    soup.triangles.push_back({good.triangles[4][1], good.triangles[4][0], good.triangles[4][2]});
    const MeshCheck c = check(soup);
    CHECK(c.places.duplicate_triangles == std::vector<std::uint32_t>{last, last + 1});
    CHECK(c.opposite_duplicates == 1);
    CHECK(c.self_intersections == std::vector<std::array<std::uint32_t, 2>>{{3, last}, {4, last + 1}});
  }
  SUBCASE("degenerate and needle") {
    Soup soup = sheet(1, 1);
    soup.points.insert(soup.points.end(), {{5, 0, 0}, {6, 1, 0}, {9, 4, 0}, {5, 5, 0}, {6, 5, 0}, {5.5, 5.0005, 0}});
    soup.triangles.push_back({4, 5, 6});
    soup.triangles.push_back({7, 8, 9});
    soup.triangles.push_back({4, 4, 5});
    const MeshCheck c = check(soup);
    CHECK(c.degenerate == std::vector<std::uint32_t>{2, 4});
    CHECK(c.needles == std::vector<std::uint32_t>{3});
  }
  SUBCASE("unwelded seam") {
    const MeshCheck c = check(exploded(good));
    CHECK(c.open_seams == 3 * good.triangles.size() / 2);
    CHECK(c.coincident_vertices.size() == 3 * good.triangles.size() - n);
    CHECK(c.self_intersections.empty());
    // Solids that touch have coincident vertices and nothing wrong.
    CHECK(defects(check(joined(cube(), cube({1, 1, 1})))).empty());
  }
  SUBCASE("T-junction") {
    Soup soup = joined(sheet(2, 1), sheet(1, 1));
    for (std::size_t i = 6; i < 10; ++i) soup.points[i] = Vec3(2 * soup.points[i][0], soup.points[i][1] - 1, 0);
    const MeshCheck c = check(soup);
    REQUIRE(c.t_junctions.size() == 1);
    CHECK(c.t_junctions[0].vertex == 1);
    CHECK(c.t_junctions[0].share == doctest::Approx(0.5));
  }
  SUBCASE("self-intersection") {
    // A needle-thin tetrahedron through both sides of the sphere.
    Soup spear;
    spear.points = {{0.01, 0.02, -2}, {0.02, 0.01, 2}, {0.03, 0.01, 2}, {0.02, 0.03, 2}};
    spear.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
    const MeshCheck c = check(joined(good, spear));
    CHECK(c.self_intersections.size() >= 6);
    for (const auto& pair : c.self_intersections) CHECK((pair[0] < last && pair[1] >= last));
    CHECK(c.kind == SurfaceKind::solid);
  }
}

TEST_CASE("check_mesh: as JSON, with lists cut where asked") {
  const MeshCheck c = check(exploded(sheet(2, 2)));
  const auto json = to_json(c, 3);
  CHECK(json["counts"]["boundary_loops"] == 8);
  CHECK(json["places"]["boundary_loops"].size() == 3);
  CHECK(json["places"]["boundary_loops_more"] == 5);
  CHECK(json["components"].size() == 3);
  CHECK(json["verdict"] == "open surface");
}

TEST_CASE("check_mesh: an inconsistent soup is refused") {
  Soup soup = cube();
  soup.triangles[0][0] = 99;
  Context context;
  CHECK_THROWS_AS(check_mesh(soup, {}, context), InvalidInput);
}

#include <doctest/doctest.h>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/checks/shells.hpp"
#include "meshops/operators/split_non_manifold.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_split(Soup& soup) {
  Context context;
  return split_non_manifold(soup, {}, context);
}

/// Every vertex at a place becomes the first one there.
Soup touching(Soup soup) {
  for (Triangle& t : soup.triangles)
    for (std::uint32_t& v : t)
      for (std::uint32_t i = 0; i < v; ++i)
        if (soup.points[i] == soup.points[v]) v = i;
  return soup;
}

/// Volumes of the closed shells.
std::vector<double> volumes(const Soup& soup) {
  Context context;
  std::vector<double> result;
  for (const Shell& s : find_shells(soup, context).shells)
    if (s.closed) result.push_back(s.volume);
  return result;
}

}  // namespace

TEST_CASE("split_non_manifold: solids that touch in an edge or a corner come apart as solids") {
  for (const Vec3& place : {Vec3(1, 1, 0), Vec3(1, 1, 1)}) {
    Soup soup = touching(joined(cube(), cube(place)));
    REQUIRE_FALSE(summarize(soup).manifold);
    const Report report = run_split(soup);
    const MeshSummary s = summarize(soup);
    CHECK(s.manifold);
    CHECK(s.closed);
    CHECK(s.oriented);
    CHECK(s.components == 2);
    REQUIRE(volumes(soup).size() == 2);
    for (const double v : volumes(soup)) CHECK(v == doctest::Approx(1));
    CHECK(report.vertices_added == (place[2] == 0 ? 2 : 1));
    CHECK(report.faces_reversed == 0);
  }
}

TEST_CASE("split_non_manifold: a fin comes off, inside or outside, either way round, and the solid stays closed") {
  for (const double side : {-1.0, 1.0}) {
    for (const bool turned : {false, true}) {
      // A ring of vertices around a box at half its height; the fin stands on one of its edges.
      Soup soup = touching(joined(box({0, 0, 0}, {2, 2, 1}), box({0, 0, 1}, {2, 2, 2})));
      std::erase_if(soup.triangles, [&](const Triangle& t) {
        return soup.points[t[0]][2] == 1 && soup.points[t[1]][2] == 1 && soup.points[t[2]][2] == 1;
      });
      REQUIRE(summarize(soup).closed);
      const auto at = [&](const Vec3& p) {
        return static_cast<std::uint32_t>(std::ranges::find(soup.points, p) - soup.points.begin());
      };
      const std::uint32_t a = at({0, 0, 1}), b = at({2, 0, 1}), c = static_cast<std::uint32_t>(soup.points.size());
      soup.points.emplace_back(1, -side, 1);
      soup.triangles.push_back(turned ? Triangle{a, b, c} : Triangle{b, a, c});
      REQUIRE(summarize(soup).nonmanifold_edges == 1);
      run_split(soup);
      const MeshSummary s = summarize(soup);
      CHECK(s.manifold);
      CHECK(s.components == 2);
      CHECK(s.boundary_edges == 3);
      REQUIRE(volumes(soup).size() == 1);
      CHECK(volumes(soup)[0] == doctest::Approx(8));
    }
  }
}

TEST_CASE("split_non_manifold: crossing sheets do not cross any more, and none is left out, however they are turned") {
  // Four half planes at one edge, each turned or not.
  for (int mask = 0; mask < 16; ++mask) {
    Soup soup;
    soup.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {0, 1, 0.5}, {-1, 0, 0.5}, {0, -1, 0.5}};
    for (std::uint32_t i = 0; i < 4; ++i)
      soup.triangles.push_back((mask >> i & 1) != 0 ? Triangle{0, 1, 2 + i} : Triangle{1, 0, 2 + i});
    run_split(soup);
    const MeshSummary s = summarize(soup);
    CAPTURE(mask);
    CHECK(s.manifold);
    CHECK(s.oriented);
    CHECK(s.components == 2);
    // Half planes beside each other belong together, not those across.
    for (std::size_t i = 0; i < 2; ++i)
      for (const std::uint32_t v : {0u, 1u}) {
        const bool with_opposite =
            std::ranges::count(soup.triangles[i], v) == std::ranges::count(soup.triangles[i + 2], v) &&
            std::ranges::count(soup.triangles[i], v) == 1;
        CHECK_FALSE(with_opposite);
      }
  }
}

TEST_CASE("split_non_manifold: three sheets at an edge: the smoothest two stay together") {
  Soup soup;
  soup.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {-1, 0.1, 0.5}, {0, 1, 0.5}};
  soup.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  run_split(soup);
  const MeshSummary s = summarize(soup);
  CHECK(s.manifold);
  CHECK(s.oriented);
  CHECK(s.components == 2);
  CHECK(soup.triangles[0][0] == soup.triangles[1][0]);
}

TEST_CASE("split_non_manifold: nothing moves, and copies have the attributes of their vertex") {
  Soup soup = with_attributes(touching(joined(cube(), cube({1, 1, 0}))));
  const Soup before = soup;
  run_split(soup);
  REQUIRE(soup.triangles.size() == before.triangles.size());
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(soup.points[soup.triangles[i][k]] == before.points[before.triangles[i][k]]);
  for (std::size_t v = before.points.size(); v < soup.points.size(); ++v) {
    const auto source =
        static_cast<std::size_t>(std::ranges::find(before.points, soup.points[v]) - before.points.begin());
    CHECK(soup.vertex_colors[v] == before.vertex_colors[source]);
  }
  CHECK(soup.corner_scalars == before.corner_scalars);
}

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/operators/weld.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_weld(Soup& soup, const WeldOptions& options = {}) {
  Context context;
  return weld(soup, options, context);
}

Soup jittered(Soup soup, double size) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-size / 2, size / 2);
  for (Vec3& p : soup.points) p += Vec3(any(random), any(random), any(random)) / 2;
  return soup;
}

}  // namespace

TEST_CASE("weld: loose triangles become the mesh they were taken from") {
  const Soup original = sphere(12, 7);
  Soup soup = exploded(original);
  const Report report = run_weld(soup);
  CHECK(soup.points.size() == original.points.size());
  CHECK(soup.triangles.size() == original.triangles.size());
  const MeshSummary s = summarize(soup);
  CHECK(s.closed);
  CHECK(s.manifold);
  CHECK(s.oriented);
  CHECK(report.vertices_removed == 3 * original.triangles.size() - original.points.size());
  CHECK(report.figures.at("edges joined") == s.edges);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(soup.points[soup.triangles[i][k]] == original.points[original.triangles[i][k]]);
}

TEST_CASE("weld: 0 and -0 are the same place") {
  Soup soup = exploded(cube());
  for (std::size_t i = 0; i < soup.points.size(); i += 2)
    for (int k = 0; k < 3; ++k)
      if (soup.points[i][k] == 0) soup.points[i][k] = -0.0;
  run_weld(soup);
  CHECK(soup.points.size() == 8);
}

TEST_CASE("weld: solids that touch in an edge or a corner stay apart, unless everything is asked for") {
  for (const Vec3& place : {Vec3(1, 1, 0), Vec3(1, 1, 1)}) {
    const Soup two = joined(cube(), cube(place));
    Soup soup = two;
    const Report report = run_weld(soup);
    CHECK(report.unchanged());
    CHECK(report.skipped.size() == 1);
    CHECK(same_soup(soup, two));
    run_weld(soup, {.touching = true});
    CHECK(soup.points.size() == (place[2] == 0 ? 14 : 15));
    CHECK_FALSE(summarize(soup).manifold);
  }
}

TEST_CASE("weld: a sheet is not welded to the finished edges of a solid") {
  // The edge of the sheet lies on an edge of the cube, which has its two triangles.
  Soup soup = joined(cube(), sheet(1, 1));
  for (std::size_t i = 8; i < 12; ++i) soup.points[i] += Vec3(1, 0, 0);
  CHECK(run_weld(soup).unchanged());
  CHECK(summarize(soup).nonmanifold_edges == 0);
}

TEST_CASE("weld: within the tolerance seams close, and nothing else happens") {
  const Soup original = sphere(16, 9);
  Soup soup = jittered(exploded(original), 1e-4);
  Soup exact = soup;
  CHECK(run_weld(exact).unchanged());
  const Report report = run_weld(soup, {.tolerance = 1e-3});
  const MeshSummary s = summarize(soup);
  CHECK(s.closed);
  CHECK(s.manifold);
  CHECK(soup.points.size() == original.points.size());
  CHECK(soup.triangles.size() == original.triangles.size());
  CHECK(report.faces_removed == 0);
  for (const Vec3& p : soup.points)
    CHECK(std::ranges::any_of(original.points, [&](const Vec3& q) { return (p - q).norm() < 1e-4; }));
}

TEST_CASE("weld: no set of vertices is wider than the tolerance, whatever chain they form") {
  // Separate triangles along a line, each a little farther: every neighbour is within the tolerance.
  Soup soup;
  for (int i = 0; i < 200; ++i) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    const double x = 0.01 * i;
    soup.points.insert(soup.points.end(), {{x, 0, 0}, {x, 1, 0}, {x + 0.5, 0.5, i % 2 == 0 ? 1.0 : -1.0}});
    if (i % 2 == 0)
      soup.triangles.push_back({first, first + 1, first + 2});
    else
      soup.triangles.push_back({first + 1, first, first + 2});
  }
  const Soup before = soup;
  run_weld(soup, {.tolerance = 0.015});
  CHECK(soup.points.size() < before.points.size());
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK((soup.points[soup.triangles[i][k]] - before.points[before.triangles[i][k]]).norm() <= 0.015);
}

TEST_CASE("weld: a tolerance larger than the triangles collapses none, turns none over, and makes no edge of three") {
  for (const double tolerance : {0.3, 1.0, 3.0}) {
    Soup soup = exploded(sheet(6, 6));
    run_weld(soup);  // one sheet
    Soup two = joined(soup, soup);
    for (std::size_t i = soup.points.size(); i < two.points.size(); ++i) two.points[i] += Vec3(6.1, 0.05, 0);
    const std::size_t triangles = two.triangles.size();
    run_weld(two, {.tolerance = tolerance});
    const MeshSummary s = summarize(two);
    CHECK(two.triangles.size() == triangles);
    CHECK(s.nonmanifold_edges == 0);
    CHECK(s.repeated_corners == 0);
    CHECK(s.nonmanifold_vertices == 0);
    for (const Triangle& t : two.triangles)
      CHECK(((two.points[t[1]] - two.points[t[0]]) % (two.points[t[2]] - two.points[t[0]]))[2] > 0);
  }
}

TEST_CASE("weld: the two sides of a thin closed wall are not welded to one another") {
  Soup soup = box({0, 0, 0}, {1, 1, 0.01});
  CHECK(run_weld(soup, {.tolerance = 0.05}).unchanged());
}

TEST_CASE("weld: three loose sheets at one edge are joined exactly, and stay apart within a tolerance") {
  Soup soup;
  for (int i = 0; i < 3; ++i) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    const double a = 2 * std::numbers::pi * i / 3;
    soup.points.insert(soup.points.end(), {{0, 0, 0}, {0, 0, 1}, {std::cos(a), std::sin(a), 0}});
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  Soup near = jittered(soup, 1e-3);
  const Report exact = run_weld(soup);
  CHECK(soup.points.size() == 5);
  CHECK(exact.figures.at("edges of three or more triangles made") == 1);
  run_weld(near, {.tolerance = 0.01});
  CHECK(near.points.size() == 9);
}

TEST_CASE("weld: a loose triangle without extent goes, one that holds a surface together stays") {
  Soup soup = exploded(cube());
  soup.points.insert(soup.points.end(), {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  soup.triangles.push_back({36, 37, 38});
  const Report report = run_weld(soup);
  CHECK(report.faces_removed == 1);
  CHECK(summarize(soup).closed);
  CHECK(soup.points.size() == 8);
}

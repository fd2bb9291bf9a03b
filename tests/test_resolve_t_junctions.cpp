#include <doctest/doctest.h>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/joining/t_junctions.hpp"
#include "meshops/operators/resolve_t_junctions.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_resolve(Soup& soup, const ResolveTJunctionsOptions& options = {}) {
  Context context;
  return resolve_t_junctions(soup, options, context);
}

/// A fine strip above y = 0 and a coarse one below; they share the vertices that coincide.
Soup strips(int fine, int coarse) {
  Soup soup = sheet(fine, 1), below = sheet(coarse, 1);
  for (Vec3& p : soup.points) p[0] /= fine;
  for (Vec3& p : below.points) p = Vec3(p[0] / coarse, p[1] - 1, 0);
  return joined(soup, below);
}

}  // namespace

TEST_CASE("resolve_t_junctions: strips of different fineness are joined along their whole length") {
  for (const auto& [fine, coarse] : {std::pair{8, 1}, {8, 2}, {6, 4}, {7, 3}}) {
    Soup soup = with_attributes(strips(fine, coarse));
    const double area = soup_area(soup);
    const Report report = run_resolve(soup);
    const MeshSummary s = summarize(soup);
    CAPTURE(fine);
    CAPTURE(coarse);
    CHECK(s.components == 1);
    CHECK(s.boundary_loops == 1);
    CHECK(s.manifold);
    CHECK(s.oriented);
    CHECK(s.area == doctest::Approx(area));
    CHECK(s.zero_area == 0);
    Context context;
    CHECK(find_t_junctions(soup, 1e-6, context).empty());
    for (std::size_t i = 0; i < soup.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(soup.corner_scalars.at("x")[3 * i + k] == doctest::Approx(soup.points[soup.triangles[i][k]][0]));
    CHECK(run_resolve(soup).unchanged());
  }
}

TEST_CASE("resolve_t_junctions: a triangle with vertices on all three sides is cut once") {
  Soup soup;
  soup.points = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  soup.triangles = {{0, 1, 2}};
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), {a, b, c});
    soup.triangles.push_back({first, first + 1, first + 2});
  };
  add({1, 0, 0}, {0, 0, 0}, {0.5, -1, 0});
  add({3, 0, 0}, {1, 0, 0}, {2, -1, 0});
  add({0, 4, 0}, {2, 2, 0}, {3, 3, 0});
  add({0, 0, 0}, {0, 2, 0}, {-1, 1, 0});
  const Report report = run_resolve(soup);
  CHECK(report.figures.at("T-junctions") == 4);
  CHECK(report.figures.at("edges split") == 3);
  CHECK(report.faces_added == 4);
  CHECK(summarize(soup).components == 1);
  CHECK(soup_area(soup) == doctest::Approx(8 + 0.5 + 1 + 2 + 1));
  CHECK(summarize(soup).zero_area == 0);
}

TEST_CASE("resolve_t_junctions: near counts up to the tolerance, exactly on it always") {
  Soup soup = strips(2, 1);
  soup.points[1][1] = 1e-3;  // the middle vertex of the fine strip
  Soup near = soup;
  CHECK(run_resolve(soup, {.tolerance = 1e-4}).unchanged());
  CHECK(run_resolve(near, {.tolerance = 1e-2}).figures.at("T-junctions") == 1);
  CHECK(summarize(near).components == 1);
  Soup exact = strips(2, 1);
  CHECK(run_resolve(exact, {.tolerance = 0, .relative_tolerance = 0}).figures.at("T-junctions") == 1);
}

TEST_CASE("resolve_t_junctions: inner edges and vertices are left alone, however near") {
  // A closed box with a sheet that ends on one of its edges' middle.
  Soup soup = joined(cube({0, 0, 0}, 2), sheet(1, 1));
  for (std::size_t i = 8; i < 12; ++i) soup.points[i] += Vec3(2, 0.5, 0);
  CHECK(run_resolve(soup).unchanged());
}

TEST_CASE("resolve_t_junctions: a split that would turn a triangle over is left out") {
  Soup soup;
  soup.points = {{0, 0, 0}, {4, 0, 0}, {2, 0.01, 0}, {2, 0.03, 0}, {0, 2, 0}, {4, 2, 0}};
  soup.triangles = {{0, 1, 2}, {3, 5, 4}};
  const Report report = run_resolve(soup, {.tolerance = 0.1});
  CHECK(report.skipped.at("triangle would turn over") == 1);
  CHECK(report.unchanged());
}

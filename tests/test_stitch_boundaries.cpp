#include <doctest/doctest.h>

#include <random>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/operators/stitch_boundaries.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_stitch(Soup& soup, double tolerance = 0) {
  Context context;
  return stitch_boundaries(soup, {.tolerance = tolerance}, context);
}

/// A sheet of 2n x n cells as two square ones with a gap between them.
Soup halves(int n, double gap) {
  const Soup half = sheet(n, n);
  Soup soup = joined(half, half);
  for (std::size_t i = half.points.size(); i < soup.points.size(); ++i) soup.points[i] += Vec3(n + gap, 0, 0);
  return soup;
}

}  // namespace

TEST_CASE("stitch_boundaries: coincident edges are joined exactly, and nothing else") {
  Soup soup = with_attributes(halves(4, 0));
  const std::vector<Vec3> points = soup.points;
  const Report report = run_stitch(soup);
  const MeshSummary s = summarize(soup);
  CHECK(s.components == 1);
  CHECK(s.boundary_loops == 1);
  CHECK(s.manifold);
  CHECK(report.vertices_removed == 5);
  CHECK(report.vertices_moved == 0);
  CHECK(report.figures.at("edges joined") == 4);
}

TEST_CASE("stitch_boundaries: a gap closes in the middle, up to the tolerance") {
  Soup open = halves(4, 0.1), closed = with_attributes(open);
  CHECK(run_stitch(open, 0.09).unchanged());
  const Report report = run_stitch(closed, 0.11);
  CHECK(summarize(closed).components == 1);
  CHECK(report.vertices_removed == 5);
  CHECK(report.vertices_moved == 5);
  CHECK(report.figures.at("edges joined across a gap") == 4);
  int middle = 0;
  for (std::size_t i = 0; i < closed.points.size(); ++i) {
    if (std::abs(closed.points[i][0] - 4.05) > 1e-12) continue;
    ++middle;
    CHECK(closed.vertex_scalars.at("x")[i] == doctest::Approx(4.05));
  }
  CHECK(middle == 5);
}

TEST_CASE("stitch_boundaries: a ragged crack in a closed surface heals") {
  const Soup original = sphere(24, 13);
  // Two halves, their rims displaced at random.
  Soup lower, upper;
  lower.points = upper.points = original.points;
  for (const Triangle& t : original.triangles) {
    double z = 0;
    for (const std::uint32_t v : t) z += original.points[v][2];
    (z < 0 ? lower : upper).triangles.push_back(t);
  }
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> any(-0.01, 0.01);
  for (Vec3& p : upper.points) p += Vec3(any(random), any(random), any(random));
  Soup soup = joined(lower, upper);
  REQUIRE(summarize(soup).boundary_loops == 2);
  run_stitch(soup, 0.05);
  const MeshSummary s = summarize(soup);
  CHECK(s.closed);
  CHECK(s.manifold);
  CHECK(s.oriented);
  CHECK(s.components == 1);
}

TEST_CASE("stitch_boundaries: edges whose triangles run the same way, or sheets face to face, stay apart") {
  Soup soup = halves(3, 0);
  for (std::size_t i = soup.triangles.size() / 2; i < soup.triangles.size(); ++i)
    std::swap(soup.triangles[i][0], soup.triangles[i][1]);
  Soup before = soup;
  const Report report = run_stitch(soup);
  CHECK(same_soup(soup, before));
  CHECK(report.skipped.size() == 1);
}

TEST_CASE("stitch_boundaries: a tolerance beyond all lengths turns nothing over and crowds no edge") {
  for (const double tolerance : {1.0, 3.0, 30.0}) {
    Soup soup = halves(5, 0.3);
    run_stitch(soup, tolerance);
    const MeshSummary s = summarize(soup);
    CHECK(s.triangles == 100);
    CHECK(s.nonmanifold_edges == 0);
    CHECK(s.nonmanifold_vertices == 0);
    CHECK(s.repeated_corners == 0);
    for (const Triangle& t : soup.triangles)
      CHECK(((soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]))[2] > 0);
  }
}

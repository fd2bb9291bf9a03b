#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "libtri/example_parts.hpp"
#include "libtri/model/tessellation.hpp"
#include "libtri/triangulation/bridges.hpp"
#include "libtri/triangulation/patches.hpp"
#include "libtri/triangulation/shell/connect.hpp"
#include "link_check.hpp"
#include "measured_part.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

constexpr double noise = 0.01, tolerance = 3 * noise;

test::MeasuredPart sparse(const char* part, std::uint64_t points, SamplingPattern pattern = SamplingPattern::random) {
  MeasurementOptions options;
  options.points = points;
  options.pattern = pattern;
  options.noise = noise;
  options.seed = 3;
  return test::measured_part(example_part(part), options);
}

PointMesh by_patches(const test::MeasuredPart& part) {
  Context context;
  return connect_by_patches(part.model, part.feet, part.measurement.points, {}, context).mesh;
}

// What the header promises of `Bridges`, triangle by triangle.
Bridges counted(const test::MeasuredPart& part, const Registration& registration, const PointMesh& mesh) {
  Bridges bridges;
  std::vector<Vec3> middles, normals;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = part.feet[t[0]].point, &b = part.feet[t[1]].point, &c = part.feet[t[2]].point;
    middles.push_back((a + b + c) / 3.0);
    normals.push_back((b - a) % (c - a));
  }
  Context context;
  const std::vector<Foot> places = registration.register_points(middles, context);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& m = places[t].normal;
    const double length = normals[t].norm();
    bridges.total_area += 0.5 * length;
    if ((normals[t] | Vec3(m[0], m[1], m[2])) >= 0.5 * length || std::abs(places[t].deviation) <= tolerance) continue;
    ++bridges.triangles;
    bridges.area += 0.5 * length;
  }
  return bridges;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> boundary(const PointMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbors[t][k] < 0) edges.emplace(mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]);
  return edges;
}

}  // namespace

TEST_CASE("lessen_bridges: less of a sparse thin part bridges, and topology, points and boundary keep") {
  struct Case {
    const char* part;
    std::uint64_t points;
    SamplingPattern pattern;
  };
  for (const Case& c : {Case{"bracket", 2000, SamplingPattern::random}, Case{"bracket", 4000, SamplingPattern::scan},
                        Case{"blade", 2000, SamplingPattern::scan}, Case{"housing", 2000, SamplingPattern::random}}) {
    CAPTURE(c.part);
    CAPTURE(c.points);
    const test::MeasuredPart part = sparse(c.part, c.points, c.pattern);
    const Registration registration(part.model);
    const auto& points = part.measurement.points;
    const PointMesh before = by_patches(part);
    PointMesh mesh = before;
    Context context;
    const Bridges left = lessen_bridges(points, part.feet, registration, tolerance, mesh, context);

    const Bridges had = counted(part, registration, before), has = counted(part, registration, mesh);
    CHECK(has.area < 0.6 * had.area);
    CHECK(left.total_area == doctest::Approx(had.total_area).epsilon(1e-9));
    // Triangles that agree with the normals at their corners are taken as right unseen: a flat lid on a hole. Where two
    // places are equally near, rounding chooses.
    CHECK(std::abs(has.area - left.area) < 0.2 * had.area);
    CHECK(static_cast<double>(left.triangles) < 1.05 * static_cast<double>(has.triangles) + 2);

    const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
    const test::LinkedTriangles was = test::check_links(before.triangles, before.neighbors);
    CHECK_LINKS(linked);
    CHECK(linked.double_edges.empty());
    CHECK(linked.components == was.components);
    CHECK(linked.loops == was.loops);
    CHECK(linked.euler == was.euler);
    CHECK(linked.vertices == was.vertices);
    CHECK(boundary(mesh) == boundary(before));
    CHECK(self_intersections(points, mesh.triangles, context).size() <=
          self_intersections(points, before.triangles, context).size());
  }
}

TEST_CASE("lessen_bridges: a mesh without bridges is returned as it was") {
  const test::MeasuredPart part = sparse("boot-lid", 3000);
  const Registration registration(part.model);
  PointMesh mesh = by_patches(part);
  Context context;
  // A distance that only the far side of the part is away.
  const PointMesh before = mesh;
  const Bridges bridges = lessen_bridges(part.measurement.points, part.feet, registration, 100, mesh, context);
  CHECK(bridges.triangles == 0);
  CHECK(bridges.area == 0);
  CHECK(mesh.triangles == before.triangles);
  CHECK(mesh.neighbors == before.neighbors);
  PointMesh empty;
  CHECK(lessen_bridges(part.measurement.points, part.feet, registration, 0, empty, context).share() == 0);
}

TEST_CASE("lessen_bridges: the result does not depend on the number of threads") {
  const test::MeasuredPart part = sparse("bracket", 2000);
  const Registration registration(part.model);
  const PointMesh before = by_patches(part);
  std::vector<std::vector<Triangle>> results;
  for (int threads : {1, 3}) {
    Context context;
    context.threads = threads;
    PointMesh mesh = before;
    lessen_bridges(part.measurement.points, part.feet, registration, tolerance, mesh, context);
    results.push_back(mesh.triangles);
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] != before.triangles);
}

TEST_CASE("lessen_bridges: cancelled, the mesh is as it was") {
  const test::MeasuredPart part = sparse("bracket", 2000);
  const Registration registration(part.model);
  const PointMesh before = by_patches(part);
  int checkpoints = 0;
  const auto run = [&](PointMesh& mesh, int stop) {
    Context context;
    context.threads = 1;
    checkpoints = 0;
    context.on_checkpoint = [&] {
      if (++checkpoints == stop) context.cancel();
    };
    lessen_bridges(part.measurement.points, part.feet, registration, tolerance, mesh, context);
  };
  PointMesh mesh = before;
  run(mesh, -1);
  const int all = checkpoints;
  REQUIRE(all > 3);
  for (int stop = 1; stop <= all; stop += std::max(1, all / 10)) {
    CAPTURE(stop);
    mesh = before;
    CHECK_THROWS_AS(run(mesh, stop), Cancelled);
    CHECK(mesh.triangles == before.triangles);
    CHECK(mesh.neighbors == before.neighbors);
  }
}

TEST_CASE("mend_crossings: fewer triangles cross, and topology, points and boundary keep") {
  const test::MeasuredPart part = sparse("housing", 3000, SamplingPattern::scan);
  const Registration registration(part.model);
  const auto& points = part.measurement.points;
  Context context;
  const Tessellation tessellation = tessellate(part.model, 1e-3 * part.model.diagonal, 0.35, context);
  const PointMesh before = connect_by_shell(part.model, tessellation, part.feet, context).mesh;
  const auto crossings = self_intersections(points, before.triangles, context);
  REQUIRE(crossings.size() >= 5);
  PointMesh mesh = before;
  CHECK(mend_crossings(points, part.feet, registration, tolerance, crossings, mesh, context));
  CHECK(self_intersections(points, mesh.triangles, context).size() < 0.7 * static_cast<double>(crossings.size()));
  const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
  const test::LinkedTriangles was = test::check_links(before.triangles, before.neighbors);
  CHECK_LINKS(linked);
  CHECK(linked.double_edges.empty());
  CHECK(linked.euler == was.euler);
  CHECK(linked.vertices == was.vertices);
  CHECK(boundary(mesh) == boundary(before));
  PointMesh same = before;
  CHECK_FALSE(mend_crossings(points, part.feet, registration, tolerance, {}, same, context));
  CHECK(same.triangles == before.triangles);
}

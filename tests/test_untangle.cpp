#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "libtri/example_parts.hpp"
#include "libtri/model/tessellation.hpp"
#include "libtri/triangulation/shell/connect.hpp"
#include "libtri/triangulation/untangle.hpp"
#include "link_check.hpp"
#include "measured_part.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

/// A measured part whose triangulation crosses itself, as the points are few and noisy.
struct Tangled {
  test::MeasuredPart part;
  PointMesh mesh;

  Tangled() {
    MeasurementOptions options;
    options.points = 3000;
    options.pattern = SamplingPattern::scan;
    options.noise = 0.03;
    options.seed = 3;
    part = test::measured_part(example_part("housing"), options);
    Context context;
    const Tessellation tessellation = tessellate(part.model, 1e-3 * part.model.diagonal, 0.35, context);
    mesh = connect_by_shell(part.model, tessellation, part.feet, context).mesh;
  }
  const std::vector<Vec3>& points() const { return part.measurement.points; }
};

/// That it is a mesh over the same points with the same topology.
void check_kept(const PointMesh& mesh, const PointMesh& before) {
  REQUIRE(mesh.triangles.size() == before.triangles.size());
  REQUIRE(mesh.neighbors.size() == before.neighbors.size());
  const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
  const test::LinkedTriangles was = test::check_links(before.triangles, before.neighbors);
  CHECK_LINKS(linked);
  CHECK(linked.components == was.components);
  CHECK(linked.loops == was.loops);
  CHECK(linked.euler == was.euler);
  CHECK(linked.vertices == was.vertices);
}

}  // namespace

TEST_CASE("untangle: fewer triangles cross, it says which still do, and topology and points keep") {
  const Tangled tangled;
  const Context context;
  const auto before = self_intersections(tangled.points(), tangled.mesh.triangles, context);
  REQUIRE(before.size() >= 5);
  PointMesh mesh = tangled.mesh;
  const auto left = untangle(tangled.points(), tangled.part.feet, mesh, context);
  CHECK(left.size() < before.size());
  CHECK(left == self_intersections(tangled.points(), mesh.triangles, context));
  check_kept(mesh, tangled.mesh);
}

TEST_CASE("untangle: cancelled at any checkpoint, the mesh is whole") {
  const Tangled tangled;
  int checkpoints = 0;
  {
    Context counting;
    counting.threads = 1;
    counting.on_checkpoint = [&] { ++checkpoints; };
    PointMesh mesh = tangled.mesh;
    untangle(tangled.points(), tangled.part.feet, mesh, counting);
  }
  REQUIRE(checkpoints > 3);
  for (int stop = 1; stop <= checkpoints; stop += std::max(1, checkpoints / 20)) {
    CAPTURE(stop);
    Context context;
    context.threads = 1;
    int reached = 0;
    context.on_checkpoint = [&] {
      if (++reached == stop) context.cancel();
    };
    PointMesh mesh = tangled.mesh;
    CHECK_THROWS_AS(untangle(tangled.points(), tangled.part.feet, mesh, context), Cancelled);
    check_kept(mesh, tangled.mesh);
  }
}

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <random>

#include "meshops/error.hpp"
#include "meshops/operators/fair.hpp"
#include "meshops/operators/fill_holes.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

constexpr Continuity continuities[] = {Continuity::position, Continuity::tangent, Continuity::curvature};
constexpr Fairness fairnesses[] = {Fairness::position, Fairness::tangent, Fairness::curvature};
constexpr FairingWeights all_weights[] = {FairingWeights::cotangent, FairingWeights::uniform};

/// An icosahedron whose faces were split in four `levels` times, on the unit sphere.
Mesh ball(int levels) {
  Mesh coarse = icosahedron();
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (const auto v : coarse.vertices()) points.push_back(coarse.point(v).normalized());
  for (const auto f : coarse.faces()) {
    std::array<int, 3> t;
    int k = 0;
    for (const auto v : coarse.fv_range(f)) t[k++] = v.idx();
    triangles.push_back(t);
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
      const auto [it, fresh] = middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(points.size()));
      if (fresh) points.push_back((points[a] + points[b]).normalized());
      return it->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) finer.push_back(t);
    }
    triangles = finer;
  }
  return make_mesh(points, triangles);
}

/// Deletes the faces whose middle is in the way; vertices left alone go too.
void cut(Mesh& mesh, const std::function<bool(const Vec3&)>& away) {
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) {
    const FaceHandle f(static_cast<int>(i));
    if (away(mesh.calc_face_centroid(f))) mesh.delete_face(f, true);
  }
}

/// A sheet with a round hole, in the plane through the origin with the given normal.
Mesh holed_plane(const Vec3& normal) {
  const Vec3 u = (normal % Vec3(0.3, 0.5, 0.7)).normalized(), v = normal.normalized() % u;
  PatchShape s;
  s.nu = s.nv = 20;
  s.point = [=](int i, int j) {
    return (i - 10 + 0.3 * std::sin(i + 2 * j)) * u + (j - 10 + 0.3 * std::cos(3 * i)) * v;
  };
  s.keep = [](int i, int j) { return std::hypot(i - 9.5, j - 9.5) > 5; };
  return s.mesh();
}

void select(Mesh& mesh, const std::function<bool(const Vec3&)>& chosen) {
  for (const auto v : mesh.vertices()) mesh.status(v).set_selected(chosen(mesh.point(v)));
}

/// The energy that `tangent` minimises with uniform weights, from its definition.
double plate_energy(const Mesh& mesh) {
  double sum = 0;
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    Vec3 l(0, 0, 0);
    int valence = 0;
    for (const auto w : mesh.vv_range(v)) l += mesh.point(w) - mesh.point(v), ++valence;
    sum += l.sqrnorm() / valence;
  }
  return sum;
}

}  // namespace

TEST_CASE("fair: dents in a plane are flattened to 1e-9, with any continuity and weights") {
  for (const auto continuity : continuities)
    for (const auto weights : all_weights) {
      Mesh mesh = bumpy_grid(16, 16);
      for (const auto v : mesh.vertices()) {
        const Vec3 p = mesh.point(v);
        if (std::hypot(p[0] - 8, p[1] - 8) > 3.5) mesh.point(v)[2] = 2;
      }
      select(mesh, [](const Vec3& p) { return p[2] != 2; });
      Context context;
      const Report report = fair(view_of(mesh), {.continuity = continuity, .weights = weights}, context);
      CHECK(report.vertices_moved > 20);
      CHECK(report.notes.empty());
      for (const auto v : mesh.vertices()) CHECK(std::abs(mesh.point(v)[2] - 2) < 1e-9);
    }
}

TEST_CASE("fair: with position and uniform weights every vertex is in the middle of its neighbours") {
  Mesh mesh = bumpy_grid(12, 12);
  select(mesh, [](const Vec3& p) { return std::hypot(p[0] - 6, p[1] - 6) < 4; });
  Context context;
  fair(view_of(mesh), {.continuity = Continuity::position, .weights = FairingWeights::uniform}, context);
  int checked = 0;
  for (const auto v : mesh.vertices()) {
    if (!mesh.status(v).selected()) continue;
    Vec3 sum(0, 0, 0);
    int valence = 0;
    for (const auto w : mesh.vv_range(v)) sum += mesh.point(w), ++valence;
    CHECK((sum / valence - mesh.point(v)).norm() < 1e-10);
    ++checked;
  }
  CHECK(checked > 20);
}

TEST_CASE("fair: with tangent no vertex can move without raising the thin-plate energy") {
  Mesh mesh = bumpy_grid(12, 12);
  select(mesh, [](const Vec3& p) { return std::hypot(p[0] - 6, p[1] - 6) < 4; });
  const double before = plate_energy(mesh);
  Context context;
  fair(view_of(mesh), {.continuity = Continuity::tangent, .weights = FairingWeights::uniform}, context);
  const double least = plate_energy(mesh);
  CHECK(least < before);
  for (const auto v : mesh.vertices()) {
    if (!mesh.status(v).selected()) continue;
    for (int k = 0; k < 3; ++k)
      for (const double step : {1e-3, -1e-3}) {
        mesh.point(v)[k] += step;
        CHECK(plate_energy(mesh) > least);
        mesh.point(v)[k] -= step;
      }
  }
}

TEST_CASE("fair: the result turns, moves and scales with the mesh") {
  const double c = std::cos(1.1), s = std::sin(1.1);
  const auto moved = [&](const Vec3& p) {
    return 250.0 * Vec3(c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]) + Vec3(1e3, -2e3, 10);
  };
  for (const auto continuity : continuities) {
    Mesh mesh = bumpy_grid(10, 10);
    select(mesh, [](const Vec3& p) { return std::hypot(p[0] - 5, p[1] - 5) < 3; });
    Mesh other = mesh;
    for (const auto v : other.vertices()) other.set_point(v, moved(mesh.point(v)));
    Context context;
    fair(view_of(mesh), {.continuity = continuity}, context);
    fair(view_of(other), {.continuity = continuity}, context);
    for (const auto v : mesh.vertices()) CHECK((moved(mesh.point(v)) - other.point(v)).norm() < 1e-6);
  }
}

TEST_CASE("fair: says what it cannot move, and changes nothing else") {
  Mesh mesh = bumpy_grid(8, 8);
  mesh.add_vertex({50, 50, 50});
  for (const auto v : mesh.vertices()) mesh.status(v).set_selected(mesh.point(v)[0] > 4.5);
  const Mesh before = mesh;
  Context context;
  const Report report = fair(view_of(mesh), {}, context);
  CHECK(report.skipped.at("isolated vertex") == 1);
  CHECK(report.skipped.at("boundary vertex") > 0);
  CHECK(report.vertices_moved == report.touched_vertices.size());
  for (const auto v : mesh.vertices())
    if (!before.status(v).selected() || before.is_boundary(v)) CHECK(mesh.point(v) == before.point(v));

  Mesh closed = icosahedron();
  for (const auto v : closed.vertices()) closed.status(v).set_selected(true);
  const Snapshot all = snapshot(view_of(closed));
  const Report nothing = fair(view_of(closed), {}, context);
  CHECK(nothing.unchanged());
  CHECK(nothing.skipped == decltype(nothing.skipped){{"no neighbour stays", 12}});
  CHECK(snapshot(view_of(closed)) == all);
}

TEST_CASE("fair: the region can be named by a property or handed over") {
  Mesh mesh = bumpy_grid(8, 8), same = mesh;
  OpenMesh::VPropHandleT<int> region;
  mesh.add_property(region, "v:region");
  const VertexHandle chosen(40);
  for (const auto v : mesh.vertices()) mesh.property(region, v) = v == chosen;
  Context context;
  CHECK_THROWS_AS(fair(view_of(mesh), {.region = "v:nothing"}, context), InvalidInput);
  CHECK(fair(view_of(mesh), {.region = "v:region"}, context).vertices_moved == 1);
  const std::vector<VertexHandle> list{chosen, chosen};
  CHECK(fair(view_of(same), {.vertices = list}, context).vertices_moved == 1);
  CHECK(snapshot(view_of(mesh)) == snapshot(view_of(same)));
  const std::vector<VertexHandle> wrong{VertexHandle(4000)};
  CHECK_THROWS_AS(fair(view_of(same), {.vertices = wrong}, context), InvalidInput);
}

TEST_CASE("fair: where a triangle has no area uniform weights take over, and it is said") {
  Mesh mesh = grid(6, 6);
  select(mesh, [](const Vec3& p) { return std::hypot(p[0] - 3, p[1] - 3) < 1.5; });
  mesh.point(VertexHandle(24)) = mesh.point(VertexHandle(25));
  Context context;
  const Report report = fair(view_of(mesh), {}, context);
  REQUIRE(report.notes.size() == 1);
  CHECK(report.notes[0].find("triangle without area") != std::string::npos);
  CHECK(report.vertices_moved > 0);
  CHECK_VALID_MESH(mesh);
}

TEST_CASE("fill_holes: a hole in a plane, refined and faired, stays in the plane to 1e-9 and is filled once") {
  for (const auto fairness : fairnesses) {
    const Vec3 normal(1, -2, 0.5);
    Mesh mesh = holed_plane(normal);
    const double rim = mesh_area(view_of(mesh));
    Mesh flat = mesh;
    Context context;
    fill_holes(view_of(flat), {}, context);
    const std::size_t vertices = mesh.n_vertices();
    const Report report = fill_holes(view_of(mesh), {.fair = fairness}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(report.vertices_added > 10);
    CHECK(mesh.n_vertices() == vertices + report.vertices_added);
    CHECK(report.figures.count("fillings not faired") == 0);
    CHECK(euler_characteristic(mesh) == 1);
    for (const auto v : mesh.vertices()) CHECK(std::abs(mesh.point(v) | normal.normalized()) < 1e-9);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(mesh_area(view_of(flat))));
    CHECK(mesh_area(view_of(mesh)) > rim + 50);
    for (const auto f : mesh.faces()) CHECK((mesh.calc_face_normal(f) | normal) > 0);
  }
}

TEST_CASE("fill_holes: refined triangles are about as large as those at the rim, without growth") {
  Mesh mesh = holed_plane({0, 0, 1});
  Context context;
  const Report report = fill_holes(view_of(mesh), {.refine = true, .growth = 0}, context);
  // The hole has some 80 cells of area 1, and so as many vertices in its interior, give or take.
  CHECK(report.vertices_added > 40);
  CHECK(report.vertices_added < 100);
  Mesh coarse = holed_plane({0, 0, 1});
  const Report grown = fill_holes(view_of(coarse), {.refine = true, .growth = 0.3}, context);
  CHECK(grown.vertices_added < report.vertices_added);
  CHECK(grown.vertices_added > 0);
}

TEST_CASE("fill_holes: a hole in a sphere, refined and faired, comes back to the sphere") {
  const Mesh whole = ball(4);
  double deepest[3];
  for (int k = 0; k < 3; ++k) {
    Mesh mesh = whole;
    cut(mesh, [](const Vec3& p) { return p[2] > std::cos(0.5); });
    Context context;
    const Report report = fill_holes(view_of(mesh), {.growth = 0, .fair = fairnesses[k]}, context);
    CHECK(report.figures.at("holes filled") == 1);
    CHECK_VALID_MESH(mesh);
    CHECK(euler_characteristic(mesh) == 2);
    deepest[k] = 0;
    for (const auto v : report.touched_vertices)
      deepest[k] = std::max(deepest[k], std::abs(mesh.point(VertexHandle(static_cast<int>(v))).norm() - 1));
  }
  // A flat filling lies 1 - cos 0.5 = 0.12 below the sphere.
  CHECK(deepest[0] < 0.125);
  CHECK(deepest[1] < 0.02);
  CHECK(deepest[2] < 0.01);
}

TEST_CASE("fill_holes: a hole in a cylinder's side, refined and faired, comes back to the cylinder") {
  PatchShape s = tube(48, 24, 1, -1.5, 1.5);
  s.keep = [](int i, int j) { return std::hypot(i - 20, j - 12) > 5; };
  Mesh mesh = s.mesh();
  Context context;
  const Report report = fill_holes(view_of(mesh), {.max_edges = 47, .growth = 0, .fair = Fairness::curvature}, context);
  CHECK(report.figures.at("holes filled") == 1);
  CHECK_VALID_MESH(mesh);
  double off = 0;
  for (const auto v : report.touched_vertices) {
    const Vec3 p = mesh.point(VertexHandle(static_cast<int>(v)));
    off = std::max(off, std::abs(std::hypot(p[0], p[1]) - 1));
  }
  // The hole is 10 of 48 cells wide: a flat filling is 1 - cos(37 degrees) = 0.2 inside.
  CHECK(off < 0.02);
}

TEST_CASE("fill_holes: vertices that refining adds inherit from the rim") {
  Mesh mesh = holed_plane({0, 0, 1});
  OpenMesh::VPropHandleT<double> height;
  mesh.add_property(height, "v:height");
  for (const auto v : mesh.vertices()) mesh.property(height, v) = 3 + 0.1 * mesh.point(v)[0];
  Context context;
  const Report report = fill_holes(view_of(mesh), {.refine = true}, context);
  CHECK(report.vertices_added > 10);
  // Each new vertex is the middle of three, so a linear function is inherited exactly.
  for (const auto v : mesh.vertices()) CHECK(mesh.property(height, v) == doctest::Approx(3 + 0.1 * mesh.point(v)[0]));
}

TEST_CASE("fill_holes: cancelled anywhere while refining and fairing, the mesh is valid") {
  int checkpoints = 0;
  for (int stop = 0; stop == 0 || stop <= checkpoints; ++stop) {
    Mesh mesh = holed_plane({0, 0, 1});
    Context context;
    std::atomic<int> seen = 0;
    context.on_checkpoint = [&] {
      if (++seen == stop) context.cancel();
    };
    if (stop == 0) {
      fill_holes(view_of(mesh), {.fair = Fairness::tangent}, context);
      checkpoints = seen;
      CHECK(checkpoints > 5);
    } else {
      CHECK_THROWS_AS(fill_holes(view_of(mesh), {.fair = Fairness::tangent}, context), Cancelled);
    }
    CHECK_VALID_MESH(mesh);
  }
}

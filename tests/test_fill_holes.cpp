#include <doctest/doctest.h>

#include <set>

#include "meshops/error.hpp"
#include "meshops/operators/fill_holes.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

constexpr HoleStrategy strategies[] = {HoleStrategy::nearest_diagonal, HoleStrategy::minimum_area_dihedral,
                                       HoleStrategy::minimum_area, HoleStrategy::least_bending};

/// 20 x 20 cells in the plane without those that `hole` names.
PatchShape sheet_without(std::function<bool(int, int)> hole) {
  PatchShape s;
  s.nu = s.nv = 20;
  s.keep = [hole](int i, int j) { return !hole(i, j); };
  return s;
}

/// The torus of 7 vertices: every two vertices are joined by an edge.
std::vector<std::array<int, 3>> torus7() {
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < 7; ++i) {
    triangles.push_back({i, (i + 1) % 7, (i + 3) % 7});
    triangles.push_back({i, (i + 3) % 7, (i + 2) % 7});
  }
  return triangles;
}

std::vector<Vec3> seven_points() {
  return {{0, 0, 0}, {3, 0, 1}, {1, 3, 0}, {-2, 2, 1}, {-3, -1, 0}, {-1, -3, 2}, {2, -2, 3}};
}

}  // namespace

TEST_CASE("fill_holes: caps a tube with two flat discs") {
  for (const auto strategy : strategies)
    for (const int n : {3, 4, 5, 12, 63, 64, 65, 200}) {
      Mesh mesh = tube(n, 4, 2, 0, 5).mesh();
      const double side = mesh_area(view_of(mesh));
      Context context;
      const Report report = fill_holes(view_of(mesh), {.strategy = strategy}, context);
      CHECK(report.faces_added == 2u * (n - 2));
      CHECK(report.touched_faces.size() == report.faces_added);
      CHECK(report.figures.at("holes filled") == 2);
      CHECK(report.figures.count("holes optimised in pieces") ==
            (strategy != HoleStrategy::nearest_diagonal && n > 128));
      CHECK_VALID_MESH(mesh);
      CHECK(euler_characteristic(mesh) == 2);
      CHECK(mesh_area(view_of(mesh)) == doctest::Approx(side + 2 * ngon_area(n, 2)));
      CHECK(mesh_volume(view_of(mesh)) == doctest::Approx(5 * ngon_area(n, 2)));
      CHECK(fill_holes(view_of(mesh), {.strategy = strategy}, context).unchanged());
    }
}

TEST_CASE("fill_holes: a concave hole in a plane is tiled without fold or overlap; the sheet's rim stays open") {
  const auto shapes = {
      sheet_without([](int i, int j) {
        return (i >= 3 && i < 15 && j >= 3 && j < 5) || (i >= 3 && i < 5 && j >= 3 && j < 16);
      }),  // L
      sheet_without(
          [](int i, int j) { return i >= 2 && i < 17 && j >= 2 && j < 17 && (j == 2 || i % 2 == 0); }),  // comb
      sheet_without([](int i, int j) { return i == 7 && j == 9; }),
  };
  for (const auto strategy : strategies)
    for (const auto& shape : shapes) {
      Mesh mesh = shape.mesh();
      Context context;
      const Report report = fill_holes(view_of(mesh), {.strategy = strategy}, context);
      CHECK(report.figures.at("holes filled") == 1);
      CHECK(report.skipped == decltype(report.skipped){{"rim of a sheet", 1}});
      CHECK_VALID_MESH(mesh);
      CHECK(boundary_loops(mesh) == 1);
      CHECK(euler_characteristic(mesh) == 1);
      CHECK(mesh_area(view_of(mesh)) == doctest::Approx(400));
      for (const auto f : mesh.faces()) CHECK(mesh.calc_face_normal(f)[2] >= 0);
    }
}

TEST_CASE("fill_holes: a hole in a sphere is closed along the sphere") {
  const int n = 40;
  for (const auto strategy : strategies) {
    PatchShape s;
    s.nu = s.nv = n;
    s.closed_u = true;
    s.point = [=](int i, int j) {
      const double longitude = 2 * pi * i / n, latitude = pi * ((j + 0.5) / (n + 1) - 0.5);
      return Vec3(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                  std::sin(latitude));
    };
    s.keep = [](int i, int j) { return !(i >= 5 && i < 10 && j >= 17 && j < 23); };
    Mesh mesh = s.mesh();
    Context context;
    const Report report = fill_holes(view_of(mesh), {.strategy = strategy}, context);
    CHECK(report.figures.at("holes filled") == 3);  // the hole and both poles
    CHECK_VALID_MESH(mesh);
    CHECK(euler_characteristic(mesh) == 2);
    // A chord across an arc of a sinks to cos(a / 2); the hole is 5 * 9 degrees wide.
    for (const auto f : report.touched_faces) {
      const Vec3 centre = mesh.calc_face_centroid(FaceHandle(static_cast<int>(f)));
      CHECK(centre.norm() <= 1);
      CHECK(centre.norm() > std::cos(22.5 * pi / 180) - 0.02);
      CHECK((mesh.calc_face_normal(FaceHandle(static_cast<int>(f))) | centre.normalized()) > 0.7);
    }
  }
}

TEST_CASE("fill_holes: minimum-area-dihedral has no larger area than nearest-diagonal on a tube's slanted end") {
  PatchShape s = tube(24, 2, 1, 0, 2);
  const auto straight = s.point;
  s.point = [=](int i, int j) {
    Vec3 p = straight(i, j);
    if (j == 2) p[2] += 0.7 * std::sin(3 * 2 * pi * i / 24);
    return p;
  };
  double area[2];
  for (int k = 0; k < 2; ++k) {
    Mesh mesh = s.mesh();
    Context context;
    fill_holes(view_of(mesh), {.strategy = strategies[k]}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(euler_characteristic(mesh) == 2);
    area[k] = mesh_area(view_of(mesh));
  }
  CHECK(area[1] <= area[0] * 1.0001);
}

TEST_CASE("fill_holes: leaves a loop longer than max_edges open") {
  Mesh mesh = sheet_without([](int i, int j) { return (i == 3 && j == 3) || (i >= 10 && i < 13 && j == 10); }).mesh();
  Context context;
  const Report report = fill_holes(view_of(mesh), {.max_edges = 4}, context);
  CHECK(report.faces_added == 2);
  CHECK(report.skipped == decltype(report.skipped){{"loop longer than max-edges", 2}});
  CHECK(boundary_loops(mesh) == 2);
  CHECK_VALID_MESH(mesh);
}

TEST_CASE("fill_holes: leaves a loop wider than max_diameter open") {
  const double diameter = std::sqrt(9.0 + 1.0);  // of the hole of 3 x 1 cells
  for (const double limit : {diameter * 1.001, diameter * 0.999, 0.5}) {
    Mesh mesh = sheet_without([](int i, int j) { return (i == 3 && j == 3) || (i >= 10 && i < 13 && j == 10); }).mesh();
    Context context;
    const Report report = fill_holes(view_of(mesh), {.max_diameter = limit}, context);
    const unsigned open = limit > diameter ? 1 : limit > 1.5 ? 2 : 3;
    CHECK(report.skipped.at("loop wider than max-diameter") == open);
    CHECK(boundary_loops(mesh) == static_cast<int>(open));
  }
}

TEST_CASE("fill_holes: closes a loop of three edges, but not the rim of a single triangle") {
  Mesh mesh = icosahedron();
  mesh.delete_face(FaceHandle(7), false);
  Context context;
  CHECK(fill_holes(view_of(mesh), {}, context).faces_added == 1);
  CHECK_VALID_MESH(mesh);
  CHECK(euler_characteristic(mesh) == 2);

  Mesh single = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const Snapshot before = snapshot(view_of(single));
  const Report report = fill_holes(view_of(single), {}, context);
  CHECK(report.unchanged());
  CHECK(report.skipped == decltype(report.skipped){{"rim of a single triangle", 1}});
  CHECK(snapshot(view_of(single)) == before);
}

TEST_CASE("fill_holes: never doubles an edge; a hole without another triangulation is not modified") {
  // Without the star of vertex 0 the rim has 6 vertices, and all of its 9 chords are edges of the torus.
  std::vector<std::array<int, 3>> star_removed, two_removed;
  for (const auto& t : torus7())
    if (t[0] != 0 && t[1] != 0 && t[2] != 0) star_removed.push_back(t);
  for (const auto& t : torus7())
    if (t != std::array<int, 3>{0, 1, 3} && t != std::array<int, 3>{0, 3, 2}) two_removed.push_back(t);
  for (const auto strategy : strategies) {
    Mesh mesh = make_mesh(seven_points(), star_removed);
    const Snapshot before = snapshot(view_of(mesh));
    Context context;
    const Report report = fill_holes(view_of(mesh), {.strategy = strategy}, context);
    CHECK(report.unchanged());
    CHECK(report.skipped == decltype(report.skipped){{"no triangulation without an existing edge", 1}});
    CHECK(snapshot(view_of(mesh)) == before);

    // Without two neighbours the rim (0, 1, 3, 2) has one free chord, (0, 3), and one that is taken, (1, 2).
    Mesh square = make_mesh(seven_points(), two_removed);
    const Report filled = fill_holes(view_of(square), {.strategy = strategy}, context);
    CHECK((filled.faces_added == 2 || filled.skipped.count("rim of a sheet")));
    CHECK_VALID_MESH(square);
    if (filled.faces_added) CHECK(square.find_halfedge(VertexHandle(0), VertexHandle(3)).is_valid());
    CHECK(square.n_edges() <= 21);
  }
}

TEST_CASE("fill_holes: nested islands stay apart from the hole around them") {
  Mesh mesh = sheet_without([](int i, int j) {
                return i >= 4 && i < 13 && j >= 4 && j < 13 && !(i >= 8 && i < 10 && j >= 8 && j < 10);
              }).mesh();
  Context context;
  const Report report = fill_holes(view_of(mesh), {}, context);
  CHECK_VALID_MESH(mesh);
  CHECK(report.figures.at("holes filled") == 1);
  CHECK(report.skipped == decltype(report.skipped){{"rim of a sheet", 2}});
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(400 + 4));
}

TEST_CASE("fill_holes: a loop that meets itself stays open; two holes that touch in a vertex are both filled") {
  Mesh mesh = sheet_without([](int i, int j) { return (i == 5 && j == 5) || (i == 6 && j == 6); }).mesh();
  Context context;
  CHECK(fill_holes(view_of(mesh), {}, context).figures.at("holes filled") == 2);
  CHECK_VALID_MESH(mesh);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(400));

  Mesh hourglass = make_mesh({{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  const Report report = fill_holes(view_of(hourglass), {}, context);
  CHECK(report.unchanged());
  CHECK(report.skipped == decltype(report.skipped){{"loop meets itself in a vertex", 1}});
}

TEST_CASE("fill_holes: the reference can keep a hole of the part open") {
  struct KeepNearOrigin : Reference {
    Mesh* mesh = nullptr;
    Vec3 normal(VertexHandle, VertexHandle, VertexHandle) const override { return {0, 0, 0}; }
    bool inside(VertexHandle, VertexHandle, VertexHandle, const std::array<double, 3>&) const override { return true; }
    std::vector<ContourPair> contour_pairs(MeshView) const override { return {}; }
    bool keeps_open(std::span<const VertexHandle> rim) const override { return mesh->point(rim[0]).norm() < 8; }
  } reference;
  Mesh mesh = sheet_without([](int i, int j) { return (i == 3 && j == 3) || (i == 15 && j == 15); }).mesh();
  reference.mesh = &mesh;
  Context context;
  const Report report = fill_holes(view_of(mesh), {.max_edges = 10, .reference = &reference}, context);
  CHECK(report.faces_added == 2);
  CHECK(report.skipped.at("kept open by the reference") == 1);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(399));
}

TEST_CASE("fill_holes: cancelled between holes the mesh is valid and the first hole is filled") {
  Mesh mesh = sheet_without([](int i, int j) { return i % 4 == 2 && j % 4 == 2; }).mesh();
  Context context;
  int steps = 0;
  context.on_progress = [&](std::string_view, double) {
    if (++steps == 4) context.cancel();
  };
  CHECK_THROWS_AS(fill_holes(view_of(mesh), {.max_edges = 10}, context), Cancelled);
  CHECK_VALID_MESH(mesh);
  CHECK(boundary_loops(mesh) < 26);
  CHECK(boundary_loops(mesh) > 1);
}

TEST_CASE("fill_holes: an option out of range is an error that leaves the mesh untouched") {
  Mesh mesh = grid(3, 3);
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  CHECK_THROWS_AS(fill_holes(view_of(mesh), {.max_edges = 2}, context), InvalidInput);
  CHECK_THROWS_AS(fill_holes(view_of(mesh), {.max_diameter = -1}, context), InvalidInput);
  CHECK_THROWS_AS(fill_holes(view_of(mesh), {.max_dynamic_edges = 1001}, context), InvalidInput);
  CHECK(snapshot(view_of(mesh)) == before);
}

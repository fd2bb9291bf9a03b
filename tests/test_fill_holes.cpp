#include <doctest/doctest.h>

#include <set>

#include "meshops/error.hpp"
#include "meshops/operators/fill_holes.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

constexpr HoleStrategy all_strategies[] = {HoleStrategy::nearest_diagonal, HoleStrategy::minimum_area_dihedral,
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
  for (const auto strategy : all_strategies)
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
  for (const auto strategy : all_strategies)
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
  for (const auto strategy : all_strategies) {
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
    fill_holes(view_of(mesh), {.strategy = all_strategies[k]}, context);
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
  for (const auto strategy : all_strategies) {
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

TEST_CASE("fill_holes: an island in a hole is joined, every vertex kept; one in the island's hole too") {
  for (const auto strategy : all_strategies) {
    // A ring around an island around a hole around an island.
    Mesh mesh = sheet_without([](int i, int j) {
                  const int d = std::max(std::abs(i - 10), std::abs(j - 10));
                  return d == 7 || d == 6 || d == 3 || d == 2;
                }).mesh();
    // The innermost island floats a little above.
    for (const auto v : mesh.vertices())
      if (std::hypot(mesh.point(v)[0] - 10.5, mesh.point(v)[1] - 10.5) < 2.5) mesh.point(v)[2] = 0.1;
    const Mesh before = mesh;
    Context context;
    const Report report = fill_holes(view_of(mesh), {.strategy = strategy}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(report.figures.at("holes filled") == 2);
    CHECK(report.figures.at("islands joined") == 2);
    CHECK(report.figures.count("fillings that cross the mesh") == 0);
    CHECK(report.skipped == decltype(report.skipped){{"rim of a sheet", 1}});
    CHECK(boundary_loops(mesh) == 1);
    CHECK(euler_characteristic(mesh) == 1);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(400).epsilon(0.01));
    for (const auto v : before.vertices()) {
      CHECK(mesh.point(v) == before.point(v));
      CHECK(mesh.is_isolated(v) == before.is_isolated(v));
    }
    for (const auto f : mesh.faces()) CHECK(mesh.calc_face_normal(f)[2] > 0);
  }
}

TEST_CASE("fill_holes: several islands in one hole; what looks the other way or lies off is none") {
  const auto islands = [](double lift, bool turned) {
    Mesh mesh;
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> triangles;
    PatchShape s;
    s.nu = s.nv = 30;
    s.keep = [](int i, int j) { return i < 5 || i >= 25 || j < 5 || j >= 25; };
    points = s.points();
    triangles = s.triangles();
    for (const auto& [x, y] : {std::pair{10, 10}, {18, 11}, {14, 19}}) {
      const int first = static_cast<int>(points.size());
      points.push_back({x - 1.0, y - 1.0, lift});
      points.push_back({x + 1.0, y - 1.0, lift});
      points.push_back({x + 0.0, y + 1.0, lift});
      points.push_back({x + 0.0, y + 0.0, lift});
      for (int k = 0; k < 3; ++k) {
        const std::array<int, 3> t{first + k, first + (k + 1) % 3, first + 3};
        triangles.push_back(turned ? std::array{t[1], t[0], t[2]} : t);
      }
    }
    return make_mesh(points, triangles);
  };
  Context context;
  Mesh mesh = islands(0, false);
  Report report = fill_holes(view_of(mesh), {}, context);
  CHECK_VALID_MESH(mesh);
  CHECK(report.figures.at("islands joined") == 3);
  CHECK(boundary_loops(mesh) == 1);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(900));

  for (const bool turned : {false, true}) {
    Mesh apart = islands(turned ? 0.01 : 15, turned);
    report = fill_holes(view_of(apart), {}, context);
    CHECK_VALID_MESH(apart);
    CHECK(report.figures.at("holes filled") == 1);
    CHECK(report.figures.count("islands joined") == 0);
    CHECK(report.skipped == decltype(report.skipped){{"rim of a sheet", 4}});
    CHECK(boundary_loops(apart) == 4);
  }
}

TEST_CASE("fill_holes: a cap over a ring-shaped gap in a sphere is an island, and the sphere is whole again") {
  PatchShape s;
  s.nu = 48;
  s.nv = 40;
  s.closed_u = true;
  s.point = [](int i, int j) {
    const double longitude = 2 * pi * i / 48, latitude = pi * ((j + 0.5) / 41 - 0.5);
    return Vec3(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  };
  s.keep = [](int, int j) { return j < 34 || j >= 36; };
  for (const auto strategy : all_strategies) {
    Mesh mesh = s.mesh();
    Context context;
    const Report report = fill_holes(view_of(mesh), {.strategy = strategy}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(report.figures.at("islands joined") == 1);
    CHECK(report.skipped.empty());
    CHECK(euler_characteristic(mesh) == 2);
    CHECK(boundary_loops(mesh) == 0);
  }
}

TEST_CASE("fill_holes: a loop that meets itself in vertices is filled in parts") {
  Mesh mesh = sheet_without([](int i, int j) { return (i == 5 && j == 5) || (i == 6 && j == 6); }).mesh();
  Context context;
  CHECK(fill_holes(view_of(mesh), {}, context).figures.at("holes filled") == 2);
  CHECK_VALID_MESH(mesh);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(400));

  // Three of the six triangles around a vertex are gone, and one loop is linked to run around all of them.
  Mesh star = grid(4, 4);
  VertexHandle middle;
  for (const auto v : star.vertices())
    if (star.point(v) == Vec3(2, 2, 0)) middle = v;
  std::vector<FaceHandle> around;
  for (const auto f : star.vf_range(middle)) around.push_back(f);
  REQUIRE(around.size() == 6);
  for (const int k : {0, 2, 4}) star.delete_face(around[k], false);
  std::vector<HalfedgeHandle> in, out;
  for (auto it = star.voh_iter(middle); it.is_valid(); ++it)
    if (star.is_boundary(*it)) {
      out.push_back(*it);
      in.push_back(star.prev_halfedge_handle(*it));
    }
  REQUIRE(out.size() == 3);
  REQUIRE(boundary_loops(star) == 4);
  // The three fans are linked in the other order: from each to the one that is neither the next nor itself.
  std::vector<HalfedgeHandle> target;
  for (int k = 0; k < 3; ++k) {
    HalfedgeHandle own = star.opposite_halfedge_handle(in[k]);
    while (star.face_handle(own).is_valid())
      own = star.opposite_halfedge_handle(star.next_halfedge_handle(star.next_halfedge_handle(own)));
    for (const HalfedgeHandle o : out)
      if (o != own && o != out[k]) target.push_back(o);
  }
  REQUIRE(target.size() == 3);
  for (int k = 0; k < 3; ++k) star.set_next_halfedge_handle(in[k], target[k]);
  REQUIRE(boundary_loops(star) == 2);
  const Report parts = fill_holes(view_of(star), {}, context);
  CHECK(parts.figures.at("loops cut apart where they meet themselves") == 1);
  CHECK(parts.figures.at("holes filled") == 3);
  CHECK_VALID_MESH(star);
  CHECK(mesh_area(view_of(star)) == doctest::Approx(16));

  // An island that touches the rim of its hole.
  Mesh crescent = sheet_without([](int i, int j) {
                    return i >= 4 && i < 12 && j >= 4 && j < 12 && !(i >= 4 && i < 7 && j >= 4 && j < 7);
                  }).mesh();
  std::vector<FaceHandle> cut;
  for (const auto f : crescent.faces()) {
    const Vec3 p = crescent.calc_face_centroid(f);
    if (p[0] > 4 && p[0] < 12 && p[1] > 4 && p[1] < 12 && (p[0] < 5 || p[1] < 5)) cut.push_back(f);
  }
  for (const FaceHandle f : cut) crescent.delete_face(f, true);
  for (const auto v : crescent.vertices())  // the island's corner goes to the hole's corner: one vertex short of a weld
    if (crescent.point(v) == Vec3(5, 5, 0)) crescent.set_point(v, {4.2, 4.2, 0});
  const double missing = 400 - mesh_area(view_of(crescent));
  CHECK(missing > 40);
  const Report joined = fill_holes(view_of(crescent), {}, context);
  CHECK(joined.figures.at("islands joined") == 1);
  CHECK_VALID_MESH(crescent);
  CHECK(mesh_area(view_of(crescent)) == doctest::Approx(400));

  Mesh hourglass = make_mesh({{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  const Report report = fill_holes(view_of(hourglass), {}, context);
  CHECK(report.unchanged());
  CHECK(report.skipped == decltype(report.skipped){{"rim of a single triangle", 2}});
}

TEST_CASE("fill_holes: a filling goes round what stands in its way where it can; what it crosses is reported") {
  // A spike stands through the middle of the hole, off the diagonals' crossing.
  const auto pierced = [](double z0, double z1) {
    PatchShape s;
    s.nu = s.nv = 8;
    s.keep = [](int i, int j) { return i < 3 || i >= 5 || j < 3 || j >= 5; };
    s.point = [](int i, int j) { return Vec3(i, j, (i >= 3 && i <= 5 && j >= 3 && j <= 5) ? 0.1 * (i - j) : 0); };
    auto points = s.points();
    auto triangles = s.triangles();
    const int n = static_cast<int>(points.size());
    points.push_back({3.9, 4.4, z0});
    points.push_back({4.0, 4.5, z0});
    points.push_back({3.9, 4.5, z1});
    triangles.push_back({n, n + 1, n + 2});
    return make_mesh(points, triangles);
  };
  Context context;
  for (const auto strategy : all_strategies) {
    Mesh mesh = pierced(-2, 2);
    const Report report = fill_holes(view_of(mesh), {.strategy = strategy}, context);
    CHECK(report.figures.at("holes filled") == 1);
    CHECK(report.figures.at("fillings that cross the mesh") == 1);
    CHECK(report.notes.size() == 1);
    Mesh free = pierced(1, 2);
    CHECK(fill_holes(view_of(free), {.strategy = strategy}, context).figures.count("fillings that cross the mesh") ==
          0);
  }
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

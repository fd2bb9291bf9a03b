#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "meshops/crossings/crossing_guard.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/subdivide.hpp"
#include "meshops/to_soup.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

constexpr SubdivisionScheme schemes[] = {SubdivisionScheme::loop, SubdivisionScheme::butterfly,
                                         SubdivisionScheme::midpoint};

Report run_subdivide(Mesh& mesh, const SubdivideOptions& options = {}) {
  Context context;
  const Report report = subdivide(view_of(mesh), options, context);
  CHECK_VALID_MESH(mesh);
  return report;
}

std::size_t edges(const Mesh& mesh) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto e : mesh.edges()) ++count;
  return count;
}

Mesh tetrahedron_mesh() {
  return make_mesh({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
}

Mesh plain_box() {
  return make_mesh({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}},
                   {{0, 2, 1},
                    {0, 3, 2},
                    {4, 5, 6},
                    {4, 6, 7},
                    {0, 1, 5},
                    {0, 5, 4},
                    {1, 2, 6},
                    {1, 6, 5},
                    {2, 3, 7},
                    {2, 7, 6},
                    {3, 0, 4},
                    {3, 4, 7}});
}

}  // namespace

TEST_CASE("subdivide: makes four faces of one and a vertex on each edge; topology stays, closed stays closed") {
  for (const SubdivisionScheme scheme : schemes)
    for (const Mesh& input :
         {icosahedron(), tetrahedron_mesh(), grid(4, 3), tube(7, 3, 1, 0, 2).mesh(), two_components()}) {
      Mesh mesh = input;
      const int loops = boundary_loops(mesh), euler = euler_characteristic(mesh);
      for (const int levels : {1, 2}) {
        const std::size_t v = mesh.n_vertices(), e = edges(mesh), f = mesh.n_faces();
        std::size_t boundary = 0;
        for (const EdgeHandle edge : mesh.edges()) boundary += mesh.is_boundary(edge);
        const Report report = run_subdivide(mesh, {.scheme = scheme, .levels = levels});
        const auto power = static_cast<std::size_t>(1) << (2 * levels), half = static_cast<std::size_t>(1) << levels;
        CHECK(mesh.n_faces() == power * f);
        CHECK(report.faces_added == (power - 1) * f);
        CHECK(report.touched_faces.size() == power * f);
        // Twice the edges of the level before and three inside of each of its faces; V follows from Euler.
        CHECK(edges(mesh) == (3 * power * f + half * boundary) / 2);
        CHECK(mesh.n_vertices() == v + edges(mesh) - e - (power - 1) * f);
        CHECK(report.vertices_added == mesh.n_vertices() - v);
        CHECK(boundary_loops(mesh) == loops);
        CHECK(euler_characteristic(mesh) == euler);
      }
    }
}

TEST_CASE("subdivide: every new vertex inside a regular mesh has six neighbours") {
  Mesh mesh = icosahedron();
  run_subdivide(mesh, {.scheme = SubdivisionScheme::midpoint, .levels = 3});
  for (const VertexHandle v : mesh.vertices()) CHECK(mesh.valence(v) == (v.idx() < 12 ? 5u : 6u));
}

TEST_CASE("subdivide midpoint: keeps the surface exactly") {
  for (const Mesh& input : {icosahedron(), bumpy_grid(5, 4), plain_box()}) {
    Mesh mesh = input;
    const double area = mesh_area(view_of(mesh)), volume = mesh_volume(view_of(mesh));
    const Report report = run_subdivide(mesh, {.scheme = SubdivisionScheme::midpoint, .levels = 2});
    CHECK(report.vertices_moved == 0);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(area).epsilon(1e-12));
    CHECK(mesh_volume(view_of(mesh)) == doctest::Approx(volume).epsilon(1e-12));
    for (std::size_t i = 0; i < input.n_vertices(); ++i) {
      const VertexHandle v(static_cast<int>(i));
      CHECK(mesh.point(v) == input.point(v));
    }
    // Four equal pieces: each has an area of a sixteenth of one of the faces.
    std::vector<double> old_areas, new_areas;
    for (const FaceHandle f : input.faces())
      for (int k = 0; k < 16; ++k) old_areas.push_back(input.calc_face_area(f) / 16);
    for (const FaceHandle f : mesh.faces()) new_areas.push_back(mesh.calc_face_area(f));
    std::ranges::sort(old_areas);
    std::ranges::sort(new_areas);
    for (std::size_t i = 0; i < old_areas.size(); ++i) CHECK(new_areas[i] == doctest::Approx(old_areas[i]));
  }
}

TEST_CASE("subdivide loop: reproduces linear functions on a regular grid, its corners and rim included") {
  Mesh mesh = grid(6, 5);
  const auto height = [](const Vec3& p) { return 2 * p[0] - 3 * p[1] + 0.5; };
  for (const VertexHandle v : mesh.vertices()) mesh.point(v)[2] = height(mesh.point(v));
  const Mesh before = mesh;
  run_subdivide(mesh, {.levels = 3, .corner_angle = 20 * pi / 180});
  for (const VertexHandle v : mesh.vertices()) {
    CHECK(mesh.point(v)[2] == doctest::Approx(height(mesh.point(v))));
    // In the plane as well: vertices end on the lines of the finest grid, 1/8 apart.
    for (int k = 0; k < 2; ++k) CHECK(8 * mesh.point(v)[k] == doctest::Approx(std::round(8 * mesh.point(v)[k])));
  }
  for (const VertexHandle v : before.vertices()) CHECK((mesh.point(v) - before.point(v)).norm() < 1e-12);
}

TEST_CASE("subdivide loop: converges to the known limit of smooth, crease and corner vertices") {
  // Around a smooth vertex of n neighbours the limit is (1 - n c) v + c sum of neighbours, 1 / c = n + 3 / (8 w).
  for (const int n : {3, 4, 5, 6, 7, 12}) {
    std::vector<Vec3> points{{0, 0, 1}};
    std::vector<std::array<int, 3>> triangles;
    for (int ring = 1; ring <= 3; ++ring)
      for (int i = 0; i < n; ++i) {
        const double angle = 2 * pi * i / n;
        points.emplace_back(ring * std::cos(angle), ring * std::sin(angle), 0.1 * ring * i);
      }
    for (int i = 0; i < n; ++i) {
      const int j = (i + 1) % n;
      triangles.push_back({0, 1 + i, 1 + j});
      for (int ring = 0; ring < 2; ++ring) {
        const int a = 1 + ring * n + i, b = 1 + ring * n + j;
        triangles.push_back({a, a + n, b + n});
        triangles.push_back({a, b + n, b});
      }
    }
    const double x = 3.0 / 8 + std::cos(2 * pi / n) / 4;
    const double w = (5.0 / 8 - x * x) / n, c = 1 / (n + 3 / (8 * w));
    Vec3 limit = points[0] * (1 - n * c);
    for (int i = 1; i <= n; ++i) limit += points[static_cast<std::size_t>(i)] * c;
    Mesh mesh = make_mesh(points, triangles);
    run_subdivide(mesh, {.levels = 6, .feature_angle = pi});
    CHECK((mesh.point(VertexHandle(0)) - limit).norm() < 2e-3);
  }
  // A crease and a boundary are cubic B-splines: 2/3 and 1/6.
  Mesh strip = grid(4, 2);
  for (const VertexHandle v : strip.vertices()) strip.point(v)[2] = v.idx() == 2 || v.idx() == 7 ? 0.5 : 0;
  run_subdivide(strip, {.levels = 6, .feature_angle = pi, .corner_angle = 80 * pi / 180});
  CHECK(strip.point(VertexHandle(2))[2] == doctest::Approx(1.0 / 3).epsilon(1e-3));
  CHECK(strip.point(VertexHandle(0)) == Vec3(0, 0, 0));
}

TEST_CASE(
    "subdivide loop: a box keeps its corners, edges and volume, however often; without features it becomes round") {
  Mesh sharp = plain_box(), round = plain_box();
  run_subdivide(sharp, {.levels = 3});
  CHECK(mesh_volume(view_of(sharp)) == doctest::Approx(8));
  CHECK(mesh_area(view_of(sharp)) == doctest::Approx(24));
  for (int i = 0; i < 8; ++i) CHECK(sharp.point(VertexHandle(i)) == plain_box().point(VertexHandle(i)));
  run_subdivide(round, {.levels = 3, .feature_angle = pi});
  CHECK(mesh_volume(view_of(round)) < 5);
  double largest = 0;
  for (const EdgeHandle e : round.edges()) largest = std::max(largest, std::abs(round.calc_dihedral_angle(e)));
  CHECK(largest < 0.6);
}

TEST_CASE("subdivide loop: a crease is handed down, also where its angle falls") {
  // A fold of 62 degrees along a curved ridge; smoothing lowers angles, but the ridge stays a line of sharp edges.
  PatchShape s;
  s.nu = 2;
  s.nv = 8;
  s.point = [](int i, int j) { return Vec3(i - 1, j, (i == 1 ? 0.62 : 0.0) + 0.02 * j * j); };
  Mesh mesh = s.mesh();
  run_subdivide(mesh, {.levels = 3});
  int sharp = 0;
  for (const EdgeHandle e : mesh.edges()) sharp += !mesh.is_boundary(e) && std::abs(mesh.calc_dihedral_angle(e)) > 0.9;
  CHECK(sharp == 8 * 8);
}

TEST_CASE("subdivide butterfly: keeps every vertex, and cubic polynomials on a regular mesh") {
  Mesh mesh = grid(12, 12);
  const auto height = [](double x, double y) {
    return 0.01 * (x * x * x - 2 * x * x * y + x * y * y + 3 * y * y * y - x * y);
  };
  for (const VertexHandle v : mesh.vertices()) mesh.point(v)[2] = height(mesh.point(v)[0], mesh.point(v)[1]);
  const Mesh before = mesh;
  run_subdivide(mesh, {.scheme = SubdivisionScheme::butterfly, .levels = 2, .feature_angle = pi, .corner_angle = pi});
  for (const VertexHandle v : before.vertices()) CHECK(mesh.point(v) == before.point(v));
  int inside = 0;
  for (const VertexHandle v : mesh.vertices()) {
    const Vec3& p = mesh.point(v);
    if (p[0] < 3 || p[0] > 9 || p[1] < 3 || p[1] > 9) continue;
    ++inside;
    CHECK(p[2] == doctest::Approx(height(p[0], p[1])).epsilon(1e-10));
  }
  CHECK(inside == 25 * 25);
}

TEST_CASE("subdivide butterfly: linear functions everywhere, straight and cubic rims, corners") {
  Mesh mesh = grid(7, 6);
  for (const VertexHandle v : mesh.vertices()) mesh.point(v)[2] = mesh.point(v)[0] - 2 * mesh.point(v)[1];
  run_subdivide(mesh, {.scheme = SubdivisionScheme::butterfly, .levels = 3, .corner_angle = 20 * pi / 180});
  for (const VertexHandle v : mesh.vertices())
    CHECK(mesh.point(v)[2] == doctest::Approx(mesh.point(v)[0] - 2 * mesh.point(v)[1]));
  double area = 0;  // no corner is cut, no rim bent
  for (const FaceHandle f : mesh.faces()) area += mesh.calc_face_area(f);
  CHECK(area == doctest::Approx(42 * std::sqrt(6.0)));
  Mesh rim = grid(8, 2);
  for (const VertexHandle v : rim.vertices()) rim.point(v)[2] = 0.01 * std::pow(rim.point(v)[0], 3);
  run_subdivide(rim, {.scheme = SubdivisionScheme::butterfly, .feature_angle = pi});
  for (const VertexHandle v : rim.vertices()) {
    const Vec3& p = rim.point(v);
    if (p[1] == 0 && p[0] > 1 && p[0] < 7) CHECK(p[2] == doctest::Approx(0.01 * std::pow(p[0], 3)));
  }
}

TEST_CASE("subdivide butterfly: an icosahedron swells towards its sphere") {
  Mesh mesh = icosahedron();
  const double radius = mesh.point(VertexHandle(0)).norm();
  run_subdivide(mesh, {.scheme = SubdivisionScheme::butterfly, .levels = 4, .feature_angle = pi});
  const double ball = 4 * pi / 3 * std::pow(radius, 3);
  CHECK(mesh_volume(view_of(mesh)) > 0.9 * ball);
  CHECK(mesh_volume(view_of(mesh)) < 1.1 * ball);
  for (const VertexHandle v : mesh.vertices()) CHECK(mesh.point(v).norm() == doctest::Approx(radius).epsilon(0.06));
}

TEST_CASE("subdivide: properties of new elements come from what they are made of") {
  Mesh mesh = grid(3, 3);
  OpenMesh::VPropHandleT<double> temperature;
  OpenMesh::FPropHandleT<int> group;
  mesh.add_property(temperature, "v:temperature");
  mesh.add_property(group, "f:group");
  for (const VertexHandle v : mesh.vertices()) mesh.property(temperature, v) = mesh.point(v)[0] + 10 * mesh.point(v)[1];
  for (const FaceHandle f : mesh.faces()) mesh.property(group, f) = f.idx() / 2;
  run_subdivide(mesh, {.scheme = SubdivisionScheme::midpoint, .levels = 2});
  for (const VertexHandle v : mesh.vertices())
    CHECK(mesh.property(temperature, v) == doctest::Approx(mesh.point(v)[0] + 10 * mesh.point(v)[1]));
  for (const FaceHandle f : mesh.faces()) {
    const Vec3 centre = mesh.calc_face_centroid(f);
    CHECK(mesh.property(group, f) == static_cast<int>(centre[0]) + 3 * static_cast<int>(centre[1]));
  }
}

TEST_CASE("subdivide: within a selection, the rest stays and fits on") {
  for (const SubdivisionScheme scheme : schemes) {
    Mesh mesh = bumpy_grid(8, 8);
    const Mesh before = mesh;
    std::vector<FaceHandle> faces;
    for (const FaceHandle f : mesh.faces())
      if (mesh.calc_face_centroid(f)[0] > 3) faces.push_back(f);
    const Selection part = Selection::of_faces(mesh, faces);
    Context context;
    const Report report = subdivide(view_of(mesh).with(part), {.scheme = scheme, .levels = 2}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(report.faces_added > 4 * faces.size());
    CHECK(boundary_loops(mesh) == 1);
    for (const FaceHandle f : before.faces())
      if (!part.may_replace(f)) CHECK(std::ranges::equal(mesh.fv_range(f), before.fv_range(f)));
    for (const VertexHandle v : before.vertices())
      if (!part.may_move(v)) CHECK(mesh.point(v) == before.point(v));
  }
}

TEST_CASE("subdivide: cancelled, the surface is that of the last whole level") {
  Mesh start = bumpy_grid(40, 40);
  const double area = mesh_area(view_of(start));
  Mesh once = start;
  run_subdivide(once);
  const double area_once = mesh_area(view_of(once));
  int cancelled = 0;
  for (int stop = 1; stop < 60; stop += 4) {
    Mesh mesh = start;
    Context context;
    context.threads = 1;
    std::atomic<int> seen = 0;
    context.on_checkpoint = [&] {
      if (++seen == stop) context.cancel();
    };
    try {
      subdivide(view_of(mesh), {.levels = 2}, context);
    } catch (const Cancelled&) {
      ++cancelled;
      CHECK_VALID_MESH(mesh);
      const double now = mesh_area(view_of(mesh));
      CHECK((now == doctest::Approx(area).epsilon(1e-12) || now == doctest::Approx(area_once).epsilon(1e-12)));
    }
  }
  CHECK(cancelled > 10);
}

TEST_CASE("subdivide: two triangles back to back, and points that are not finite") {
  Mesh pillow = make_mesh({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 1}});
  const Report report = run_subdivide(pillow);
  CHECK(report.unchanged());
  CHECK(report.skipped.at("edges of triangles back to back") == 3);
  Mesh mesh = bumpy_grid(6, 6);
  mesh.point(VertexHandle(24))[1] = std::nan("");
  run_subdivide(mesh);
  for (const VertexHandle v : mesh.vertices()) {
    if (v.idx() == 24 || (v.idx() >= 49 && std::isnan(mesh.point(v)[1]))) continue;
    for (int k = 0; k < 3; ++k) CHECK(std::isfinite(mesh.point(v)[k]));
  }
}

TEST_CASE("subdivide: nothing comes to cross or is turned over, and what stays for that is counted") {
  const SubdivideOptions all_smooth{.guard = SubdivisionGuard::crossings, .feature_angle = pi, .corner_angle = pi};
  const auto none_cross = [](Mesh& mesh) {
    const Soup out = to_soup(view_of(mesh));
    return crossing_pairs(out.points, out.triangles, Context()).empty();
  };
  const auto kept = [](const Report& report) {
    CHECK(report.notes.size() == report.skipped.size());
    return report.skipped.count("vertices where triangles would fold or cross") == 1;
  };
  for (const SubdivisionScheme scheme : schemes) {
    CAPTURE(static_cast<int>(scheme));
    SubdivideOptions options = all_smooth;
    options.scheme = scheme;
    // A tent over a finer one, on which it would sink; crumpled sheets that nearly touch.
    const std::vector<std::array<int, 3>> sides{{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    Mesh fine = make_mesh({{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, {0, 0, 1}}, sides);
    run_subdivide(fine, {.scheme = SubdivisionScheme::midpoint, .levels = 3});
    const Soup below = to_soup(view_of(fine));
    std::vector<Vec3> points = below.points;
    std::vector<std::array<int, 3>> triangles;
    for (const auto& [a, b, c] : below.triangles)
      triangles.push_back({static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)});
    const int first = static_cast<int>(points.size());
    for (int k = 0; k < 5; ++k) points.push_back(points[static_cast<std::size_t>(k)] + Vec3(0, 0, 0.02));
    for (const auto& [a, b, c] : sides) triangles.push_back({a + first, b + first, c + first});
    Mesh tents = make_mesh(points, triangles);
    Mesh sheets = crumpled_sheets(8, 0.02, 3);
    for (std::size_t i = sheets.n_vertices() / 2; i < sheets.n_vertices(); i += 2)
      sheets.point(VertexHandle(static_cast<int>(i)))[2] += 1.5;
    REQUIRE((none_cross(tents) && none_cross(sheets)));

    const bool tents_kept = kept(run_subdivide(tents, options));
    options.levels = 2;
    const bool sheets_kept = kept(run_subdivide(sheets, options));
    CHECK((tents_kept || sheets_kept) == (scheme != SubdivisionScheme::midpoint));
    CHECK(none_cross(tents));
    CHECK(none_cross(sheets));

    // Needles beside large triangles, in a plane.
    PatchShape uneven;
    uneven.nu = uneven.nv = 6;
    uneven.point = [](int i, int j) { return Vec3(i < 3 ? 0.02 * i : i - 2.9, j < 3 ? j : 2.9 + 0.01 * j, 0); };
    Mesh plane = uneven.mesh();
    run_subdivide(plane, {.scheme = scheme, .levels = 2});
    for (const FaceHandle f : plane.faces()) CHECK(plane.calc_face_normal(f)[2] > 0);
  }
}

TEST_CASE("subdivide: each guard keeps back what it is for") {
  // Needles beside large triangles, in a plane: pieces fold over, and then cross as well.
  const auto run = [](SubdivisionGuard guard) {
    PatchShape uneven;
    uneven.nu = uneven.nv = 6;
    uneven.point = [](int i, int j) { return Vec3(i < 3 ? 0.02 * i : i - 2.9, j < 3 ? j : 2.9 + 0.01 * j, 0); };
    Mesh mesh = uneven.mesh();
    const SubdivideOptions options{.scheme = SubdivisionScheme::butterfly, .guard = guard, .levels = 2};
    const bool kept = !run_subdivide(mesh, options).skipped.empty();
    int turned = 0;
    for (const FaceHandle f : mesh.faces()) turned += mesh.calc_face_normal(f)[2] < 0;
    return std::pair(kept, turned);
  };
  CHECK(run(SubdivisionGuard::folds) == std::pair(true, 0));
  CHECK(run(SubdivisionGuard::crossings) == std::pair(true, 0));
  const auto [kept, turned] = run(SubdivisionGuard::none);
  CHECK_FALSE(kept);
  CHECK(turned > 0);
  // A strip lies in a valley; the floor is rounded off upwards through it, but for the corners at its ends.
  const auto sheets = [](SubdivisionGuard guard) {
    std::vector<Vec3> points{{-1e-3, -1.99, 0.05}, {1e-3, -1.99, 0.05}, {1e-3, 1.99, 0.05}, {-1e-3, 1.99, 0.05}};
    std::vector<std::array<int, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
    for (const double y : {-2.0, 0.0, 2.0})
      for (const double x : {-2.0, 0.0, 2.0}) points.push_back(Vec3(x, y, x == 0 ? -0.01 : 2));
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const int a = 4 + 3 * j + i;
        triangles.push_back({a, a + 1, a + 4});
        triangles.push_back({a, a + 4, a + 3});
      }
    Mesh mesh = make_mesh(points, triangles);
    const Report report = run_subdivide(mesh, {.guard = guard, .feature_angle = pi});
    const Soup out = to_soup(view_of(mesh));
    return std::pair(report.skipped.empty(), crossing_pairs(out.points, out.triangles, Context()).empty());
  };
  CHECK(sheets(SubdivisionGuard::crossings) == std::pair(false, true));
  CHECK_FALSE(sheets(SubdivisionGuard::folds).second);
}

TEST_CASE("subdivide: on a smooth mesh nothing stays back") {
  for (const SubdivisionScheme scheme : schemes) {
    Mesh mesh = tube(12, 6, 2, 0, 6).mesh();
    const SubdivideOptions options{.scheme = scheme, .guard = SubdivisionGuard::crossings, .levels = 2};
    CHECK(run_subdivide(mesh, options).skipped.empty());
  }
}

TEST_CASE("subdivide: refuses what would not fit, the mesh untouched") {
  Mesh mesh = grid(20, 20);
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  CHECK_THROWS_AS(subdivide(view_of(mesh), {.levels = 10}, context), InvalidInput);
  CHECK(snapshot(view_of(mesh)) == before);
}

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "meshops/build_mesh.hpp"
#include "meshops/checks/mesh_distance.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/operators/decimate.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/to_soup.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_decimate(Mesh& mesh, const DecimateOptions& options) {
  Context context;
  const Report report = decimate(view_of(mesh), options, context);
  CHECK_VALID_MESH(mesh);
  return report;
}

std::vector<Vec3> live_points(const Mesh& mesh) {
  std::vector<Vec3> points;
  for (const VertexHandle v : mesh.vertices()) points.push_back(mesh.point(v));
  return points;
}

bool has_point(const Mesh& mesh, const Vec3& p, double tolerance) {
  const std::vector<Vec3> points = live_points(mesh);
  return std::any_of(points.begin(), points.end(), [&](const Vec3& q) { return (p - q).norm() <= tolerance; });
}

/// The surface of a cube, n x n cells on each side, welded.
Mesh fine_cube(int n, double size = 1, const Vec3& offset = Vec3(0, 0, 0)) {
  std::vector<Vec3> points;
  std::map<std::array<int, 3>, int> at;
  const auto vertex = [&](std::array<int, 3> g) {
    const auto [it, added] = at.try_emplace(g, static_cast<int>(points.size()));
    if (added) points.push_back(offset + Vec3(g[0], g[1], g[2]) * (size / n));
    return it->second;
  };
  std::vector<std::array<int, 3>> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> g{};
            g[axis] = side;
            g[(axis + 1) % 3] = i + di;
            g[(axis + 2) % 3] = j + dj;
            return vertex(g);
          };
          const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == n) {
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
          } else {
            triangles.push_back({a, c, b});
            triangles.push_back({a, d, c});
          }
        }
  return make_mesh(points, triangles);
}

/// A sphere of radius 1: latitudes and longitudes, two poles.
Mesh lattice_sphere(int around, int rows) {
  std::vector<Vec3> points{{0, 0, -1}};
  for (int j = 1; j < rows; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * pi * i / around, b = pi * j / rows - pi / 2;
      points.emplace_back(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
    }
  points.emplace_back(0, 0, 1);
  const int top = static_cast<int>(points.size()) - 1;
  const auto at = [&](int i, int j) { return 1 + (j - 1) * around + i % around; };
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < around; ++i) {
    triangles.push_back({0, at(i + 1, 1), at(i, 1)});
    triangles.push_back({top, at(i, rows - 1), at(i + 1, rows - 1)});
    for (int j = 1; j + 1 < rows; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return make_mesh(points, triangles);
}

/// Vertices and middles of faces and edges.
std::vector<Vec3> places_on(const Mesh& mesh) {
  std::vector<Vec3> places = live_points(mesh);
  for (const EdgeHandle e : mesh.edges()) places.push_back(mesh.calc_edge_midpoint(e));
  for (const FaceHandle f : mesh.faces()) places.push_back(mesh.calc_face_centroid(f));
  return places;
}

}  // namespace

TEST_CASE("decimate: a flat polygon becomes as few triangles as its corners allow, without error") {
  Mesh square = grid(20, 20);
  run_decimate(square, {.max_error = 1e-9});
  CHECK(live_faces(square) == 2);
  CHECK(mesh_area(view_of(square)) == doctest::Approx(400).epsilon(1e-12));
  for (const Vec3& p : live_points(square)) {
    CHECK(p[2] == 0);
    CHECK(has_point(grid(1, 1), p / 20.0, 0));
  }

  PatchShape l;
  l.nu = l.nv = 12;
  l.keep = [](int i, int j) { return i < 6 || j < 4; };
  std::vector<Vec3> points = l.points();
  Mesh mesh = l.mesh();
  for (const VertexHandle v : mesh.vertices())
    if (mesh.is_isolated(v)) mesh.delete_vertex(v);
  run_decimate(mesh, {.max_error = 1e-9});
  CHECK(live_faces(mesh) == 4);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(144 - 48).epsilon(1e-12));
}

TEST_CASE("decimate: a cube becomes twelve triangles at its corners, wherever it lies and however large it is") {
  struct Place {
    double size;
    Vec3 offset;
  };
  for (const Place& place : {Place{1, {0, 0, 0}}, Place{1e-6, {0, 0, 0}}, Place{1e6, {0, 0, 0}},
                             Place{1, {1e6, -1e6, 1e6}}, Place{1e-6, {1, 2, 3}}}) {
    CAPTURE(place.size);
    Mesh mesh = fine_cube(8, place.size, place.offset);
    const Report report = run_decimate(mesh, {.max_error = 1e-6 * place.size});
    CHECK(live_faces(mesh) == 12);
    CHECK(report.faces_removed == 12 * 64 - 12);
    const double ulp = 4e-16 * (place.offset.norm() + place.size);
    for (int k = 0; k < 8; ++k)
      CHECK(has_point(mesh, place.offset + Vec3(k & 1, (k >> 1) & 1, k >> 2) * place.size, 4 * ulp));
  }
}

TEST_CASE("decimate: a sphere stays within a small multiple of the best error for as many triangles") {
  Mesh mesh = lattice_sphere(120, 60);
  const Report report = run_decimate(mesh, {.faces = 800});
  CHECK(live_faces(mesh) <= 800);
  CHECK(live_faces(mesh) >= 799);
  CHECK(euler_characteristic(mesh) == 2);
  // Equilateral triangles of the sphere's area, with a circumscribed circle of radius r, stand r^2 / 2 off the sphere.
  const double area = 4 * pi / 800, sagitta = 0.5 * 4 * area / (3 * std::sqrt(3.0));
  for (const Vec3& p : places_on(mesh)) CHECK(std::abs(p.norm() - 1) < 3 * sagitta);
  CHECK(report.figures.at("greatest error") < sagitta);
}

TEST_CASE("decimate: straight creases and boundaries stay where they are") {
  // A gutter: three flat strips that meet in two creases.
  PatchShape gutter;
  gutter.nu = 18;
  gutter.nv = 15;
  gutter.point = [](int i, int j) { return Vec3(std::clamp(i - 6, 0, 6), j, i < 6 ? 6 - i : i > 12 ? i - 12 : 0); };
  Mesh mesh = gutter.mesh();
  run_decimate(mesh, {.max_error = 1e-9});
  CHECK(live_faces(mesh) == 6);
  for (const double x : {0.0, 6.0})
    for (const double y : {0.0, 15.0})
      for (const double z : {0.0, 6.0}) CHECK(has_point(mesh, {x, y, z}, 1e-12));
}

TEST_CASE("decimate: the error is kept") {
  Context context;
  Mesh mesh = lattice_sphere(80, 40);
  const Soup before = to_soup(view_of(mesh));
  const Report report = run_decimate(mesh, {.max_error = 0.002});
  CHECK(report.figures.at("greatest error") <= 0.002);
  CHECK(report.skipped.count("error above the limit") == 1);
  const MeshDistance distance = mesh_distance(before, to_soup(view_of(mesh)), {}, context);
  CHECK(distance.rms <= 0.002);
  CHECK(live_faces(mesh) < 2000);
}

TEST_CASE("decimate: with max-error the distance of the surfaces is measured, both ways") {
  Mesh mesh = crumpled_sheets(10, 3, 5);
  const Soup before = to_soup(view_of(mesh));
  const Report report = run_decimate(mesh, {.max_error = 0.2});
  REQUIRE(report.faces_removed > 0);
  const Soup after = to_soup(view_of(mesh));
  // By brute force, at the corners and many places within.
  double most = 0;
  for (const auto& [from, to] : {std::pair{&before, &after}, std::pair{&after, &before}})
    for (const Triangle& t : from->triangles)
      for (int i = 0; i <= 6; ++i)
        for (int j = 0; i + j <= 6; ++j) {
          const Vec3 p = (i * from->points[t[0]] + j * from->points[t[1]] + (6 - i - j) * from->points[t[2]]) / 6.0;
          double least = 1e9;
          for (const Triangle& u : to->triangles)
            least = std::min(
                least, (closest_on_triangle({to->points[u[0]], to->points[u[1]], to->points[u[2]]}, p) - p).norm());
          most = std::max(most, least);
        }
  const double found = report.figures.at("hausdorff"), bound = report.figures.at("hausdorff at most");
  CHECK(most <= bound * (1 + 1e-9));
  CHECK(bound <= 1.06 * found);
  CHECK(most >= 0.8 * found);
  CHECK(most > report.figures.at("greatest error"));
}

TEST_CASE("decimate: stops at the first target; half without any") {
  Mesh a = bumpy_grid(20, 20), b = a, c = a, d = a;
  run_decimate(a, {.faces = 300});
  CHECK(live_faces(a) <= 300);
  CHECK(live_faces(a) >= 299);
  run_decimate(b, {.ratio = 0.25});
  CHECK(live_faces(b) <= 200);
  CHECK(live_faces(b) >= 199);
  run_decimate(c, {});
  CHECK(live_faces(c) <= 400);
  CHECK(live_faces(c) >= 399);
  run_decimate(d, {.faces = 300, .ratio = 0.25});
  CHECK(live_faces(d) <= 300);
  CHECK(live_faces(d) >= 299);
}

TEST_CASE("decimate: fewer faces than asked for are left bit for bit") {
  for (Mesh mesh : {icosahedron(), bumpy_grid(5, 5), Mesh()}) {
    const Snapshot before = snapshot(view_of(mesh));
    CHECK(run_decimate(mesh, {.faces = 50}).unchanged());
    CHECK(snapshot(view_of(mesh)) == before);
  }
}

TEST_CASE("decimate: topology stays, as far as it may go") {
  Mesh tetrahedron =
      make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  CHECK(run_decimate(tetrahedron, {.faces = 1}).unchanged());
  Mesh triangle = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const Report report = run_decimate(triangle, {.ratio = 0.1});
  CHECK(report.unchanged());
  CHECK(report.skipped.at("would change the topology") == 3);

  Mesh pieces = two_components();
  Mesh pipe = tube(30, 20, 1, 0, 3).mesh();
  Mesh holes = bumpy_grid(15, 15);
  for (const int f : {100, 101, 166, 310, 311, 316}) holes.delete_face(FaceHandle(f), true);
  for (Mesh mesh : {pieces, pipe, holes, lattice_sphere(30, 15)}) {
    REQUIRE(mesh_problems(mesh).empty());
    const int euler = euler_characteristic(mesh), loops = boundary_loops(mesh);
    run_decimate(mesh, {.faces = 1});
    CHECK(euler_characteristic(mesh) == euler);
    CHECK(boundary_loops(mesh) == loops);
  }
}

TEST_CASE("decimate: no triangle of a smooth height field is turned over, and no needle is made") {
  PatchShape hills;
  hills.nu = hills.nv = 40;
  hills.point = [](int i, int j) { return Vec3(i, j, 2 * std::sin(0.3 * i) * std::cos(0.25 * j)); };
  Mesh mesh = hills.mesh();
  run_decimate(mesh, {.ratio = 0.08, .min_roundness = 0.1});
  for (const FaceHandle f : mesh.faces()) {
    const HalfedgeHandle h = mesh.halfedge_handle(f);
    const Vec3 a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h)),
               c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
    const Vec3 normal = (b - a) % (c - a);
    CHECK(normal[2] > 0);
    CHECK(2 * std::sqrt(3.0) * normal.norm() >= 0.1 * ((b - a).sqrnorm() + (c - b).sqrnorm() + (a - c).sqrnorm()));
  }
}

TEST_CASE("decimate: sheets that nearly touch do not come to cross") {
  for (const double ratio : {0.5, 0.1}) {
    CAPTURE(ratio);
    Mesh mesh = crumpled_sheets(16, 0.05, 5);
    const Report report = run_decimate(mesh, {.ratio = ratio});
    CHECK(report.faces_removed > 0);
    const Soup out = to_soup(view_of(mesh));
    CHECK(self_intersections(out.points, out.triangles, Context(), Neighbors::judge).empty());
  }
}

TEST_CASE("decimate: values at vertices and corners are interpolated, seams and groups stay") {
  Mesh mesh = grid(16, 16);
  OpenMesh::VPropHandleT<double> plane;
  OpenMesh::HPropHandleT<double> chart;
  OpenMesh::FPropHandleT<int> group;
  mesh.add_property(plane, "v:plane");
  mesh.add_property(chart, "h:s");
  mesh.add_property(group, "f:group");
  const auto right_of = [&](FaceHandle f) { return mesh.calc_face_centroid(f)[0] > 8; };
  const auto above = [&](FaceHandle f) { return mesh.calc_face_centroid(f)[1] > 10; };
  for (const VertexHandle v : mesh.vertices()) mesh.property(plane, v) = 2 * mesh.point(v)[0] - 3 * mesh.point(v)[1];
  for (const FaceHandle f : mesh.faces()) {
    mesh.property(group, f) = above(f);
    for (const HalfedgeHandle h : mesh.fh_range(f))
      mesh.property(chart, h) = mesh.point(mesh.to_vertex_handle(h))[0] + (right_of(f) ? 100 : 0);
  }
  run_decimate(mesh, {.faces = 40});
  CHECK(live_faces(mesh) <= 40);
  for (const VertexHandle v : mesh.vertices())
    CHECK(mesh.property(plane, v) == doctest::Approx(2 * mesh.point(v)[0] - 3 * mesh.point(v)[1]));
  double upper = 0;
  for (const FaceHandle f : mesh.faces()) {
    if (mesh.property(group, f)) upper += mesh.calc_face_area(f);
    CHECK(mesh.property(group, f) == above(f));
    for (const HalfedgeHandle h : mesh.fh_range(f))
      CHECK(mesh.property(chart, h) ==
            doctest::Approx(mesh.point(mesh.to_vertex_handle(h))[0] + (right_of(f) ? 100 : 0)));
  }
  CHECK(upper == doctest::Approx(16 * 6));
}

TEST_CASE("decimate: degenerate triangles, needles and points that are not finite do not stop it") {
  Mesh mesh = bumpy_grid(14, 14);
  mesh.point(VertexHandle(40)) = mesh.point(VertexHandle(41));
  mesh.point(VertexHandle(100)) = mesh.point(VertexHandle(101)) * 0.999999 + mesh.point(VertexHandle(99)) * 0.000001;
  Mesh broken = mesh;
  run_decimate(mesh, {.ratio = 0.2});
  CHECK(live_faces(mesh) <= 14 * 14 * 2 / 5);
  broken.point(VertexHandle(77))[1] = std::nan("");
  broken.point(VertexHandle(30))[0] = std::numeric_limits<double>::infinity();
  run_decimate(broken, {.ratio = 0.2});
  Mesh flat = grid(5, 5);
  for (const VertexHandle v : flat.vertices()) flat.point(v) = Vec3(1, 2, 3);
  run_decimate(flat, {.ratio = 0.5});
}

TEST_CASE("decimate: the report lists what moved") {
  Mesh mesh = bumpy_grid(12, 12);
  const Mesh before = mesh;
  const Report report = run_decimate(mesh, {.ratio = 0.3});
  std::set<std::uint32_t> moved;
  for (const VertexHandle v : mesh.vertices())
    if (mesh.point(v) != before.point(v)) moved.insert(static_cast<std::uint32_t>(v.idx()));
  CHECK(std::set<std::uint32_t>(report.touched_vertices.begin(), report.touched_vertices.end()) == moved);
  CHECK(report.vertices_moved == moved.size());
}

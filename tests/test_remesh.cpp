#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "meshops/checks/mesh_distance.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/remesh.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/to_soup.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_remesh(Mesh& mesh, const RemeshOptions& options) {
  Context context;
  const Report report = remesh(view_of(mesh), options, context);
  CHECK_VALID_MESH(mesh);
  return report;
}

double share_in_range(const Mesh& mesh, double length) {
  double in = 0, all = 0;
  for (const EdgeHandle e : mesh.edges()) {
    const double relative = mesh.calc_edge_length(e) / length;
    in += relative >= 0.8 && relative <= 4.0 / 3;
    all += 1;
  }
  return in / all;
}

double smallest_angle(const Mesh& mesh) {
  double least = pi;
  for (const HalfedgeHandle h : mesh.halfedges())
    if (!mesh.is_boundary(h)) least = std::min(least, mesh.calc_sector_angle(h));
  return least * 180 / pi;
}

/// An octahedron whose triangles were cut into n x n and put onto the unit sphere.
Mesh octasphere(int n) {
  std::vector<Vec3> points;
  std::map<std::array<int, 3>, int> at;
  const auto vertex = [&](std::array<int, 3> g) {
    const auto [it, added] = at.try_emplace(g, static_cast<int>(points.size()));
    if (added) points.push_back(Vec3(g[0], g[1], g[2]).normalized());
    return it->second;
  };
  std::vector<std::array<int, 3>> triangles;
  for (int octant = 0; octant < 8; ++octant) {
    const int x = octant & 1 ? -1 : 1, y = octant & 2 ? -1 : 1, z = octant & 4 ? -1 : 1;
    const auto corner = [&](int i, int j) { return vertex({x * i, y * j, z * (n - i - j)}); };
    const auto add = [&](int a, int b, int c) {
      if (x * y * z > 0)
        triangles.push_back({a, b, c});
      else
        triangles.push_back({a, c, b});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + j + 1 < n) add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
  }
  return make_mesh(points, triangles);
}

/// Two flat wings, 10 x 12 each, that meet at a right angle along x = 0.
PatchShape wings(int cells = 10) {
  PatchShape s;
  s.nu = 2 * cells;
  s.nv = 12;
  s.point = [=](int i, int j) { return i < cells ? Vec3(0, j, cells - i) : Vec3(i - cells, j, 0); };
  return s;
}

}  // namespace

TEST_CASE("remesh: a sphere keeps its topology and place, with edges of the length asked for") {
  for (const double length : {0.07, 0.15, 0.3}) {
    CAPTURE(length);
    Mesh mesh = octasphere(16);
    const Soup before = to_soup(view_of(mesh));
    const Report report = run_remesh(mesh, {.length = length});
    CHECK(euler_characteristic(mesh) == 2);
    CHECK(boundary_loops(mesh) == 0);
    CHECK(share_in_range(mesh, length) > 0.9);
    CHECK(report.figures.at("edges in range") == doctest::Approx(share_in_range(mesh, length)));
    CHECK(smallest_angle(mesh) > 25);
    CHECK(report.figures.at("smallest angle") == doctest::Approx(smallest_angle(mesh)));
    // The input's own triangles lie that deep within the sphere.
    double deepest = 1;
    for (const Triangle& t : before.triangles)
      deepest = std::min(deepest, (before.points[t[0]] + before.points[t[1]] + before.points[t[2]]).norm() / 3);
    for (const VertexHandle v : mesh.vertices()) {
      CHECK(mesh.point(v).norm() <= 1 + 1e-12);
      CHECK(mesh.point(v).norm() >= deepest - 1e-3);
    }
    Context context;
    const MeshDistance distance = mesh_distance(to_soup(view_of(mesh)), before, {}, context);
    CHECK(report.figures.at("greatest distance") <= distance.forward.max_bound * (1 + 1e-9));
    CHECK(report.figures.at("greatest distance") >= 0.5 * distance.forward.max);
    // An equilateral triangle of that size (edges up to 4/3) in a sphere stands off by a third of its squared edge, by
    // two.
    CHECK(distance.hausdorff < 4.0 / 3 * 4.0 / 3 * length * length / 6 + 0.005);
  }
}

TEST_CASE("remesh: boundary and creases stay on their lines, corners where they are") {
  for (const double length : {0.6, 1.7}) {
    CAPTURE(length);
    Mesh mesh = wings().mesh();
    run_remesh(mesh, {.length = length});
    CHECK(euler_characteristic(mesh) == 1);
    CHECK(boundary_loops(mesh) == 1);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(240).epsilon(1e-12));
    CHECK(share_in_range(mesh, length) > 0.8);
    std::set<std::array<double, 3>> points;
    for (const VertexHandle v : mesh.vertices()) {
      const Vec3 p = mesh.point(v);
      points.insert({p[0], p[1], p[2]});
      CHECK((p[0] == 0 || p[2] == 0));  // nothing is rounded off
      if (mesh.is_boundary(v)) CHECK((p[0] == 10 || p[2] == 10 || p[1] == 0 || p[1] == 12));
    }
    for (const std::array<double, 3> corner :
         {std::array<double, 3>{10, 0, 0}, {10, 12, 0}, {0, 0, 10}, {0, 12, 10}, {0, 0, 0}, {0, 12, 0}})
      CHECK(points.count(corner) == 1);
    double crease = 0;
    for (const EdgeHandle e : mesh.edges()) {
      const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
      const Vec3 a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h));
      if (a[0] == 0 && a[2] == 0 && b[0] == 0 && b[2] == 0) crease += (b - a).norm();
    }
    CHECK(crease == doctest::Approx(12).epsilon(1e-12));
  }
}

TEST_CASE("remesh: a round rim slides on its polyline") {
  Mesh mesh = tube(48, 16, 1, 0, 2).mesh();
  const Mesh input = mesh;
  run_remesh(mesh, {.length = 0.2});
  CHECK(boundary_loops(mesh) == 2);
  for (const VertexHandle v : mesh.vertices()) {
    if (!mesh.is_boundary(v)) continue;
    double distance = 1;
    for (const EdgeHandle e : input.edges()) {
      if (!input.is_boundary(e)) continue;
      const HalfedgeHandle h = input.halfedge_handle(e, 0);
      distance = std::min(distance, (closest_on_segment(input.point(input.from_vertex_handle(h)),
                                                        input.point(input.to_vertex_handle(h)), mesh.point(v)) -
                                     mesh.point(v))
                                        .norm());
    }
    CHECK(distance < 1e-14);
  }
}

TEST_CASE("remesh: needles become good triangles, whatever the size and place") {
  struct Place {
    double scale;
    Vec3 offset;
  };
  for (const Place& place :
       {Place{1, {0, 0, 0}}, Place{1e-6, {0, 0, 0}}, Place{1e6, {1e6, 1e6, 1e6}}, Place{1, {1e6, -1e6, 0}}}) {
    CAPTURE(place.scale);
    PatchShape s;
    s.nu = 40;
    s.nv = 4;
    s.point = [&](int i, int j) { return place.offset + Vec3(0.1 * i, j, 0) * place.scale; };
    Mesh mesh = s.mesh();
    run_remesh(mesh, {.length = 0.4 * place.scale});
    CHECK(smallest_angle(mesh) > 20);
    CHECK(share_in_range(mesh, 0.4 * place.scale) > 0.75);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(16 * place.scale * place.scale).epsilon(1e-6));
  }
}

TEST_CASE("remesh: adaptive edges are short where the surface is curved, and the error is kept") {
  // A plane with a round hill, flat around.
  PatchShape s;
  s.nu = s.nv = 60;
  s.point = [](int i, int j) {
    const double x = (i - 30) / 10.0, y = (j - 30) / 10.0;
    return Vec3(x, y, std::exp(-3 * (x * x + y * y)));
  };
  Mesh mesh = s.mesh();
  const Soup before = to_soup(view_of(mesh));
  const double error = 0.01;
  const Report report = run_remesh(mesh, {.length = 1, .adaptive = true, .max_error = error});
  CHECK(report.figures.at("greatest distance") <= 1.5 * error);
  double inside = 0, outside = 0, n_inside = 0, n_outside = 0;
  for (const EdgeHandle e : mesh.edges()) {
    const Vec3 m = mesh.calc_edge_midpoint(e);
    const double r = std::hypot(m[0], m[1]);
    if (r < 0.5) inside += mesh.calc_edge_length(e), n_inside += 1;
    if (r > 2) outside += mesh.calc_edge_length(e), n_outside += 1;
  }
  CHECK(outside / n_outside > 2 * inside / n_inside);
  Context context;
  const MeshDistance distance = mesh_distance(before, to_soup(view_of(mesh)), {}, context);
  CHECK(distance.hausdorff < 2 * error);
  CHECK(live_faces(mesh) < 7200 / 5);

  Mesh other = s.mesh();
  const Snapshot untouched = snapshot(view_of(other));
  CHECK_THROWS_AS(remesh(view_of(other), {.adaptive = true}, context), InvalidInput);
  CHECK(snapshot(view_of(other)) == untouched);
}

TEST_CASE("remesh: no triangle of a height field is turned over, and none cross") {
  PatchShape hills;
  hills.nu = hills.nv = 30;
  hills.point = [](int i, int j) { return Vec3(i, j, 1.5 * std::sin(0.4 * i) * std::cos(0.3 * j)); };
  for (const double length : {0.7, 1.5, 2.5}) {
    Mesh mesh = hills.mesh();
    run_remesh(mesh, {.length = length});
    for (const FaceHandle f : mesh.faces()) CHECK(mesh.calc_face_normal(f)[2] > 0);
    const Soup out = to_soup(view_of(mesh));
    Context context;
    CHECK(self_intersections(out.points, out.triangles, context, Neighbors::judge).empty());
  }
}

TEST_CASE("remesh: sheets that nearly touch do not come to cross") {
  for (const double length : {0.6, 1.0, 2.5})
    for (const double max_error : {std::numeric_limits<double>::infinity(), 0.1}) {
      CAPTURE(length);
      Mesh mesh = crumpled_sheets(12, 0.05, 5);
      const Report report = run_remesh(mesh, {.length = length, .max_error = max_error});
      CHECK(report.faces_removed > 0);
      const Soup out = to_soup(view_of(mesh));
      CHECK(self_intersections(out.points, out.triangles, Context(), Neighbors::judge).empty());
      CHECK(report.figures.count("crossing pairs") == 0);
    }
}

TEST_CASE("remesh: sheets that cross do so in more pairs where they get finer, and a note says where") {
  // Two squares, not of one size, across each other in the line from (0.5, 2.07, 2) to (3.5, 2.07, 2).
  Mesh mesh;
  for (const bool standing : {false, true}) {
    const auto at = [&](double x, double y) {
      return mesh.add_vertex(standing ? Vec3(1.1 * x - 0.21, 2.07, 1.03 * y) : Vec3(x, y, 2));
    };
    const std::array v{at(0.5, 0.3), at(3.5, 0.3), at(3.5, 3.7), at(0.5, 3.7)};
    mesh.add_face(v[0], v[1], v[2]);
    mesh.add_face(v[0], v[2], v[3]);
  }
  Soup soup = to_soup(view_of(mesh));
  const auto pairs = [&] {
    return self_intersections(soup.points, soup.triangles, Context(), Neighbors::judge).size();
  };
  const std::size_t before = pairs();
  REQUIRE(before > 0);
  const Report report = run_remesh(mesh, {.length = 0.4});
  soup = to_soup(view_of(mesh));
  const std::size_t after = pairs();
  CHECK(after > before);
  CHECK(report.figures.at("crossing pairs") == static_cast<double>(after));
  const auto note = std::ranges::find_if(report.notes, [](const std::string& n) { return n.find(" cross") != n.npos; });
  REQUIRE(note != report.notes.end());
  unsigned long now = 0, then = 0;
  double x = 0, y = 0, z = 0;
  REQUIRE(std::sscanf(note->c_str(), "%lu pairs of triangles cross, %lu did before; one at (%lf, %lf, %lf)", &now,
                      &then, &x, &y, &z) == 5);
  CHECK(now == after);
  CHECK(then == before);
  CHECK(x > 0.5);
  CHECK(x < 3.5);
  CHECK(std::hypot(y - 2.07, z - 2) < 0.4);
}

TEST_CASE("remesh: small round holes, slots and corners stay, however long the edges are to be") {
  // A plate, cut out cell by cell, whose outline turns by 45 degrees at some places: no corners by themselves.
  const double length = 6, limit = 0.05 * length;
  PatchShape plate;
  plate.nu = plate.nv = 24;
  plate.keep = [](int i, int j) { return i < 10 || i >= 14 || j < 10 || j >= 14; };
  plate.point = [](int i, int j) {
    // The rim of the hole becomes an octagon, 1 to 2 wide.
    const double x = i - 12, y = j - 12;
    if (std::max(std::abs(x), std::abs(y)) != 2) return Vec3(x, y, 0);
    return std::abs(x) == std::abs(y) ? Vec3(0.75 * x, 0.75 * y, 0) : Vec3(x, y, 0);
  };
  Mesh mesh = plate.mesh();
  const Soup before = to_soup(view_of(mesh));
  run_remesh(mesh, {.length = length});
  CHECK(live_faces(mesh) < static_cast<int>(before.triangles.size()) / 4);
  // Every place of the old rim is near the new one: exactly, over the old corners, as distance to a chord is convex.
  int rim = 0;
  for (const Vec3& p : before.points) {
    const double across = std::max(std::abs(p[0]), std::abs(p[1]));
    if (across > 2 || across <= 1) continue;
    ++rim;
    double least = 1e9;
    for (const EdgeHandle e : mesh.edges()) {
      if (!mesh.is_boundary(e)) continue;
      const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
      const Vec3 q =
          closest_on_segment(mesh.point(mesh.from_vertex_handle(h)), mesh.point(mesh.to_vertex_handle(h)), p);
      least = std::min(least, (p - q).norm());
    }
    CHECK(least <= 2 * limit);
  }
  CHECK(rim == 16);
}

TEST_CASE("remesh: values are those of the input at the new places; seams and groups stay") {
  Mesh mesh = grid(12, 12);
  OpenMesh::VPropHandleT<double> plane;
  OpenMesh::VPropHandleT<int> point_index;
  OpenMesh::HPropHandleT<double> chart;
  OpenMesh::FPropHandleT<int> group;
  mesh.add_property(plane, "v:plane");
  mesh.add_property(point_index, property::point_index);
  mesh.add_property(chart, "h:s");
  mesh.add_property(group, "f:group");
  const auto right_of = [&](FaceHandle f) { return mesh.calc_face_centroid(f)[0] > 6; };
  const auto above = [&](FaceHandle f) { return mesh.calc_face_centroid(f)[1] > 8; };
  for (const VertexHandle v : mesh.vertices()) {
    mesh.property(plane, v) = 2 * mesh.point(v)[0] - 3 * mesh.point(v)[1];
    mesh.property(point_index, v) = v.idx();
  }
  for (const FaceHandle f : mesh.faces()) {
    mesh.property(group, f) = above(f);
    for (const HalfedgeHandle h : mesh.fh_range(f))
      mesh.property(chart, h) = mesh.point(mesh.to_vertex_handle(h))[0] + (right_of(f) ? 100 : 0);
  }
  const Mesh before = mesh;
  run_remesh(mesh, {.length = 0.7});
  for (const VertexHandle v : mesh.vertices()) {
    CHECK(mesh.property(plane, v) == doctest::Approx(2 * mesh.point(v)[0] - 3 * mesh.point(v)[1]));
    const bool measured = v.idx() < static_cast<int>(before.n_vertices()) && before.point(v) == mesh.point(v);
    CHECK(mesh.property(point_index, v) == (measured ? v.idx() : -1));
  }
  double upper = 0;
  for (const FaceHandle f : mesh.faces()) {
    CHECK(mesh.property(group, f) == above(f));
    if (above(f)) upper += mesh.calc_face_area(f);
    for (const HalfedgeHandle h : mesh.fh_range(f))
      CHECK(mesh.property(chart, h) ==
            doctest::Approx(mesh.point(mesh.to_vertex_handle(h))[0] + (right_of(f) ? 100 : 0)));
  }
  CHECK(upper == doctest::Approx(12 * 4));
}

TEST_CASE("remesh: a triangle, several parts, degenerate and duplicate triangles") {
  Mesh triangle = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  run_remesh(triangle, {.length = 0.2});
  CHECK(mesh_area(view_of(triangle)) == doctest::Approx(0.5));
  CHECK(live_faces(triangle) > 10);
  Mesh parts = two_components();
  run_remesh(parts, {.length = 0.4});
  CHECK(euler_characteristic(parts) == 3);
  Mesh flat = grid(4, 4);
  for (const VertexHandle v : flat.vertices()) flat.point(v) = Vec3(1, 2, 3);
  run_remesh(flat, {});
  Mesh slivers = grid(8, 8);
  slivers.point(VertexHandle(30)) = slivers.point(VertexHandle(31));
  slivers.point(VertexHandle(50)) = 0.5 * (slivers.point(VertexHandle(49)) + slivers.point(VertexHandle(59)));
  run_remesh(slivers, {.length = 0.5});
  CHECK(euler_characteristic(slivers) == 1);
  Mesh broken = grid(4, 4);
  broken.point(VertexHandle(7))[1] = std::nan("");
  Context context;
  CHECK_THROWS_AS(remesh(view_of(broken), {}, context), InvalidInput);
  Mesh huge = grid(4, 4);
  CHECK_THROWS_AS(remesh(view_of(huge), {.length = 1e-7}, context), InvalidInput);
  CHECK(live_faces(huge) == 32);
}

TEST_CASE("remesh: an even mesh is left as it is") {
  Mesh mesh = icosahedron();
  const Snapshot before = snapshot(view_of(mesh));
  CHECK(run_remesh(mesh, {}).unchanged());
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("remesh: beside a rim of long edges that may not change it comes to an end") {
  PatchShape s;
  s.nu = 6;
  s.nv = 4;
  s.point = [](int i, int j) { return Vec3(i, 5 * j, 0); };
  Mesh mesh = s.mesh();
  std::vector<FaceHandle> chosen;
  for (const FaceHandle f : mesh.faces())
    if (mesh.calc_face_centroid(f)[0] < 3) chosen.push_back(f);
  const Selection selection = Selection::of_faces(mesh, chosen);
  Context context;
  const Report report = remesh(view_of(mesh).with(selection), {.length = 0.7}, context);
  CHECK_VALID_MESH(mesh);
  CHECK(report.vertices_added > 20);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(120));
}

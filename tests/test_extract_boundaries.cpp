#include <doctest/doctest.h>

#include <set>

#include "meshops/operators/extract_boundaries.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// 12 x 10 cells in the plane with a hole of 3 x 2 cells, in which an island of one cell lies, and a hole of one cell.
PatchShape sheet_with_holes() {
  PatchShape s;
  s.nu = 12;
  s.nv = 10;
  s.keep = [](int i, int j) {
    const bool wide = i >= 2 && i < 7 && j >= 2 && j < 7;
    const bool island = i == 4 && j == 4;
    return (!wide || island) && !(i == 9 && j == 5);
  };
  return s;
}

}  // namespace

TEST_CASE("boundary_loops: tells outer and nested loops of each component apart") {
  Mesh mesh = sheet_with_holes().mesh();
  const auto loops = tri::boundary_loops(view_of(mesh));
  REQUIRE(loops.size() == 4);
  std::multiset<double> outer, nested;
  for (const auto& loop : loops) {
    (loop.outer ? outer : nested).insert(loop.length);
    CHECK(loop.simple);
    CHECK(loop.halfedges.size() == loop.polyline.size());
    if (loop.outer)
      CHECK(loop.parent == -1);
    else
      CHECK((loops[loop.parent].outer && loops[loop.parent].component == loop.component));
  }
  CHECK(outer == std::multiset<double>{4, 44});   // the island and the sheet
  CHECK(nested == std::multiset<double>{4, 20});  // around the island, and the small hole
}

TEST_CASE("boundary_loops: a hole is nested though its rim is longer than the outer one") {
  PatchShape s;  // a bent sheet with a hole like a double comb
  s.nu = s.nv = 40;
  s.point = [](int i, int j) { return Vec3(i, j, 0.02 * (i - 20) * (i - 20)); };
  s.keep = [](int i, int j) { return !(i > 0 && i < 39 && j > 0 && j < 39 && (i % 2 == 1 || j == 20)); };
  Mesh mesh = s.mesh();
  const auto loops = tri::boundary_loops(view_of(mesh));
  REQUIRE(loops.size() == 2);
  const auto& outer = loops[0].outer ? loops[0] : loops[1];
  const auto& hole = loops[0].outer ? loops[1] : loops[0];
  CHECK(outer.outer);
  CHECK_FALSE(hole.outer);
  CHECK(hole.length > 5 * outer.length);
  CHECK(outer.halfedges.size() == 160);
}

TEST_CASE("boundary_loops: of a tube the longer rim is the outer one; half-edges have no face and follow each other") {
  PatchShape s = tube(16, 3, 1, 0, 2);
  const auto straight = s.point;
  s.point = [=](int i, int j) { return straight(i, j) * (j == 0 ? 1.0 : 1 + 0.1 * j); };
  Mesh mesh = s.mesh();
  const auto loops = tri::boundary_loops(view_of(mesh));
  REQUIRE(loops.size() == 2);
  CHECK(loops[0].outer != loops[1].outer);
  const auto& outer = loops[0].outer ? loops[0] : loops[1];
  const auto& other = loops[0].outer ? loops[1] : loops[0];
  CHECK(outer.length > other.length);
  CHECK(outer.length == doctest::Approx(16 * 2 * 1.3 * std::sin(pi / 16)));
  for (const auto& loop : loops)
    for (std::size_t i = 0; i < loop.halfedges.size(); ++i) {
      const auto h = loop.halfedges[i], next = loop.halfedges[(i + 1) % loop.halfedges.size()];
      CHECK_FALSE(mesh.face_handle(h).is_valid());
      CHECK(mesh.to_vertex_handle(h) == mesh.from_vertex_handle(next));
      CHECK(loop.polyline[i] == mesh.point(mesh.from_vertex_handle(h)));
    }
}

TEST_CASE("boundary_loops: sees a loop that meets itself, and passes over deleted faces") {
  Mesh mesh = grid(4, 4);
  // Two triangles that meet in one vertex.
  Mesh hourglass;
  std::vector<VertexHandle> v;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0), Vec3(-1, -1, 0)})
    v.push_back(hourglass.add_vertex(p));
  hourglass.add_face(v[0], v[1], v[2]);
  hourglass.add_face(v[0], v[3], v[4]);
  int visits_twice = 0;
  for (const auto& loop : tri::boundary_loops(view_of(hourglass))) visits_twice += !loop.simple;
  CHECK(visits_twice == 1);

  for (const auto f : mesh.faces()) mesh.delete_face(f, false);
  CHECK(tri::boundary_loops(view_of(mesh)).empty());
  Mesh empty;
  CHECK(tri::boundary_loops(view_of(empty)).empty());
}

TEST_CASE("extract_boundaries: writes the loops as properties and changes nothing else") {
  Mesh mesh = sheet_with_holes().mesh();
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  for (int round = 0; round < 2; ++round) {
    const Report report = extract_boundaries(view_of(mesh), {}, context);
    CHECK(report.unchanged());
    CHECK(report.figures.at("loops") == 4);
    CHECK(report.figures.at("outer loops") == 2);
    CHECK(report.figures.at("nested loops") == 2);
    CHECK(report.figures.at("boundary length") == doctest::Approx(4 + 44 + 4 + 20));
    CHECK(report.notes.size() == 4);
    CHECK(snapshot(view_of(mesh)) == before);
  }
  OpenMesh::VPropHandleT<int> vertex_loop;
  OpenMesh::EPropHandleT<int> edge_loop, edge_outer;
  REQUIRE(mesh.get_property_handle(vertex_loop, property::boundary_loop));
  REQUIRE(mesh.get_property_handle(edge_loop, property::boundary_loop));
  REQUIRE(mesh.get_property_handle(edge_outer, property::boundary_outer));
  const auto loops = tri::boundary_loops(view_of(mesh));
  for (const auto e : mesh.edges()) {
    const int loop = mesh.property(edge_loop, e);
    CHECK((loop >= 0) == mesh.is_boundary(e));
    CHECK(mesh.property(edge_outer, e) == (loop < 0 ? -1 : loops[loop].outer));
  }
  for (const auto v : mesh.vertices())
    if (!mesh.is_isolated(v)) CHECK((mesh.property(vertex_loop, v) >= 0) == mesh.is_boundary(v));
}

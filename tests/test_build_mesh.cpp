#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "mesh_check.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/error.hpp"
#include "meshops/to_soup.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Soup soup_of(const Mesh& mesh) {
  Soup soup;
  for (const VertexHandle v : mesh.vertices()) soup.points.push_back(mesh.point(v));
  for (const FaceHandle f : mesh.faces()) {
    Triangle t{};
    int k = 0;
    for (const VertexHandle v : mesh.fv_range(f)) t[k++] = static_cast<std::uint32_t>(v.idx());
    soup.triangles.push_back(t);
  }
  return soup;
}

/// Corners of a face as points of the soup, beginning with its stored half-edge.
Triangle corners_of_face(const BuiltMesh& built, FaceHandle f) {
  const HalfedgeHandle h = built.mesh.halfedge_handle(f);
  const auto point = [&](HalfedgeHandle side) { return built.point_of(built.mesh.from_vertex_handle(side)); };
  const HalfedgeHandle next = built.mesh.next_halfedge_handle(h);
  return {point(h), point(next), point(built.mesh.next_halfedge_handle(next))};
}

Triangle sorted(Triangle t) {
  std::ranges::sort(t);
  return t;
}

/// What holds for every soup: a valid mesh with the soup's triangles, in order, and its points, copies at their places.
void check_faithful(const Soup& soup, const BuiltMesh& built) {
  CHECK_VALID_MESH(built.mesh);
  REQUIRE(built.points == soup.points.size());
  REQUIRE(built.repairs.copied_points.size() == built.report.vertices_added);
  REQUIRE(built.mesh.n_vertices() == soup.points.size() + built.report.vertices_added);
  for (const VertexHandle v : built.mesh.vertices()) {
    if (v.idx() < static_cast<int>(soup.points.size()))
      REQUIRE(built.point_of(v) == static_cast<std::uint32_t>(v.idx()));
    REQUIRE(built.mesh.point(v) == soup.points[built.point_of(v)]);
  }
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    const auto [a, b, c] = soup.triangles[i];
    if (a != b && b != c && c != a) expected.push_back(i);
  }
  REQUIRE(built.mesh.n_faces() == expected.size());
  for (const FaceHandle f : built.mesh.faces()) REQUIRE(built.triangle_of(f) == expected[f.idx()]);
  for (const FaceHandle f : built.mesh.faces())
    REQUIRE(sorted(corners_of_face(built, f)) == sorted(soup.triangles[built.triangle_of(f)]));
  REQUIRE(built.report.faces_removed == soup.triangles.size() - expected.size());
}

BuiltMesh build(const Soup& soup) {
  Context context;
  BuiltMesh built = build_mesh(soup, context);
  check_faithful(soup, built);
  return built;
}

/// The eight triangles of an octahedron of radius 1 about `center`; its tips in x, y, z order, positive first.
void add_octahedron(Soup& soup, const Vec3& center) {
  const auto n = static_cast<std::uint32_t>(soup.points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      Vec3 tip(0, 0, 0);
      tip[axis] = sign;
      soup.points.push_back(center + tip);
    }
  }
  for (const std::uint32_t x : {0u, 1u})
    for (const std::uint32_t y : {2u, 3u})
      for (const std::uint32_t z : {4u, 5u}) {
        const bool outward = (x + y + z) % 2 == 0;
        soup.triangles.push_back(outward ? Triangle{n + x, n + y, n + z} : Triangle{n + y, n + x, n + z});
      }
}

/// Replaces one point by another in all triangles.
void merge(Soup& soup, std::uint32_t gone, std::uint32_t kept) {
  for (Triangle& t : soup.triangles) std::ranges::replace(t, gone, kept);
}

double figure(const BuiltMesh& built, const char* name) {
  const auto it = built.report.figures.find(name);
  return it == built.report.figures.end() ? 0 : it->second;
}

int components(const Mesh& mesh) {
  std::vector<int> parent(mesh.n_vertices());
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<int>(i);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const EdgeHandle e : mesh.edges()) {
    const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
    parent[root(mesh.from_vertex_handle(h).idx())] = root(mesh.to_vertex_handle(h).idx());
  }
  std::set<int> roots;
  for (const VertexHandle v : mesh.vertices())
    if (!mesh.is_isolated(v)) roots.insert(root(v.idx()));
  return static_cast<int>(roots.size());
}

}  // namespace

TEST_CASE("build_mesh: a manifold soup comes back as it was, with a zero report") {
  for (const Mesh& mesh : {icosahedron(), bumpy_grid(6, 5), two_components()}) {
    const Soup soup = soup_of(mesh);
    BuiltMesh built = build(soup);
    CHECK(built.report.unchanged());
    CHECK(built.report.figures.empty());
    CHECK(built.report.notes.empty());
    CHECK(euler_characteristic(built.mesh) == euler_characteristic(mesh));
    CHECK(boundary_loops(built.mesh) == boundary_loops(mesh));
    const Soup back = to_soup(view_of(built.mesh));
    CHECK(back.points == soup.points);
    CHECK(back.triangles == soup.triangles);
  }
}

TEST_CASE("build_mesh: nothing, points alone and one triangle") {
  CHECK(build({}).mesh.n_vertices() == 0);
  CHECK(build({.points = {{0, 0, 0}, {1, 0, 0}}}).mesh.n_vertices() == 2);
  const BuiltMesh built = build({.points = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{3, 1, 2}}});
  CHECK(built.mesh.n_edges() == 3);
  CHECK(built.mesh.is_isolated(VertexHandle(0)));
  CHECK(corners_of_face(built, FaceHandle(0)) == Triangle{3, 1, 2});
}

TEST_CASE("build_mesh: triangles that name a vertex twice are set aside and named") {
  Soup soup = soup_of(grid(2, 1));
  soup.triangles.insert(soup.triangles.begin() + 1, {0, 0, 1});
  soup.triangles.push_back({4, 4, 4});
  const BuiltMesh built = build(soup);
  CHECK(built.report.faces_removed == 2);
  CHECK(built.report.skipped.at("names a vertex twice") == 2);
  CHECK(built.report.notes.front() == "set aside triangle: 1");
  CHECK(built.set_aside == std::vector<std::uint32_t>{1, 5});
  CHECK(boundary_loops(built.mesh) == 1);
}

TEST_CASE("build_mesh: a triangle without area but three vertices is kept") {
  const BuiltMesh built =
      build({.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, .triangles = {{0, 1, 2}, {2, 1, 3}}});
  CHECK(built.report.unchanged());
  CHECK(built.mesh.n_faces() == 2);
}

TEST_CASE("build_mesh: reversed triangles are turned, the majority keeps its direction") {
  Soup soup = soup_of(icosahedron());
  for (const int i : {3, 4, 11}) std::swap(soup.triangles[i][0], soup.triangles[i][1]);
  const BuiltMesh built = build(soup);
  CHECK(boundary_loops(built.mesh) == 0);
  CHECK(built.report.touched_faces == std::vector<std::uint32_t>{3, 4, 11});
  CHECK(figure(built, "triangles reversed") == 3);
  CHECK(built.report.vertices_added == 0);

  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  const BuiltMesh inside_out = build(soup);
  CHECK(inside_out.report.touched_faces == std::vector<std::uint32_t>{3, 4, 11});
}

TEST_CASE("build_mesh: a strip with half a twist is cut, and stays a strip") {
  Soup soup;
  const std::uint32_t n = 9;
  for (std::uint32_t i = 0; i < n; ++i)
    for (const double side : {-0.3, 0.3}) {
      const double angle = 2 * 3.14159265 * i / n;
      const double r = 2 + side * std::cos(angle / 2);
      soup.points.emplace_back(r * std::cos(angle), r * std::sin(angle), side * std::sin(angle / 2));
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    soup.triangles.push_back({a, b, c});
    soup.triangles.push_back({b, d, c});
  }
  const BuiltMesh built = build(soup);
  CHECK(figure(built, "edges cut") == 1);
  CHECK(built.report.vertices_added == 2);
  CHECK(euler_characteristic(built.mesh) == 1);
  CHECK(boundary_loops(built.mesh) == 1);
}

TEST_CASE("build_mesh: two solids that touch in a vertex or an edge come apart, both closed") {
  Soup vertex;
  add_octahedron(vertex, {0, 0, 0});
  add_octahedron(vertex, {2, 0, 0});
  merge(vertex, 7, 0);
  const BuiltMesh apart = build(vertex);
  CHECK(apart.report.vertices_added == 1);
  CHECK(boundary_loops(apart.mesh) == 0);
  CHECK(components(apart.mesh) == 2);

  // The edge from the tip in x to the tip in y of one is the edge from -y to -x of the other.
  Soup edge;
  add_octahedron(edge, {0, 0, 0});
  add_octahedron(edge, {1, 1, 0});
  merge(edge, 9, 0);
  merge(edge, 7, 2);
  for (const bool shuffled : {false, true}) {
    if (shuffled) std::ranges::reverse(edge.triangles);
    const BuiltMesh split = build(edge);
    CHECK(figure(split, "edges split") == 1);
    CHECK(split.repairs.crowded == std::vector<std::array<std::uint32_t, 2>>{{0, 2}});
    CHECK(split.report.vertices_added == 2);
    CHECK(boundary_loops(split.mesh) == 0);
    CHECK(components(split.mesh) == 2);
    // Material stays inside: every closed part has the volume of an octahedron, 4/3.
    double volume = 0;
    for (const FaceHandle f : split.mesh.faces()) {
      const Triangle t = corners_of_face(split, f);
      volume += (edge.points[t[0]] | (edge.points[t[1]] % edge.points[t[2]])) / 6;
    }
    CHECK(volume == doctest::Approx(8.0 / 3));
  }
}

TEST_CASE("build_mesh: a duplicate triangle leaves the surface closed and hangs loose") {
  Soup soup = soup_of(icosahedron());
  soup.triangles.push_back(soup.triangles[7]);
  const BuiltMesh built = build(soup);
  CHECK(components(built.mesh) == 2);
  CHECK(boundary_loops(built.mesh) == 1);
  CHECK(built.report.vertices_added == 3);

  const BuiltMesh twice = build({.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}, {1, 2, 0}}});
  CHECK(components(twice.mesh) == 2);
  CHECK(figure(twice, "triangles reversed") == 0);
}

TEST_CASE("build_mesh: three sheets on one edge, and a bow-tie of two triangles") {
  const BuiltMesh sheets = build({.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                                  .triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}});
  CHECK(figure(sheets, "edges split") == 1);
  CHECK(components(sheets.mesh) == 2);
  const BuiltMesh bow_tie =
      build({.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, .triangles = {{0, 1, 2}, {0, 3, 4}}});
  CHECK(bow_tie.report.vertices_added == 1);
  CHECK(bow_tie.report.touched_vertices == std::vector<std::uint32_t>{5});
  CHECK(bow_tie.point_of(VertexHandle(5)) == 0);
}

TEST_CASE("build_mesh: any soup gives a valid mesh with all its triangles") {
  // Few points and many triangles: every kind of crowding, duplicates and reversals, edges whose sheets meet at both
  // ends.
  std::mt19937 random(7);
  for (int run = 0; run < 400; ++run) {
    CAPTURE(run);
    Soup soup;
    const std::uint32_t points = 4 + run % 12;
    const int triangles = 2 + run % 37;
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::uniform_int_distribution<std::uint32_t> index(0, points - 1);
    for (std::uint32_t i = 0; i < points; ++i)
      soup.points.emplace_back(coordinate(random), coordinate(random), run % 3 ? coordinate(random) : 0.0);
    for (int i = 0; i < triangles; ++i) soup.triangles.push_back({index(random), index(random), index(random)});
    build(soup);
  }
}

TEST_CASE("build_mesh: the result does not depend on where a triangle begins") {
  Soup soup = soup_of(bumpy_grid(8, 8));
  const BuiltMesh before = build(soup);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    std::ranges::rotate(soup.triangles[i], soup.triangles[i].begin() + static_cast<std::ptrdiff_t>(i % 3));
  const BuiltMesh after = build(soup);
  CHECK(after.report.unchanged());
  CHECK(after.mesh.n_edges() == before.mesh.n_edges());
}

TEST_CASE("build_mesh: attributes become properties, copies included, and come back") {
  Soup soup;
  add_octahedron(soup, {0, 0, 0});
  add_octahedron(soup, {2, 0, 0});
  merge(soup, 7, 0);
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    const double x = static_cast<double>(i);
    soup.vertex_scalars["deviation"].push_back(0.125 * x);
    soup.vertex_scalars["point_index"].push_back(100 + x);
    soup.vertex_scalars["u"].push_back(x);
    soup.vertex_scalars["v"].push_back(-x);
    soup.vertex_colors.push_back({static_cast<std::uint8_t>(i), 2, 3});
    soup.vertex_normals.emplace_back(0, 0, x);
  }
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) soup.face_scalars["area"].push_back(static_cast<double>(i));
  BuiltMesh built = build(soup);
  const VertexHandle copy(12);
  OpenMesh::VPropHandleT<double> deviation;
  OpenMesh::VPropHandleT<int> index;
  OpenMesh::VPropHandleT<Vec2> uv;
  REQUIRE(built.mesh.get_property_handle(deviation, property::deviation));
  REQUIRE(built.mesh.get_property_handle(index, property::point_index));
  REQUIRE(built.mesh.get_property_handle(uv, property::uv));
  CHECK(built.mesh.property(index, copy) == 100);
  CHECK(built.mesh.property(uv, VertexHandle(3)) == Vec2(3, -3));

  built.mesh.delete_face(FaceHandle(2), false);
  built.mesh.delete_vertex(VertexHandle(7), false);
  const Soup back = to_soup(view_of(built.mesh));
  CHECK(back.points.size() == 12);
  CHECK(back.triangles.size() == 15);
  CHECK(back.vertex_scalars.at("point_index")[7] == 108);
  CHECK(back.vertex_scalars.at("deviation")[11] == 0);
  CHECK(back.vertex_scalars.at("v")[3] == -3);
  CHECK(back.vertex_colors[3][0] == 3);
  CHECK(back.vertex_normals[4] == Vec3(0, 0, 4));
  CHECK(back.face_scalars.at("area")[2] == 3);
}

TEST_CASE("build_mesh: known neighbours give the same mesh, wrong ones are refused") {
  const Soup soup = soup_of(bumpy_grid(7, 6));
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::int32_t> owner;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      owner[{soup.triangles[i][k], soup.triangles[i][(k + 1) % 3]}] = static_cast<std::int32_t>(i);
  std::vector<std::array<std::int32_t, 3>> neighbors(soup.triangles.size());
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const auto it = owner.find({soup.triangles[i][(k + 2) % 3], soup.triangles[i][(k + 1) % 3]});
      neighbors[i][k] = it == owner.end() ? -1 : it->second;
    }
  Context context;
  BuiltMesh known = build_mesh(soup.points, soup.triangles, neighbors, context);
  check_faithful(soup, known);
  BuiltMesh found = build(soup);
  CHECK(snapshot(view_of(known.mesh)) == snapshot(view_of(found.mesh)));
  Mesh own;
  CHECK(build_mesh_into(own, soup.points, soup.triangles, neighbors, context).empty());
  CHECK(snapshot(view_of(own)) == snapshot(view_of(found.mesh)));
  CHECK_THROWS_AS(build_mesh_into(own, soup.points, soup.triangles, neighbors, context), InvalidInput);

  std::swap(neighbors[5][0], neighbors[5][1]);
  CHECK_THROWS_AS(build_mesh(soup.points, soup.triangles, neighbors, context), InvalidInput);
  neighbors.pop_back();
  CHECK_THROWS_AS(build_mesh(soup.points, soup.triangles, neighbors, context), InvalidInput);
}

TEST_CASE("build_mesh: tens of thousands of triangles in any order give the same mesh on one thread and on all") {
  Soup soup = soup_of(bumpy_grid(150, 150));
  std::shuffle(soup.triangles.begin(), soup.triangles.end(), std::mt19937(7));
  Context one, all;
  one.threads = 1;
  BuiltMesh serial = build_mesh(soup, one), parallel = build_mesh(soup, all);
  CHECK(serial.report.vertices_added == 0);
  CHECK_VALID_MESH(serial.mesh);
  CHECK(snapshot(view_of(serial.mesh)) == snapshot(view_of(parallel.mesh)));
  // Edges are numbered by their first side in the order of the triangles.
  int next_edge = 0;
  for (const FaceHandle f : serial.mesh.faces()) {
    HalfedgeHandle h = serial.mesh.halfedge_handle(f);
    REQUIRE(corners_of_face(serial, f) == soup.triangles[f.idx()]);
    for (int k = 0; k < 3; ++k, h = serial.mesh.next_halfedge_handle(h)) {
      const int edge = serial.mesh.edge_handle(h).idx();
      REQUIRE(edge <= next_edge);
      if (edge == next_edge) {
        REQUIRE(h.idx() == 2 * edge);
        ++next_edge;
      }
    }
  }
  CHECK(next_edge == static_cast<int>(serial.mesh.n_edges()));
}

TEST_CASE("build_mesh: an index out of range and an attribute of the wrong length are refused") {
  Context context;
  CHECK_THROWS_AS(build_mesh({.points = {{0, 0, 0}}, .triangles = {{0, 1, 2}}}, context), InvalidInput);
  CHECK_THROWS_AS(build_mesh({.points = {{0, 0, 0}}, .vertex_scalars = {{"deviation", {1, 2}}}}, context),
                  InvalidInput);
  context.cancel();
  CHECK_THROWS_AS(build_mesh(soup_of(grid(2, 2)), context), Cancelled);
}

TEST_CASE("build_mesh: values of corners and labels go to the mesh and come back, also where triangles are reversed") {
  Soup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 2, 4}};  // the last one disagrees
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) soup.corner_scalars["s"].push_back(v + 0.5);
  soup.face_scalars["group"] = {0, 1, 1};
  soup.face_labels["group"] = {"left", "right"};
  Context context;
  BuiltMesh built = build_mesh(soup, context);
  const Soup back = to_soup(view_of(built.mesh));
  REQUIRE(back.triangles.size() == 3);
  CHECK(back.face_labels == soup.face_labels);
  CHECK(back.face_scalars == soup.face_scalars);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) CHECK(back.corner_scalars.at("s")[3 * i + k] == back.triangles[i][k] + 0.5);
}

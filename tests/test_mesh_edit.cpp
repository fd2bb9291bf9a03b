#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "mesh_check.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

using Vec2f = OpenMesh::Vec2f;

/// A grid whose left and right half are two charts of a texture with a seam between them. Values that are affine in the
/// position stay affine under everything that puts vertices where the weights say: an oracle that knows no mesh.
struct Charts {
  Mesh mesh = bumpy_grid(8, 6);
  OpenMesh::FPropHandleT<int> chart;
  OpenMesh::HPropHandleT<Vec2> uv;
  OpenMesh::VPropHandleT<double> height;
  OpenMesh::VPropHandleT<OpenMesh::Vec3f> offset;
  OpenMesh::VPropHandleT<std::string> name;

  Charts() {
    mesh.add_property(chart, "f:chart");
    mesh.add_property(uv, "h:uv");
    mesh.add_property(height, "height");
    mesh.add_property(offset, "offset");
    mesh.add_property(name, "name");
    for (const auto f : mesh.faces()) mesh.property(chart, f) = f.idx() % 16 < 8 ? 0 : 1;  // 16 faces a row
    for (const auto h : mesh.halfedges())
      if (!mesh.is_boundary(h)) mesh.property(uv, h) = uv_at(h);
    for (const auto v : mesh.vertices()) {
      mesh.property(height, v) = height_at(v);
      mesh.property(offset, v) = offset_at(v);
      mesh.property(name, v) = "vertex";
    }
  }

  Vec2 uv_at(HalfedgeHandle h) const {
    const Vec3 p = mesh.point(mesh.to_vertex_handle(h));
    return mesh.property(chart, mesh.face_handle(h)) == 0 ? Vec2(p[0] - p[2], p[1]) : Vec2(20 + p[1], 3 * p[0] + p[2]);
  }
  double height_at(VertexHandle v) const { return 1 + 2 * mesh.point(v)[0] - mesh.point(v)[1] + 3 * mesh.point(v)[2]; }
  OpenMesh::Vec3f offset_at(VertexHandle v) const {
    return OpenMesh::vector_cast<OpenMesh::Vec3f>(2.0 * mesh.point(v));
  }

  bool seam(EdgeHandle e) const {
    if (mesh.is_boundary(e)) return false;
    return mesh.property(chart, mesh.face_handle(mesh.halfedge_handle(e, 0))) !=
           mesh.property(chart, mesh.face_handle(mesh.halfedge_handle(e, 1)));
  }
  bool on_seam(VertexHandle v) const {
    for (const auto e : mesh.ve_range(v))
      if (seam(e)) return true;
    return false;
  }

  void check() const {
    CHECK_VALID_MESH(mesh);
    for (const auto h : mesh.halfedges())
      if (!mesh.is_boundary(h)) CHECK((mesh.property(uv, h) - uv_at(h)).norm() < 1e-9);
    for (const auto v : mesh.vertices()) {
      CHECK(mesh.property(height, v) == doctest::Approx(height_at(v)));
      CHECK((mesh.property(offset, v) - offset_at(v)).norm() < 1e-4f);
      CHECK(mesh.property(name, v) == "vertex");
    }
  }
};

Vec3 along(const Mesh& mesh, EdgeHandle e, double share) {
  const auto h = mesh.halfedge_handle(e, 0);
  return (1 - share) * mesh.point(mesh.from_vertex_handle(h)) + share * mesh.point(mesh.to_vertex_handle(h));
}

}  // namespace

TEST_CASE(
    "mesh_edit: splits keep values that are affine in the position, on both sides of a seam and on the boundary") {
  Charts c;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0.1, 0.9);
  for (int round = 0; round < 60; ++round) {
    const EdgeHandle e(static_cast<int>(random() % c.mesh.n_edges()));
    const int faces = live_faces(c.mesh);
    const bool boundary = c.mesh.is_boundary(e), seam = c.seam(e);
    const double share = unit(random);
    const VertexHandle m = split_edge(view_of(c.mesh), e, along(c.mesh, e, share), share);
    CHECK(live_faces(c.mesh) == faces + (boundary ? 1 : 2));
    CHECK(c.mesh.is_boundary(m) == boundary);
    CHECK(c.on_seam(m) == seam);

    const FaceHandle f(static_cast<int>(random() % c.mesh.n_faces()));
    std::array<double, 3> w{unit(random), unit(random), 0};
    w = {w[0] / 2, w[1] / 2, 1 - w[0] / 2 - w[1] / 2};
    Vec3 p(0, 0, 0);
    int k = 0;
    for (const auto v : c.mesh.fv_range(f)) p += w[k++] * c.mesh.point(v);
    CHECK(c.mesh.valence(split_face(view_of(c.mesh), f, p, w)) == 3);
  }
  c.check();
  CHECK(euler_characteristic(c.mesh) == 1);
  CHECK(boundary_loops(c.mesh) == 1);
}

TEST_CASE("mesh_edit: flips and collapses keep the corner values of each chart") {
  Charts c;
  std::mt19937 random(5);
  int flips = 0, collapses = 0;
  for (int round = 0; round < 400; ++round) {
    const EdgeHandle e(static_cast<int>(random() % c.mesh.n_edges()));
    if (c.mesh.status(e).deleted()) continue;
    if (!c.seam(e) && c.mesh.is_flip_ok(e)) {
      flip_edge(view_of(c.mesh), e);
      ++flips;
    }
    const HalfedgeHandle h(static_cast<int>(random() % c.mesh.n_halfedges()));
    if (c.mesh.status(h).deleted() || round % 4 > 0) continue;
    const VertexHandle from = c.mesh.from_vertex_handle(h), to = c.mesh.to_vertex_handle(h);
    if (c.on_seam(from) && !c.seam(c.mesh.edge_handle(h))) continue;
    if (c.mesh.is_boundary(from) || !is_collapse_ok(c.mesh, h)) continue;
    collapse(view_of(c.mesh), h);
    ++collapses;
    CHECK(c.mesh.status(from).deleted());
    CHECK_FALSE(c.mesh.status(to).deleted());
  }
  CHECK(flips > 50);
  CHECK(collapses > 5);
  c.check();
}

TEST_CASE("mesh_edit: whether a collapse is legal is what OpenMesh says, without a trace") {
  Mesh mesh = two_components();
  for (const int f : {0, 12}) delete_face(view_of(mesh), FaceHandle(f));
  std::mt19937 random(6);
  int legal = 0;
  for (int round = 0; round < 300; ++round) {
    for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i) {
      const HalfedgeHandle h(i);
      const Snapshot before = round == 0 ? snapshot(view_of(mesh)) : Snapshot();
      const bool ok = is_collapse_ok(mesh, h);
      if (round == 0) CHECK(snapshot(view_of(mesh)) == before);
      CHECK(ok == mesh.is_collapse_ok(h));
    }
    const HalfedgeHandle h(static_cast<int>(random() % mesh.n_halfedges()));
    if (!is_collapse_ok(mesh, h)) continue;
    collapse(view_of(mesh), h);
    ++legal;
    CHECK_VALID_MESH(mesh);
  }
  CHECK(legal > 5);
}

TEST_CASE("mesh_edit: a collapse along the end of a seam takes each side's values") {
  // Around vertex 0: six faces, the seam runs 1 - 0 - 4; collapsing 0 into 1 must give the upper faces the upper value.
  std::vector<Vec3> points{{0, 0, 0}};
  for (int k = 0; k < 6; ++k) points.emplace_back(std::cos(k * pi / 3), std::sin(k * pi / 3), 0);
  std::vector<std::array<int, 3>> triangles;
  for (int k = 0; k < 6; ++k) triangles.push_back({0, 1 + k, 1 + (k + 1) % 6});
  Mesh mesh = make_mesh(points, triangles);
  OpenMesh::HPropHandleT<int> side;
  mesh.add_property(side, "h:side");
  for (const auto f : mesh.faces())
    for (const auto h : mesh.fh_range(f))
      mesh.property(side, h) = (f.idx() < 3 ? 100 : 200) + mesh.to_vertex_handle(h).idx();
  collapse(view_of(mesh), mesh.find_halfedge(VertexHandle(0), VertexHandle(1)));
  CHECK_VALID_MESH(mesh);
  CHECK(live_faces(mesh) == 4);
  for (const auto f : mesh.faces())
    for (const auto h : mesh.fh_range(f))
      CHECK(mesh.property(side, h) == (f.idx() < 3 ? 100 : 200) + mesh.to_vertex_handle(h).idx());
}

TEST_CASE("mesh_edit: pieces inherit from the face and edge they come from; status but for selection is cleared") {
  Mesh mesh = grid(3, 3);
  OpenMesh::FPropHandleT<std::string> label;
  OpenMesh::EPropHandleT<int> crease;
  OpenMesh::HPropHandleT<int> flow;  // no corner value: it belongs to the half-edge
  mesh.add_property(label, "label");
  mesh.add_property(crease, "crease");
  mesh.add_property(flow, "flow");
  for (const auto f : mesh.faces()) mesh.property(label, f) = std::to_string(f.idx());
  for (const auto e : mesh.edges()) mesh.property(crease, e) = 10 + e.idx();
  for (const auto h : mesh.halfedges()) mesh.property(flow, h) = 1000 + h.idx();

  EdgeHandle e;
  for (const auto candidate : mesh.edges())
    if (!mesh.is_boundary(candidate)) e = candidate;
  const auto left = mesh.face_handle(mesh.halfedge_handle(e, 0)), right = mesh.face_handle(mesh.halfedge_handle(e, 1));
  mesh.status(left).set_selected(true);
  mesh.status(left).set_tagged(true);
  mesh.status(e).set_feature(true);
  const std::size_t edges = mesh.n_edges(), faces = mesh.n_faces();
  const auto a = mesh.from_vertex_handle(mesh.halfedge_handle(e, 0)),
             b = mesh.to_vertex_handle(mesh.halfedge_handle(e, 0));
  const auto m = split_edge(view_of(mesh), e, along(mesh, e, 0.5), 0.5);

  const EdgeHandle half = mesh.edge_handle(mesh.find_halfedge(a, m));
  REQUIRE(half.idx() >= static_cast<int>(edges));
  CHECK(mesh.edge_handle(mesh.find_halfedge(m, b)) == e);
  CHECK(mesh.property(crease, half) == 10 + e.idx());
  CHECK(mesh.status(half).feature());
  CHECK(mesh.property(flow, mesh.find_halfedge(a, m)) == 1000 + mesh.halfedge_handle(e, 0).idx());
  CHECK(mesh.property(flow, mesh.find_halfedge(m, a)) == 1000 + mesh.halfedge_handle(e, 1).idx());
  const auto left_piece = mesh.face_handle(mesh.find_halfedge(a, m)),
             right_piece = mesh.face_handle(mesh.find_halfedge(m, a));
  CHECK(left_piece.idx() >= static_cast<int>(faces));
  CHECK(mesh.property(label, left_piece) == std::to_string(left.idx()));
  CHECK(mesh.property(label, right_piece) == std::to_string(right.idx()));
  CHECK(mesh.status(left_piece).selected());
  CHECK_FALSE(mesh.status(left_piece).tagged());
  CHECK_FALSE(mesh.status(right_piece).selected());
}

TEST_CASE("mesh_edit: what is not a number is taken from the nearest source; a new vertex was not measured") {
  Mesh mesh;
  OpenMesh::VPropHandleT<int> number, point_index, face;
  OpenMesh::VPropHandleT<Vec2> uv;
  OpenMesh::VPropHandleT<OpenMesh::Vec3uc> color;
  OpenMesh::VPropHandleT<std::vector<Mesh::Point>> exotic;  // of a type nobody knows
  mesh.add_property(number, "number");
  mesh.add_property(point_index, property::point_index);
  mesh.add_property(face, property::cad_face);
  mesh.add_property(uv, property::uv);
  mesh.add_property(color, "color");
  mesh.add_property(exotic, "exotic");
  const auto a = mesh.add_vertex(Vec3(0, 0, 0)), b = mesh.add_vertex(Vec3(1, 0, 0));
  for (const auto v : {a, b}) {
    mesh.property(number, v) = mesh.property(point_index, v) = mesh.property(face, v) = v.idx() + 5;
    mesh.property(uv, v) = Vec2(v.idx(), 7);
    mesh.property(color, v) = OpenMesh::Vec3uc(static_cast<unsigned char>(200 * v.idx()), 255, 3);
    mesh.property(exotic, v) = {mesh.point(v)};
  }
  const auto m = add_vertex(view_of(mesh), Vec3(9, 9, 9), std::array{VertexSource{a, 0.25}, VertexSource{b, 0.75}});
  CHECK(mesh.point(m) == Vec3(9, 9, 9));
  CHECK(mesh.property(number, m) == 6);
  CHECK(mesh.property(point_index, m) == -1);
  CHECK(mesh.property(face, m) == 6);
  CHECK(mesh.property(uv, m) == Vec2(1, 7));
  CHECK(mesh.property(color, m) == OpenMesh::Vec3uc(150, 255, 3));
  CHECK(mesh.property(exotic, m) == std::vector<Mesh::Point>{mesh.point(b)});
  CHECK(mesh.is_isolated(m));
  // Into one of its own sources.
  blend_vertex(view_of(mesh), a, std::array{VertexSource{a, 0.5}, VertexSource{b, 0.5}});
  CHECK(mesh.property(color, a) == OpenMesh::Vec3uc(100, 255, 3));
  CHECK(mesh.point(a) == Vec3(0, 0, 0));
}

TEST_CASE("mesh_edit: deleting a face leaves its vertices, deleting a vertex takes its faces") {
  Mesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}});
  delete_face(view_of(mesh), FaceHandle(0));
  CHECK_VALID_MESH(mesh);
  CHECK_FALSE(mesh.status(VertexHandle(0)).deleted());
  CHECK(mesh.is_isolated(VertexHandle(0)));
  delete_vertex(view_of(mesh), VertexHandle(0));
  CHECK(mesh.status(VertexHandle(0)).deleted());
  delete_vertex(view_of(mesh), VertexHandle(3));
  CHECK_VALID_MESH(mesh);
  CHECK(live_faces(mesh) == 0);
  CHECK_FALSE(mesh.status(VertexHandle(1)).deleted());
}

TEST_CASE("mesh_edit: reversing a component turns it inside out and nothing else") {
  Mesh mesh = two_components();
  OpenMesh::HPropHandleT<int> corner;
  mesh.add_property(corner, "h:corner");
  for (const auto h : mesh.halfedges()) mesh.property(corner, h) = mesh.to_vertex_handle(h).idx();
  const double volume = mesh_volume(view_of(mesh)), area = mesh_area(view_of(mesh));
  std::vector<FaceHandle> first, all;
  for (const auto f : mesh.faces()) {
    if (f.idx() < 20) first.push_back(f);
    all.push_back(f);
  }
  const Snapshot before = snapshot(view_of(mesh));
  reverse_faces(view_of(mesh), first);
  CHECK_VALID_MESH(mesh);
  CHECK(mesh_volume(view_of(mesh)) == doctest::Approx(-volume));  // the flat grid in z = 0 encloses none
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(area));
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h)) CHECK(mesh.property(corner, h) == mesh.to_vertex_handle(h).idx());
  reverse_faces(view_of(mesh), first);
  CHECK(snapshot(view_of(mesh)) == before);
  reverse_faces(view_of(mesh), all);  // with a boundary
  CHECK_VALID_MESH(mesh);
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h)) CHECK(mesh.property(corner, h) == mesh.to_vertex_handle(h).idx());
}

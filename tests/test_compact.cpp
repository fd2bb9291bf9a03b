#include <doctest/doctest.h>

#include "mesh_check.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/compact.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("compact: a mesh without deleted elements is untouched") {
  Mesh mesh = two_components();
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  const Report report = compact(view_of(mesh), {}, context);
  CHECK(report.unchanged());
  CHECK(report.maps.empty());
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("compact: keeps order, properties and links, and says where everything went") {
  Mesh mesh = bumpy_grid(5, 4);
  OpenMesh::VPropHandleT<int> vertex_id;
  OpenMesh::EPropHandleT<int> edge_id;
  OpenMesh::HPropHandleT<int> halfedge_id;
  OpenMesh::FPropHandleT<int> face_id;
  mesh.add_property(vertex_id);
  mesh.add_property(edge_id);
  mesh.add_property(halfedge_id);
  mesh.add_property(face_id);
  for (const VertexHandle v : mesh.vertices()) mesh.property(vertex_id, v) = v.idx();
  for (const EdgeHandle e : mesh.edges()) mesh.property(edge_id, e) = e.idx();
  for (const HalfedgeHandle h : mesh.halfedges()) mesh.property(halfedge_id, h) = h.idx();
  for (const FaceHandle f : mesh.faces()) mesh.property(face_id, f) = f.idx();
  mesh.status(VertexHandle(20)).set_selected(true);
  for (const int f : {0, 1, 8, 9}) mesh.delete_face(FaceHandle(f), true);
  mesh.delete_vertex(VertexHandle(15), true);
  const Mesh before = mesh;
  REQUIRE_FALSE(before.is_isolated(VertexHandle(20)));

  Context context;
  const Report report = compact(view_of(mesh), {}, context);
  CHECK_VALID_MESH(mesh);
  CHECK(report.faces_removed == before.n_faces() - mesh.n_faces());
  CHECK(report.vertices_removed == before.n_vertices() - mesh.n_vertices());
  REQUIRE(report.maps.vertices.size() == before.n_vertices());
  REQUIRE(report.maps.edges.size() == before.n_edges());
  REQUIRE(report.maps.faces.size() == before.n_faces());

  std::uint32_t next = 0;
  for (int i = 0; i < static_cast<int>(before.n_vertices()); ++i) {
    if (before.status(VertexHandle(i)).deleted()) {
      CHECK(report.maps.vertices[i] == ElementMaps::removed);
      continue;
    }
    REQUIRE(report.maps.vertices[i] == next);
    const VertexHandle v(static_cast<int>(next++));
    CHECK(mesh.property(vertex_id, v) == i);
    CHECK(mesh.point(v) == before.point(VertexHandle(i)));
    CHECK(mesh.status(v).selected() == (i == 20));
  }
  CHECK(next == mesh.n_vertices());
  int last = -1;
  for (const FaceHandle f : mesh.faces()) {
    const FaceHandle old(mesh.property(face_id, f));
    CHECK(old.idx() > last);
    last = old.idx();
    CHECK(report.maps.faces[old.idx()] == static_cast<std::uint32_t>(f.idx()));
    HalfedgeHandle h = mesh.halfedge_handle(f), o = before.halfedge_handle(old);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h), o = before.next_halfedge_handle(o)) {
      CHECK(mesh.property(halfedge_id, h) == o.idx());
      CHECK(mesh.property(edge_id, mesh.edge_handle(h)) == o.idx() / 2);
      CHECK(mesh.property(vertex_id, mesh.to_vertex_handle(h)) == before.to_vertex_handle(o).idx());
    }
  }
  CHECK(boundary_loops(mesh) == boundary_loops(before));
  CHECK(compact(view_of(mesh), {}, context).unchanged());
}

TEST_CASE("compact: isolated vertices stay unless they are asked to go") {
  Mesh mesh = grid(1, 1);
  mesh.add_vertex({5, 5, 5});
  Context context;
  CHECK(compact(view_of(mesh), {}, context).unchanged());
  CHECK(compact(view_of(mesh), {.isolated_vertices = true}, context).vertices_removed == 1);
  CHECK(mesh.n_vertices() == 4);
  CHECK_VALID_MESH(mesh);
}

TEST_CASE("compact: everything deleted leaves an empty mesh") {
  Mesh mesh = icosahedron();
  for (const FaceHandle f : mesh.all_faces()) mesh.delete_face(f, true);
  Context context;
  compact(view_of(mesh), {}, context);
  CHECK(mesh.n_vertices() == 0);
  CHECK(mesh.n_edges() == 0);
  CHECK(mesh.n_faces() == 0);
}

TEST_CASE("compact: a kept face on a deleted vertex and missing status are refused, the mesh untouched") {
  Mesh mesh = grid(2, 2);
  mesh.status(VertexHandle(4)).set_deleted(true);
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  CHECK_THROWS_AS(compact(view_of(mesh), {}, context), InvalidInput);
  CHECK(snapshot(view_of(mesh)) == before);

  OpenMesh::TriMesh_ArrayKernelT<> bare;
  OpenMesh::VPropHandleT<Vec3> positions;
  bare.add_property(positions);
  CHECK_THROWS_AS(compact({bare, positions}, {}, context), InvalidInput);
}

#include <doctest/doctest.h>

#include "mesh_check.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("mesh_check: accepts closed, open and empty meshes") {
  CHECK(mesh_problems(icosahedron()).empty());
  CHECK(mesh_problems(bumpy_grid(5, 4)).empty());
  CHECK(mesh_problems(two_components()).empty());
  CHECK(mesh_problems(Mesh()).empty());
  CHECK(euler_characteristic(icosahedron()) == 2);
  CHECK(euler_characteristic(two_components()) == 3);
  CHECK(boundary_loops(two_components()) == 1);
}

TEST_CASE("mesh_check: finds a broken link, a bow-tie and an inner half-edge stored at the boundary") {
  Mesh broken = icosahedron();
  broken.set_vertex_handle(HalfedgeHandle(4), VertexHandle(9));
  CHECK_FALSE(mesh_problems(broken).empty());

  Mesh bow_tie = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  CHECK_FALSE(mesh_problems(bow_tie).empty());

  Mesh inner = grid(2, 2);
  const VertexHandle corner(0);
  inner.set_halfedge_handle(corner,
                            inner.next_halfedge_handle(inner.opposite_halfedge_handle(inner.halfedge_handle(corner))));
  CHECK_FALSE(mesh_problems(inner).empty());

  Mesh deleted = grid(2, 2);
  deleted.status(FaceHandle(0)).set_deleted(true);
  CHECK_FALSE(mesh_problems(deleted).empty());
  Mesh properly = grid(2, 2);
  properly.delete_face(FaceHandle(0), true);
  CHECK(mesh_problems(properly).empty());
}

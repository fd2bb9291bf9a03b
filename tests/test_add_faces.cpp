#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "meshops/editing/add_faces.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("add_faces: any order of a batch gives the same valid mesh, where one face at a time would not fit") {
  // The middle triangle first: alone it would hang on three vertices only.
  const std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, -1, 0}, {2, 1, 0}, {0, 1, 0}};
  std::vector<std::array<int, 3>> triangles{{0, 1, 2}, {0, 3, 1}, {1, 4, 2}, {2, 5, 0}};
  std::mt19937 random(1);
  for (int round = 0; round < 10; ++round) {
    std::shuffle(triangles.begin(), triangles.end(), random);
    Mesh mesh;
    for (const Vec3& p : points) mesh.add_vertex(p);
    std::vector<VertexTriple> batch;
    for (const auto& t : triangles) batch.push_back({VertexHandle(t[0]), VertexHandle(t[1]), VertexHandle(t[2])});
    std::vector<FaceHandle> added;
    REQUIRE(add_faces(view_of(mesh), batch, &added) == FitResult::fits);
    CHECK(added.size() == 4);
    CHECK_VALID_MESH(mesh);
    CHECK(boundary_loops(mesh) == 1);
    CHECK(euler_characteristic(mesh) == 1);
    CHECK(mesh.n_edges() == 9);
  }
}

TEST_CASE("add_faces: builds whole surfaces in random order and random portions") {
  const PatchShape shape = tube(7, 5, 1, 0, 3);
  auto triangles = shape.triangles();
  std::mt19937 random(2);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(triangles.begin(), triangles.end(), random);
    Mesh mesh;
    for (const Vec3& p : shape.points()) mesh.add_vertex(p);
    std::vector<VertexTriple> open;
    for (const auto& t : triangles) open.push_back({VertexHandle(t[0]), VertexHandle(t[1]), VertexHandle(t[2])});
    // One triangle at a time, again and again, as long as one fits; what does not fit leaves no trace.
    while (!open.empty()) {
      const std::size_t before = open.size();
      std::erase_if(open, [&](const VertexTriple& t) {
        const Snapshot was = snapshot(view_of(mesh));
        const bool fits = add_faces(view_of(mesh), std::span(&t, 1)) == FitResult::fits;
        if (!fits) CHECK(snapshot(view_of(mesh)) == was);
        return fits;
      });
      if (open.size() == before) {  // each alone would make a bow-tie now; together they do not
        REQUIRE(add_faces(view_of(mesh), open) == FitResult::fits);
        open.clear();
      }
      CHECK_VALID_MESH(mesh);
    }
    CHECK(boundary_loops(mesh) == 2);
    CHECK(euler_characteristic(mesh) == 0);
  }
}

TEST_CASE("add_faces: refuses what is not manifold and leaves the mesh untouched") {
  Mesh mesh = grid(3, 3);
  const VertexHandle free = mesh.add_vertex({5, 5, 1});
  const VertexHandle free2 = mesh.add_vertex({6, 5, 1});
  const Snapshot before = snapshot(view_of(mesh));
  const auto refused = [&](std::vector<VertexTriple> batch) {
    const FitResult result = add_faces(view_of(mesh), batch);
    CHECK(snapshot(view_of(mesh)) == before);
    return result;
  };
  const VertexHandle corner(0), next(1), inner(5);
  CHECK(refused({{corner, corner, free}}) == FitResult::degenerate);
  CHECK(refused({{corner, VertexHandle(), free}}) == FitResult::degenerate);
  CHECK(refused({{corner, next, free}}) == FitResult::edge_in_use);  // that side of the edge has its face
  CHECK(refused({{next, corner, free}, {next, corner, free2}}) == FitResult::edge_in_use);
  CHECK(refused({{inner, free, free2}}) == FitResult::vertex_not_manifold);   // a second fan at an inner vertex
  CHECK(refused({{corner, free, free2}}) == FitResult::vertex_not_manifold);  // a bow-tie
  CHECK(add_faces(view_of(mesh), std::vector<VertexTriple>{{next, corner, free}}) == FitResult::fits);
  CHECK_VALID_MESH(mesh);
}

TEST_CASE("add_faces: new faces take the properties of a neighbour, not its status") {
  Mesh mesh = grid(2, 2);
  OpenMesh::FPropHandleT<int> material;
  mesh.add_property(material, "material");
  for (const auto f : mesh.faces()) mesh.property(material, f) = 7, mesh.status(f).set_selected(true);
  const VertexHandle a = mesh.add_vertex({1, -1, 0}), b = mesh.add_vertex({2, -1, 0});
  std::vector<FaceHandle> added;
  REQUIRE(add_faces(view_of(mesh),
                    std::vector<VertexTriple>{{VertexHandle(1), VertexHandle(0), a}, {VertexHandle(1), a, b}},
                    &added) == FitResult::fits);
  for (const FaceHandle f : added) {
    CHECK(mesh.property(material, f) == 7);
    CHECK_FALSE(mesh.status(f).selected());
  }
  CHECK_VALID_MESH(mesh);
}

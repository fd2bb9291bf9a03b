// Which elements a selection lets an operator change, and that every registered mesh operator keeps to it.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <vector>

#include "mesh_check.hpp"
#include "meshops/error.hpp"
#include "meshops/holes/boundary_loops.hpp"
#include "meshops/registry.hpp"
#include "meshops/selection.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

std::array<VertexHandle, 3> corners(const Mesh& mesh, FaceHandle f) {
  const HalfedgeHandle h = mesh.halfedge_handle(f);
  return {mesh.from_vertex_handle(h), mesh.to_vertex_handle(h), mesh.to_vertex_handle(mesh.next_halfedge_handle(h))};
}

/// The corners with the lowest first: a face whose first half-edge changed is the same face.
std::array<int, 3> cycle(const Mesh& mesh, FaceHandle f) {
  const auto c = corners(mesh, f);
  std::array<int, 3> v{c[0].idx(), c[1].idx(), c[2].idx()};
  std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
  return v;
}

std::vector<FaceHandle> live_faces_of(const Mesh& mesh) {
  std::vector<FaceHandle> faces;
  for (const FaceHandle f : mesh.faces())
    if (!mesh.status(f).deleted()) faces.push_back(f);
  return faces;
}

/// Faces whose centre lies at x below the given one.
std::vector<FaceHandle> faces_left_of(const Mesh& mesh, double x) {
  std::vector<FaceHandle> faces;
  for (const FaceHandle f : live_faces_of(mesh)) {
    double sum = 0;
    for (const VertexHandle v : corners(mesh, f)) sum += mesh.point(v)[0];
    if (sum / 3 < x) faces.push_back(f);
  }
  return faces;
}

/// Meshes on which most operators find something to do, on both sides of x = 5.
std::vector<Mesh> inputs() {
  std::vector<Mesh> result;
  result.push_back(bumpy_grid(10, 10));
  Mesh holes = bumpy_grid(10, 10);
  for (const int f : {26, 27, 46, 47, 32, 33, 52, 53, 110, 128}) holes.delete_face(FaceHandle(f), false);
  result.push_back(holes);
  Mesh gap = bumpy_grid(10, 11);
  for (int f = 100; f < 120; ++f) gap.delete_face(FaceHandle(f), true);
  result.push_back(gap);
  Mesh spikes = bumpy_grid(10, 10);
  for (const int v : {25, 29, 60, 64, 90, 97}) spikes.point(VertexHandle(v))[2] += 4;
  result.push_back(spikes);
  return result;
}

}  // namespace

TEST_CASE("selection: of faces, a vertex may move only if all its faces are selected") {
  const Mesh mesh = grid(4, 4);
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<FaceHandle> faces;
    std::vector<char> chosen(mesh.n_faces(), 0);
    for (const FaceHandle f : mesh.faces())
      if (random() % 3 != 0) {
        faces.push_back(f);
        chosen[f.idx()] = 1;
      }
    const Selection selection = Selection::of_faces(mesh, faces);
    for (const FaceHandle f : mesh.faces()) CHECK(selection.may_replace(f) == bool(chosen[f.idx()]));
    for (const VertexHandle v : mesh.vertices()) {
      bool all = true;
      for (const FaceHandle f : mesh.vf_range(v)) all = all && chosen[f.idx()];
      CHECK(selection.may_move(v) == all);
    }
  }
}

TEST_CASE("selection: of vertices, a face may be replaced only if all its corners are selected") {
  const Mesh mesh = grid(3, 3);
  const std::vector<VertexHandle> vertices{VertexHandle(0), VertexHandle(1), VertexHandle(5), VertexHandle(4),
                                           VertexHandle(15)};
  const Selection selection = Selection::of_vertices(mesh, vertices);
  const auto chosen = [&](VertexHandle v) { return std::find(vertices.begin(), vertices.end(), v) != vertices.end(); };
  for (const VertexHandle v : mesh.vertices()) CHECK(selection.may_move(v) == chosen(v));
  int replaceable = 0;
  for (const FaceHandle f : mesh.faces()) {
    const auto c = corners(mesh, f);
    CHECK(selection.may_replace(f) == (chosen(c[0]) && chosen(c[1]) && chosen(c[2])));
    replaceable += selection.may_replace(f);
  }
  CHECK(replaceable == 2);  // the two triangles of the first cell
}

TEST_CASE("selection: of loops, only these loops may be filled") {
  Mesh mesh = grid(8, 8);
  mesh.delete_face(FaceHandle(36), false);
  mesh.delete_face(FaceHandle(90), false);
  const auto cycles = boundary_cycles(view_of(mesh));
  REQUIRE(cycles.size() == 3);
  for (const auto& chosen : cycles) {
    const Selection selection = Selection::of_loops(mesh, std::array{chosen[1]});
    for (const auto& loop : cycles) CHECK(selection.may_fill(mesh, loop) == (loop == chosen));
    for (const FaceHandle f : live_faces_of(mesh)) CHECK(!selection.may_replace(f));
    for (const VertexHandle v : mesh.vertices()) CHECK(!selection.may_move(v));
  }
}

TEST_CASE("selection: the status bits say faces before vertices before edges") {
  Mesh mesh = grid(3, 3);
  const auto replaceable = [&] {
    const Selection selection = Selection::of_status(mesh);
    int count = 0;
    for (const FaceHandle f : mesh.faces()) count += selection.may_replace(f);
    return count;
  };
  CHECK(replaceable() == 0);
  EdgeHandle rim;
  for (const EdgeHandle e : mesh.edges())
    if (mesh.is_boundary(e)) rim = e;
  mesh.status(rim).set_selected(true);
  const auto loop = boundary_cycles(view_of(mesh)).at(0);
  CHECK(Selection::of_status(mesh).may_fill(mesh, loop));
  CHECK(replaceable() == 0);
  for (const VertexHandle v : mesh.fv_range(FaceHandle(4))) mesh.status(v).set_selected(true);
  CHECK(replaceable() == 1);
  for (const int f : {1, 2, 3}) mesh.status(FaceHandle(f)).set_selected(true);
  CHECK(replaceable() == 3);
}

TEST_CASE("selection: what comes later belongs to it") {
  Mesh mesh = grid(2, 2);
  const Selection selection = Selection::of_faces(mesh, {});
  const VertexHandle v = mesh.add_vertex({5, 5, 5});
  CHECK(selection.may_move(v));
  CHECK(!selection.may_move(VertexHandle(0)));
  CHECK(selection.may_replace(FaceHandle(static_cast<int>(mesh.n_faces()))));
}

TEST_CASE("selection: handles of another mesh, deleted ones and half-edges with a face are errors") {
  Mesh mesh = grid(2, 2);
  CHECK_THROWS_WITH_AS(Selection::of_faces(mesh, std::array{FaceHandle(8)}),
                       "selection: face 8 is not of this mesh, which has 8", InvalidInput);
  CHECK_THROWS_AS(Selection::of_faces(mesh, std::array{FaceHandle()}), InvalidInput);
  CHECK_THROWS_AS(Selection::of_vertices(mesh, std::array{VertexHandle(9)}), InvalidInput);
  CHECK_THROWS_AS(Selection::of_loops(mesh, std::array{mesh.halfedge_handle(FaceHandle(0))}), InvalidInput);
  mesh.delete_face(FaceHandle(3), false);
  CHECK_THROWS_WITH_AS(Selection::of_faces(mesh, std::array{FaceHandle(3)}), "selection: face 3 is deleted",
                       InvalidInput);
  OpenMesh::TriMesh_ArrayKernelT<> bare;
  CHECK_THROWS_AS(Selection::of_status(bare), InvalidInput);
}

TEST_CASE("contract: an operator changes nothing outside its selection") {
  for (const auto& op : Registry::standard().operators()) {
    if (op->domain() != Domain::mesh || op->result() != Domain::mesh) continue;
    CAPTURE(op->name());
    const auto options = op->schema().make();
    Context context;
    std::uint64_t changed_inside = 0, changed_whole = 0;
    for (const Mesh& input : inputs()) {
      Mesh mesh = input;
      OpenMesh::FPropHandleT<int> mark;
      mesh.add_property(mark, "f:mark");
      for (const FaceHandle f : mesh.all_faces()) mesh.property(mark, f) = f.idx();
      const Mesh before = mesh;
      const Selection selection = Selection::of_faces(mesh, faces_left_of(mesh, 5));
      const MeshView view = view_of(mesh).with(selection);
      if (!op->promises().takes_selection) {
        CHECK_THROWS_AS(op->run(view, options.get(), context), InvalidInput);
        continue;
      }
      const Report report = op->run(view, options.get(), context);
      changed_inside += !report.unchanged();
      for (const FaceHandle f : live_faces_of(before)) {
        if (selection.may_replace(f)) continue;
        CAPTURE(f.idx());
        REQUIRE(!mesh.status(f).deleted());
        CHECK(cycle(mesh, f) == cycle(before, f));
        CHECK(mesh.property(mark, f) == f.idx());
      }
      for (const VertexHandle v : before.all_vertices()) {
        if (selection.may_move(v)) continue;
        CHECK(mesh.point(v) == before.point(v));
        CHECK(mesh.status(v).bits() == before.status(v).bits());
      }
      CHECK(mesh_problems(mesh).empty());
      Mesh whole = input;
      changed_whole += !op->run(view_of(whole), options.get(), context).unchanged();
    }
    // What does something to a whole mesh does something to half of it.
    if (op->promises().takes_selection) CHECK((changed_inside > 0) == (changed_whole > 0));
  }
}

TEST_CASE("contract: with an empty selection no operator changes anything") {
  for (const auto& op : Registry::standard().operators()) {
    if (op->domain() != Domain::mesh || op->result() != Domain::mesh || !op->promises().takes_selection) continue;
    CAPTURE(op->name());
    for (const Mesh& input : inputs()) {
      Mesh mesh = input;
      const Snapshot before = snapshot(view_of(mesh));
      const Selection nothing = Selection::of_faces(mesh, {});
      Context context;
      CHECK(op->run(view_of(mesh).with(nothing), op->schema().make().get(), context).unchanged());
      CHECK(snapshot(view_of(mesh)) == before);
    }
  }
}

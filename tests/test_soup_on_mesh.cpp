#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "mesh_check.hpp"
#include "meshops/editing/change_set.hpp"
#include "meshops/error.hpp"
#include "meshops/holes/boundary_loops.hpp"
#include "meshops/operators/orient.hpp"
#include "meshops/operators/weld.hpp"
#include "meshops/pipeline.hpp"
#include "meshops/registry.hpp"
#include "meshops/soup_edit.hpp"
#include "meshops/soup_on_mesh.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Two grids of 3 x 3 cells that meet at x = 3 in points of their own, which a weld joins.
Mesh torn_sheet() {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (const int part : {0, 1}) {
    const int first = static_cast<int>(points.size());
    for (int j = 0; j <= 3; ++j)
      for (int i = 0; i <= 3; ++i) points.emplace_back(i + 3.0 * part, j, 0);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const int a = first + 4 * j + i;
        triangles.push_back({a, a + 1, a + 5});
        triangles.push_back({a, a + 5, a + 4});
      }
  }
  return make_mesh(points, triangles);
}

template <class Options>
auto on_soup(Report (*op)(Soup&, const Options&, Context&), Context& context, Options options = {}) {
  return [op, options, &context](Soup& soup) { return op(soup, options, context); };
}

}  // namespace

TEST_CASE("run_on_mesh: a weld joins two sheets; faces that lose no corner keep their handles and values") {
  Mesh mesh = torn_sheet();
  OpenMesh::FPropHandleT<int> tag;
  mesh.add_property(tag, "editor:tag");
  for (const FaceHandle f : mesh.faces()) mesh.property(tag, f) = 100 + f.idx();
  const Mesh before = mesh;
  Context context;
  const Report report = run_on_mesh(on_soup(weld, context, {.tolerance = 1e-9}), view_of(mesh), context);
  CHECK(report.vertices_removed == 4);
  CHECK(mesh_problems(mesh).empty());
  CHECK(boundary_cycles(view_of(mesh)).size() == 1);
  CHECK(live_faces(mesh) == 36);
  int kept = 0;
  for (const FaceHandle f : before.faces()) {
    bool at_seam = false;
    for (const VertexHandle v : before.fv_range(f)) at_seam = at_seam || before.point(v)[0] == 3;
    if (at_seam) continue;
    REQUIRE(!mesh.status(f).deleted());
    CHECK(mesh.property(tag, f) == 100 + f.idx());
    ++kept;
  }
  CHECK(kept == 24);
  // A face that was made anew has the value of the one it came from.
  std::vector<int> tags;
  for (const FaceHandle f : mesh.faces()) tags.push_back(mesh.property(tag, f));
  std::sort(tags.begin(), tags.end());
  for (int i = 0; i < 36; ++i) CHECK(tags[i] == 100 + i);
}

TEST_CASE("run_on_mesh: what needs nothing is not touched") {
  Mesh mesh = bumpy_grid(6, 6);
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  CHECK(run_on_mesh(on_soup(weld, context), view_of(mesh), context).unchanged());
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("run_on_mesh: with a selection, only its faces are changed") {
  Mesh mesh = torn_sheet();
  // The lower third of both sheets: the seam is welded there and stays open above.
  std::vector<FaceHandle> low;
  for (const FaceHandle f : mesh.faces()) {
    double y = 0;
    for (const VertexHandle v : mesh.fv_range(f)) y = std::max(y, mesh.point(v)[1]);
    if (y <= 1) low.push_back(f);
  }
  const Selection selection = Selection::of_faces(mesh, low);
  const Mesh before = mesh;
  Context context;
  run_on_mesh(on_soup(weld, context, {.tolerance = 1e-9}), view_of(mesh).with(selection), context);
  CHECK(mesh_problems(mesh).empty());
  CHECK(live_faces(mesh) == 36);
  for (const FaceHandle f : before.faces()) {
    if (selection.may_replace(f)) continue;
    REQUIRE(!mesh.status(f).deleted());
    auto was = before.cfv_iter(f);
    for (auto is = mesh.cfv_iter(f); is.is_valid(); ++is, ++was) CHECK(*is == *was);
  }
  // At the foot of the seam one vertex is left of two.
  int at_foot = 0;
  for (const VertexHandle v : mesh.vertices()) at_foot += mesh.point(v) == Vec3(3, 0, 0);
  CHECK(at_foot == 1);
}

TEST_CASE("run_on_mesh: what an operator makes that does not fit to the rest is an error, and the mesh is as it was") {
  Mesh mesh = grid(4, 4);
  const Snapshot before = snapshot(view_of(mesh));
  const Selection selection = Selection::of_faces(mesh, std::array{FaceHandle(10), FaceHandle(11)});
  // Turns the selected cell over: its rim would run the same way on both sides.
  const auto turn = [](Soup& soup) {
    Report report;
    for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) reverse_triangle(soup, t);
    report.faces_reversed = soup.triangles.size();
    return report;
  };
  Context context;
  CHECK_THROWS_AS(run_on_mesh(turn, view_of(mesh).with(selection), context), InvalidInput);
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("run_on_mesh: every operator on soups runs on a mesh, and is undone bit for bit") {
  for (const auto& op : Registry::standard().operators()) {
    if (op->domain() != Domain::soup || op->result() != Domain::soup) continue;
    CAPTURE(op->name());
    Mesh mesh = torn_sheet();
    mesh.point(VertexHandle(5)) = mesh.point(VertexHandle(6));  // something for remove-degenerate
    const Snapshot before = snapshot(view_of(mesh));
    Context context;
    ChangeSet change = record(mesh, [&](MeshView view) { return op->run(view, op->schema().make().get(), context); });
    CHECK(mesh_problems(mesh).empty());
    const Snapshot after = snapshot(view_of(mesh));
    if (!change.empty()) {
      change.undo(mesh);
      CHECK(snapshot(view_of(mesh)) == before);
      change.redo(mesh);
      CHECK(snapshot(view_of(mesh)) == after);
    }
  }
}

TEST_CASE("pipeline: operators on soups run on a mesh in place") {
  Mesh mesh = torn_sheet();
  Pipeline pipeline;
  pipeline.add(weld, {.tolerance = 1e-9}).add(orient);
  Context context;
  const auto reports = pipeline.run(view_of(mesh), context);
  REQUIRE(reports.size() == 2);
  CHECK(reports[0].vertices_removed == 4);
  CHECK(boundary_cycles(view_of(mesh)).size() == 1);
}

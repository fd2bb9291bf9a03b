// What every registered mesh operator owes, whatever it does: run over the registry, so that a new operator is held to
// it by its registration alone. Promises that an operator does not make are stated at its registration (`Promises`).

#include <doctest/doctest.h>

#include <atomic>
#include <string>

#include "attribute_checks.hpp"
#include "contract.hpp"
#include "kernels.hpp"
#include "mesh_check.hpp"
#include "mesh_state.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/editing/change_set.hpp"
#include "meshops/to_soup.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Inputs on which most operators find something to do.
std::vector<std::pair<std::string, Mesh>> mesh_inputs() {
  std::vector<std::pair<std::string, Mesh>> result;
  result.emplace_back("icosahedron", icosahedron());
  result.emplace_back("bumpy grid", bumpy_grid(9, 8));
  result.emplace_back("two components", two_components());
  Mesh holes = bumpy_grid(12, 12);
  for (const int f : {60, 61, 63, 150, 151, 200}) holes.delete_face(FaceHandle(f), true);
  result.emplace_back("grid with holes, elements deleted", holes);
  result.emplace_back("two rims", tube(12, 4, 1, 0, 2).mesh());
  Mesh gap = bumpy_grid(6, 20);  // two sheets with a ragged gap between them
  for (int f = 120; f < 132; ++f) gap.delete_face(FaceHandle(f), true);
  result.emplace_back("gap", gap);
  return result;
}

struct MeshKind {
  using Value = Mesh;
  static constexpr Domain domain = Domain::mesh;
  static constexpr int cancel_threads = 0;
  static std::vector<std::pair<std::string, Mesh>> inputs() { return ::mesh_inputs(); }
  static Mesh valid() { return bumpy_grid(4, 4); }
  static bool same(Mesh& a, Mesh& b) { return snapshot(view_of(a)) == snapshot(view_of(b)); }
  static void check_cancelled(Mesh& after, Mesh&) { CHECK_VALID_MESH(after); }
};

std::vector<const Operator*> mesh_operators() {
  return operators_of(Domain::mesh);
}

int alive_faces(const OpenMesh::TriConnectivity& mesh) {
  int faces = 0;
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) faces += !mesh.status(FaceHandle(static_cast<int>(i))).deleted();
  return faces;
}
int alive_vertices(const OpenMesh::TriConnectivity& mesh) {
  int vertices = 0;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i)
    vertices += !mesh.status(VertexHandle(static_cast<int>(i))).deleted();
  return vertices;
}

EditorKernel editor_mesh(const Mesh& source) {
  EditorKernel mesh;
  copy_mesh(source, mesh);
  return mesh;
}

/// Recorded, undone and done again on a kernel of this type; with `stop`, cancelled at that checkpoint.
template <class Kernel>
void check_undo(const Operator& op, const Mesh& input) {
  Kernel mesh;
  copy_mesh(input, mesh);
  add_properties(mesh);
  request_status(mesh);
  const MeshState before = state_of(mesh);
  const std::shared_ptr<void> options = op.schema().make();
  std::atomic<int> checkpoints = 0;
  Context context;
  context.on_checkpoint = [&] { ++checkpoints; };
  ChangeSet change = record(mesh, [&](MeshView view) { return op.run(view, options.get(), context); });
  CHECK_VALID_MESH(mesh);
  const MeshState after = state_of(mesh);
  if (change.empty()) CHECK(difference(after, before) == "");
  CHECK(change.reports().size() == 1);
  for (int round = 0; round < 2; ++round) {
    change.undo(mesh);
    CHECK(difference(state_of(mesh), before) == "");
    change.redo(mesh);
    CHECK(difference(state_of(mesh), after) == "");
  }
  change.undo(mesh);
  for (int stop = 1; stop <= std::min(checkpoints.load(), 5); ++stop) {
    std::atomic<int> seen = 0;
    Context cancelled;
    cancelled.on_checkpoint = [&] {
      if (++seen == stop) cancelled.cancel();
    };
    CHECK_THROWS_AS(record(mesh, [&](MeshView view) { return op.run(view, options.get(), cancelled); }), Cancelled);
    CHECK(difference(state_of(mesh), before) == "");
  }
}

}  // namespace

TEST_CASE("contract: the empty mesh is left empty, with a zero report") {
  for (const Operator* op : mesh_operators()) {
    CAPTURE(op->name());
    Mesh mesh;
    Context context;
    const Report report = run(*op, mesh, context);
    CHECK(report.unchanged());
    CHECK(report.operation == op->name());
    CHECK(mesh.n_vertices() == 0);
    CHECK(mesh.n_faces() == 0);
  }
}

TEST_CASE("contract: a mesh that needs nothing is returned bit for bit, with a zero report") {
  for (const Operator* op : mesh_operators()) {
    if (!op->promises().leaves_good_mesh) continue;
    CAPTURE(op->name());
    Mesh mesh = icosahedron();
    const Snapshot before = snapshot(view_of(mesh));
    Context context;
    const Report report = run(*op, mesh, context);
    CHECK(report.unchanged());
    CHECK(report.touched_vertices.empty());
    CHECK(report.touched_faces.empty());
    CHECK(report.maps.empty());
    CHECK(snapshot(view_of(mesh)) == before);
  }
}

TEST_CASE("contract: the mesh is valid afterwards, and the report counts what changed") {
  for_all<MeshKind>([](const Operator& op, const Mesh& input) {
    REQUIRE(mesh_problems(input).empty());
    Mesh mesh = input;
    const Snapshot before = snapshot(view_of(mesh));
    Context context;
    const Report report = run(op, mesh, context);
    CHECK_VALID_MESH(mesh);
    CHECK(mesh.has_vertex_status());
    if (op.promises().keeps_handles) {
      CHECK(alive_faces(mesh) - alive_faces(input) ==
            static_cast<int>(report.faces_added) - static_cast<int>(report.faces_removed));
      CHECK(alive_vertices(mesh) - alive_vertices(input) ==
            static_cast<int>(report.vertices_added) - static_cast<int>(report.vertices_removed));
      CHECK(mesh.n_faces() >= input.n_faces());
      CHECK(mesh.n_vertices() >= input.n_vertices());
      if (report.vertices_moved == 0)
        for (std::size_t i = 0; i < input.n_vertices(); ++i)
          if (!mesh.status(VertexHandle(static_cast<int>(i))).deleted())
            CHECK(mesh.point(VertexHandle(static_cast<int>(i))) == input.point(VertexHandle(static_cast<int>(i))));
    }
    for (const std::uint32_t f : report.touched_faces) CHECK(f < mesh.n_faces());
    for (const std::uint32_t v : report.touched_vertices) CHECK(v < mesh.n_vertices());
    if (report.unchanged() && op.promises().keeps_handles) CHECK(snapshot(view_of(mesh)) == before);
  });
}

TEST_CASE("contract: a second run changes nothing, where promised") {
  check_second_run<MeshKind>();
}

TEST_CASE("contract: the result does not depend on the number of threads, and a run can be repeated") {
  check_threads<MeshKind>();
}

TEST_CASE("contract: cancelled at any checkpoint, the mesh is valid; progress never goes backwards") {
  check_cancel<MeshKind>();
}

TEST_CASE(
    "contract: recorded, undone, done again and cancelled, the mesh is as it was bit for bit, with all properties") {
  for_all<MeshKind>([](const Operator& op, const Mesh& input) {
    check_undo<Mesh>(op, input);
    check_undo<EditorKernel>(op, input);
  });
  for (const Operator* op : mesh_operators()) {
    CAPTURE(op->name());
    const Mesh gap = mesh_inputs().back().second;
    check_undo<BareKernel>(*op, gap);
    check_undo<EigenKernel>(*op, gap);
  }
}

TEST_CASE("contract: the notes of a recording count what the report counts") {
  for_all<MeshKind>([](const Operator& op, const Mesh& input) {
    if (!op.promises().keeps_handles) return;
    Mesh mesh = input;
    const ChangeSet change = record(mesh, [&](MeshView view) {
      Context context;
      return tri::test::run(op, view, context);
    });
    const Report& report = change.reports().front();
    const ChangeNotes& notes = change.notes();
    CHECK(static_cast<int>(notes.faces.added.size()) - static_cast<int>(notes.faces.removed.size()) ==
          static_cast<int>(report.faces_added) - static_cast<int>(report.faces_removed));
    CHECK(static_cast<int>(notes.vertices.added.size()) - static_cast<int>(notes.vertices.removed.size()) ==
          static_cast<int>(report.vertices_added) - static_cast<int>(report.vertices_removed));
    CHECK(notes.vertices_moved.empty() == (report.vertices_moved == 0));
  });
}

TEST_CASE("contract: an option out of range is refused and the mesh untouched") {
  check_options<MeshKind>();
}

TEST_CASE("contract: an editor's float kernel keeps its properties, selection and traits") {
  for_all<MeshKind>([](const Operator& op, const Mesh& input) {
    EditorKernel mesh = editor_mesh(input);
    OpenMesh::VPropHandleT<int> id;
    OpenMesh::FPropHandleT<std::string> label;
    mesh.add_property(id, "editor:id");
    mesh.add_property(label, "editor:label");
    for (const VertexHandle v : mesh.vertices()) {
      mesh.property(id, v) = 100 + v.idx();
      mesh.data(v).tag = v.idx();
      mesh.status(v).set_selected(v.idx() % 3 == 0);
      mesh.set_color(v, EditorKernel::Color(static_cast<unsigned char>(v.idx()), 1, 2));
    }
    for (const FaceHandle f : mesh.faces()) mesh.property(label, f) = "face " + std::to_string(f.idx());
    const EditorKernel before = mesh;
    const auto unnamed = [](const EditorKernel& m) {
      return std::count_if(m.vprops_begin(), m.vprops_end(), [](const auto* p) { return p && p->name() == "<vprop>"; });
    };

    Context context;
    Report report;
    {
      MeshLease lease(mesh);
      report = run(op, lease.view(), context);
    }
    CHECK_VALID_MESH(mesh);
    // The lease's own property is gone; what an operator adds and leaves has a name.
    CHECK(unnamed(mesh) == unnamed(before));
    REQUIRE(mesh.has_vertex_status());
    if (!op.promises().keeps_handles) return;
    // What can be averaged is, where a vertex took the place of two (and perhaps went itself later).
    std::vector<bool> moved(mesh.n_vertices(), false);
    for (const std::uint32_t v : report.touched_vertices) moved[v] = report.vertices_moved > 0;
    for (std::size_t i = 0; i < before.n_vertices(); ++i)
      if (mesh.status(VertexHandle(static_cast<int>(i))).deleted()) moved[i] = true;
    for (std::size_t i = 0; i < before.n_vertices(); ++i) {
      const VertexHandle v(static_cast<int>(i));
      CHECK(mesh.property(id, v) == 100 + v.idx());
      CHECK(mesh.data(v).tag == v.idx());
      CHECK(mesh.status(v).selected() == (v.idx() % 3 == 0));
      if (!moved[i]) CHECK(mesh.color(v) == before.color(v));
      if (report.vertices_moved == 0 && !moved[i]) CHECK(mesh.point(v) == before.point(v));
    }
    for (std::size_t i = 0; i < before.n_faces(); ++i)
      CHECK(mesh.property(label, FaceHandle(static_cast<int>(i))) == "face " + std::to_string(i));
  });
}

TEST_CASE("contract: the float kernel gives the same as the double kernel with the same positions") {
  for_all<MeshKind>([](const Operator& op, const Mesh& input) {
    EditorKernel editor = editor_mesh(input);
    Mesh mesh;
    for (const VertexHandle v : editor.vertices()) mesh.add_vertex(OpenMesh::vector_cast<Vec3>(editor.point(v)));
    for (const FaceHandle f : editor.faces()) {
      std::vector<VertexHandle> corners;
      for (const VertexHandle v : editor.fv_range(f)) corners.push_back(v);
      mesh.add_face(corners);
    }
    Context context;
    const Report expected = run(op, mesh, context);
    MeshLease lease(editor);
    CHECK(same_report(run(op, lease.view(), context), expected));
    CHECK(snapshot(lease.view()) == snapshot(view_of(mesh)));
  });
}

TEST_CASE("contract: a kernel without status gets it for the time of the lease, and keeps it if elements are deleted") {
  for (const Operator* op : mesh_operators()) {
    CAPTURE(op->name());
    OpenMesh::TriMesh_ArrayKernelT<> mesh;
    const Mesh source = bumpy_grid(8, 8);
    for (const VertexHandle v : source.vertices())
      mesh.add_vertex(OpenMesh::vector_cast<OpenMesh::Vec3f>(source.point(v)));
    for (const FaceHandle f : source.faces()) {
      std::vector<VertexHandle> corners;
      for (const VertexHandle v : source.fv_range(f)) corners.push_back(v);
      mesh.add_face(corners);
    }
    REQUIRE_FALSE(mesh.has_vertex_status());
    Context context;
    Report report;
    {
      MeshLease lease(mesh);
      report = run(*op, lease.view(), context);
    }
    CHECK_VALID_MESH(mesh);
    const bool left_deleted = op->promises().keeps_handles && report.faces_removed + report.vertices_removed > 0;
    CHECK(mesh.has_vertex_status() == left_deleted);
  }
}

TEST_CASE("contract: attributes of elements that stay are kept, those of new ones made of their neighbours'") {
  for_all<MeshKind>([](const Operator& op, const Mesh& input) {
    Mesh source = input;
    const Soup before = with_attributes(to_soup(view_of(source)));
    Context context;
    BuiltMesh built = build_mesh(before, context);
    const Report report = run(op, built.mesh, context);
    check_attributes(to_soup(view_of(built.mesh)), before, report.vertices_moved > 0);
    if (!op.promises().keeps_handles) return;
    OpenMesh::FPropHandleT<double> id;
    REQUIRE(built.mesh.get_property_handle(id, "f:id"));
    int changed = 0;
    for (int f = 0; f < static_cast<int>(before.triangles.size()); ++f)
      changed += !built.mesh.status(FaceHandle(f)).deleted() && built.mesh.property(id, FaceHandle(f)) != f;
    CHECK(changed == 0);
  });
}

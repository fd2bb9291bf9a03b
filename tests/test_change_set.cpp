#include <doctest/doctest.h>

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <random>

#include "kernels.hpp"
#include "mesh_check.hpp"
#include "mesh_state.hpp"
#include "meshops/editing/change_set.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/compact.hpp"
#include "meshops/operators/extract_boundaries.hpp"
#include "meshops/operators/fill_holes.hpp"
#include "meshops/pipeline.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// A type that nobody told the policy of, and one that is told.
struct Unknown {
  int number = 0;
  bool operator==(const Unknown&) const = default;
};

/// Random edits, each legal where it is done.
class Storm {
 public:
  Storm(MeshView view, std::mt19937& random) : view_(view), mesh_(view.mesh), random_(random) {}

  void run(int edits) {
    for (int i = 0; i < edits; ++i) edit();
  }

 private:
  int pick(std::size_t count) { return static_cast<int>(random_() % count); }
  Vec3 place() { return Vec3(pick(100), pick(100), pick(100)) * 0.01; }

  /// Deleting it leaves no vertex with two fans.
  bool deletable(FaceHandle f) const {
    for (auto it = mesh_.cfh_iter(f); it.is_valid(); ++it)
      if (mesh_.is_boundary(mesh_.to_vertex_handle(*it)) && !mesh_.is_boundary(mesh_.edge_handle(*it)) &&
          !mesh_.is_boundary(mesh_.edge_handle(mesh_.next_halfedge_handle(*it))))
        return false;
    return true;
  }
  bool deletable(VertexHandle v) const {
    if (mesh_.is_boundary(v)) return mesh_.is_isolated(v);
    for (auto it = mesh_.cvv_iter(v); it.is_valid(); ++it)
      if (mesh_.is_boundary(*it)) return false;
    return true;
  }

  void edit() {
    if (mesh_.n_faces() == 0) return;
    const VertexHandle v(pick(mesh_.n_vertices()));
    const EdgeHandle e(pick(mesh_.n_edges()));
    const FaceHandle f(pick(mesh_.n_faces()));
    const HalfedgeHandle h(pick(mesh_.n_halfedges()));
    const bool v_there = !mesh_.status(v).deleted(), e_there = !mesh_.status(e).deleted(),
               f_there = !mesh_.status(f).deleted();
    switch (pick(14)) {
      case 0:
        if (v_there) set_point(view_, v, place());
        break;
      case 1:
      case 2:
        if (e_there && mesh_.is_flip_ok(e)) flip_edge(view_, e);
        break;
      case 3:
        if (e_there) split_edge(view_, e, place(), 0.25);
        break;
      case 4:
        if (f_there) split_face(view_, f, place(), {0.5, 0.25, 0.25});
        break;
      case 5:
      case 6:
        if (is_collapse_ok(mesh_, h)) collapse(view_, h);
        break;
      case 7:
        if (f_there && deletable(f)) delete_face(view_, f);
        break;
      case 8:
        if (v_there && deletable(v)) delete_vertex(view_, v);
        break;
      case 9:
        add_vertex(view_, place(), std::array{VertexSource{v, 1}});
        break;
      case 10:
        blend_vertex(view_, v, std::array{VertexSource{v, 0.5}, VertexSource{VertexHandle(0), 0.5}});
        break;
      case 11:
        about_to_set(view_, f);
        mesh_.status(f).set_selected(true);
        about_to_set(view_, e);
        mesh_.status(e).set_feature(true);
        about_to_set(view_, h);
        mesh_.status(h).set_tagged(true);
        break;
      case 12: {
        std::vector<FaceHandle> all;
        for (const auto x : mesh_.faces()) all.push_back(x);
        reverse_faces(view_, all);
        break;
      }
      default: {
        // Back into the hole that it leaves, sometimes.
        if (!f_there || !deletable(f)) break;
        VertexTriple corners;
        int k = 0;
        for (auto it = mesh_.cfv_iter(f); it.is_valid(); ++it) corners[k++] = *it;
        delete_face(view_, f);
        add_faces(view_, std::span(&corners, 1));
        break;
      }
    }
  }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;  // status is written to, after it was announced
  std::mt19937& random_;
};

Mesh torn() {
  Mesh mesh = bumpy_grid(9, 8);
  for (const int f : {20, 21, 50, 90, 91}) mesh.delete_face(FaceHandle(f), false);
  return mesh;
}

/// A sequence of operators and edits on one kernel: undone to the first, done again to the last, and back and forth.
template <class Kernel>
void random_walk(const Mesh& source, unsigned seed) {
  std::mt19937 random(seed);
  Kernel mesh;
  copy_mesh(source, mesh);
  add_properties(mesh);
  request_status(mesh);
  std::vector<const Operator*> operators;
  for (const auto& op : Registry::standard().operators())
    if (op->domain() == Domain::mesh && op->result() == Domain::mesh) operators.push_back(op.get());

  std::vector<MeshState> states{state_of(mesh)};
  std::vector<ChangeSet> changes;
  std::vector<std::string> done;
  Context context;
  for (int step = 0; step < 12; ++step) {
    done.push_back("edits");
    changes.push_back(record(mesh, [&](MeshView view) {
      if (step % 2 == 0) {
        Storm(view, random).run(15);
        return;
      }
      const Operator& op = *operators[random() % operators.size()];
      done.back() = op.name();
      op.run(view, op.schema().make().get(), context);
    }));
    CHECK_VALID_MESH(mesh);
    states.push_back(state_of(mesh));
    if (changes.back().empty()) CHECK(difference(states.back(), states[states.size() - 2]) == "");
  }
  for (std::size_t i = changes.size(); i-- > 0;) {
    CAPTURE(i);
    CAPTURE(done[i]);
    changes[i].undo(mesh);
    REQUIRE(difference(state_of(mesh), states[i]) == "");
  }
  std::size_t at = 0;
  for (int step = 0; step < 60; ++step) {
    const bool forward = at == 0 || (at < changes.size() && random() % 3 > 0);
    CAPTURE(at);
    CAPTURE(forward);
    if (forward)
      changes[at++].redo(mesh);
    else
      changes[--at].undo(mesh);
    REQUIRE(difference(state_of(mesh), states[at]) == "");
  }
}

}  // namespace

TEST_CASE("change_set: random sequences of operators and edits are undone and redone bit for bit, on any kernel") {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    for (const Mesh& source : {torn(), two_components()}) {
      random_walk<Mesh>(source, seed);
      random_walk<EditorKernel>(source, 10 + seed);
      random_walk<BareKernel>(source, 20 + seed);
      random_walk<EigenKernel>(source, 30 + seed);
    }
  }
}

TEST_CASE("change_set: a recording in a recording, undone inside and outside") {
  std::mt19937 random(3);
  Mesh mesh = torn();
  add_properties(mesh);
  const MeshState before = state_of(mesh);
  MeshState after;
  ChangeSet change = record(mesh, [&](MeshView view) {
    Storm(view, random).run(20);
    const MeshState middle = state_of(mesh);
    ChangeSet inner = record(view, [&](MeshView inside) {
      Storm(inside, random).run(20);
      OpenMesh::VPropHandleT<int> id;
      REQUIRE(mesh.get_property_handle(id, "editor:id"));
      remove_property(inside, id);
      Storm(inside, random).run(5);
    });
    inner.undo(view);
    CHECK(difference(state_of(mesh), middle) == "");
    inner.redo(view);
    Storm(view, random).run(20);
    after = state_of(mesh);
  });
  change.undo(mesh);
  CHECK(difference(state_of(mesh), before) == "");
  change.redo(mesh);
  CHECK(difference(state_of(mesh), after) == "");
}

TEST_CASE("change_set: properties that are added, removed, rewritten and of types that nobody knows come back") {
  Mesh mesh = torn();
  add_properties(mesh);
  OpenMesh::FPropHandleT<Unknown> unknown;
  OpenMesh::VPropHandleT<Unknown> other;
  mesh.add_property(unknown, "unknown");
  mesh.add_property(other, "other");
  for (const auto f : mesh.all_faces()) mesh.property(unknown, f).number = 7 * f.idx();
  for (const auto v : mesh.all_vertices()) mesh.property(other, v).number = v.idx();
  const auto state = [&] { return state_of<Unknown>(mesh); };

  std::vector<MeshState> states{state()};
  std::vector<ChangeSet> changes;
  const auto step = [&](const auto& function) {
    changes.push_back(record(mesh, function));
    states.push_back(state());
  };
  step([](MeshView view) { split_edge(view, EdgeHandle(5), Vec3(1, 1, 1), 0.5); });  // faces and vertices grow, unknown
                                                                                     // untouched
  step([&](MeshView view) {
    about_to_set(view, FaceHandle(3));
    view.mesh.property(unknown, FaceHandle(3)).number = -1;
  });
  step([&](MeshView view) {
    const auto id = property_to_fill<OpenMesh::VPropHandleT<int>>(view, "editor:id");
    for (const auto v : mesh.vertices()) view.mesh.property(id, v) = 0;
    split_face(view, FaceHandle(1), Vec3(2, 2, 2), {0.2, 0.3, 0.5});
  });
  step([&](MeshView view) {
    OpenMesh::EPropHandleT<double> crease;
    REQUIRE(view.mesh.get_property_handle(crease, "editor:crease"));
    about_to_set(view, EdgeHandle(0));
    view.mesh.property(crease, EdgeHandle(0)) = 99;
    remove_property(view, crease);
    CHECK_FALSE(crease.is_valid());
    OpenMesh::EPropHandleT<std::string> successor;  // takes the slot
    view.mesh.add_property(successor, "successor");
    for (const auto e : mesh.edges()) view.mesh.property(successor, e) = "edge";
    split_edge(view, EdgeHandle(2), Vec3(0, 1, 0), 0.5);
  });
  Context context;
  step([&](MeshView view) { extract_boundaries(view, {}, context); });
  step([&](MeshView view) { extract_boundaries(view, {}, context); });
  step([&](MeshView view) { compact(view, {}, context); });
  step([&](MeshView view) {
    OpenMesh::MPropHandleT<std::string> title;
    view.mesh.add_property(title, "m:title");
    view.mesh.property(title) = "hello";
  });
  step([&](MeshView view) { property_to_fill<OpenMesh::MPropHandleT<std::string>>(view, "m:title"); });
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = changes.size(); i-- > 0;) {
      changes[i].undo(mesh);
      CAPTURE(i);
      REQUIRE(difference(state(), states[i]) == "");
    }
    for (std::size_t i = 0; i < changes.size(); ++i) {
      changes[i].redo(mesh);
      CAPTURE(i);
      REQUIRE(difference(state(), states[i + 1]) == "");
    }
  }
}

TEST_CASE("change_set: an operator that throws leaves the mesh as it was, positions of a float kernel included") {
  std::mt19937 random(8);
  BareKernel mesh;
  copy_mesh(torn(), mesh);
  add_properties(mesh);
  request_status(mesh);
  for (const auto v : mesh.vertices()) mesh.point(v) *= 1.0f / 3.0f;
  const MeshState before = state_of(mesh);
  CHECK_THROWS_AS(record(mesh,
                         [&](MeshView view) {
                           Storm(view, random).run(40);
                           throw Cancelled();
                         }),
                  Cancelled);
  CHECK(difference(state_of(mesh), before) == "");
}

TEST_CASE("change_set: a float kernel without status gets it and keeps it; its positions come back to the last bit") {
  BareKernel mesh;
  copy_mesh(bumpy_grid(5, 5), mesh);
  REQUIRE_FALSE(mesh.has_face_status());
  std::vector<OpenMesh::Vec3f> points(mesh.points(), mesh.points() + mesh.n_vertices());
  ChangeSet change = record(mesh, [](MeshView view) {
    set_point(view, VertexHandle(7), view.point(VertexHandle(7)) / 3.0);
    delete_face(view, FaceHandle(0));
  });
  CHECK(mesh.has_face_status());
  CHECK(mesh.status(FaceHandle(0)).deleted());
  const OpenMesh::Vec3f moved = mesh.point(VertexHandle(7));
  CHECK(moved != points[7]);
  change.undo(mesh);
  CHECK(mesh.has_face_status());
  CHECK_FALSE(mesh.status(FaceHandle(0)).deleted());
  CHECK(std::equal(points.begin(), points.end(), mesh.points()));
  change.redo(mesh);
  CHECK(mesh.point(VertexHandle(7)) == moved);
}

TEST_CASE("change_set: undo is refused where it does not fit, and says why") {
  Mesh mesh = torn(), other = torn();
  Context context;
  const auto refused = [](const auto& call, const std::string& words) {
    try {
      call();
      FAIL_CHECK("not refused");
    } catch (const InvalidInput& e) {
      CAPTURE(e.what());
      CHECK(std::string(e.what()).find(words) != std::string::npos);
    }
  };
  EdgeHandle edge;
  for (const auto e : mesh.edges())
    if (mesh.is_flip_ok(e)) edge = e;
  ChangeSet change = record(mesh, [&](MeshView view) { flip_edge(view, edge); });
  refused([&] { change.redo(mesh); }, "not undone");
  refused([&] { change.undo(other); }, "another mesh");
  {
    ChangeSet second = record(mesh, [](MeshView view) {
      split_face(view, FaceHandle(3), Vec3(0, 0, 0), {0.5, 0.25, 0.25});
    });
    const MeshState kept = state_of(mesh);
    refused([&] { change.undo(mesh); }, "vertices");  // first the second
    CHECK(difference(state_of(mesh), kept) == "");
    second.undo(mesh);
  }
  {
    ChangeSet second = record(mesh, [&](MeshView view) { flip_edge(view, edge); });
    refused([&] { change.undo(mesh); }, "changed since");
    second.undo(mesh);
  }
  mesh.status(FaceHandle(3)).set_selected(true);  // an editor may select
  change.undo(mesh);
  refused([&] { change.undo(mesh); }, "already undone");

  ChangeSet move = record(mesh, [](MeshView view) { set_point(view, VertexHandle(0), Vec3(9, 9, 9)); });
  mesh.set_point(VertexHandle(0), Vec3(8, 8, 8));
  refused([&] { move.undo(mesh); }, "changed since");
  CHECK(mesh.point(VertexHandle(0)) == Vec3(8, 8, 8));

  OpenMesh::VPropHandleT<int> number;
  mesh.add_property(number, "number");
  ChangeSet write = record(mesh, [&](MeshView view) {
    about_to_set(view, VertexHandle(1));
    view.mesh.property(number, VertexHandle(1)) = 5;
  });
  mesh.remove_property(number);
  refused([&] { write.undo(mesh); }, "'number' was removed");

  mesh.add_property(number, "lost");
  ChangeSet lost = record(mesh, [&](MeshView view) { view.mesh.remove_property(number); });
  refused([&] { lost.undo(mesh); }, "'lost' was removed while it was recorded");

  ChangeSet notes = record(
      mesh, [](MeshView view) { set_point(view, VertexHandle(0), Vec3(1, 1, 1)); }, Recording::notes_only);
  refused([&] { notes.undo(mesh); }, "notes only");
  CHECK(notes.notes().vertices_moved == std::vector<std::uint32_t>{0});

  ChangeSet nothing;
  CHECK(nothing.empty());
}

TEST_CASE("change_set: the notes name what was added, removed, moved and linked anew, and nothing else") {
  Mesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}},
                        {{0, 1, 2}, {0, 2, 3}, {1, 4, 2}, {4, 5, 2}});
  using List = std::vector<std::uint32_t>;
  const auto number = [](auto handle) { return static_cast<std::uint32_t>(handle.idx()); };
  const EdgeHandle diagonal = mesh.edge_handle(mesh.find_halfedge(VertexHandle(0), VertexHandle(2)));

  ChangeSet flip = record(mesh, [&](MeshView view) { flip_edge(view, diagonal); });
  CHECK(flip.notes().edges.relinked == List{number(diagonal)});
  CHECK(flip.notes().faces.relinked == List{0, 1});
  CHECK(flip.notes().vertices_moved.empty());
  CHECK(flip.notes().faces.added.empty());
  flip.undo(mesh);

  const std::size_t edges = mesh.n_edges();
  ChangeSet split = record(mesh, [&](MeshView view) {
    set_point(view, VertexHandle(5), Vec3(2, 2, 0));
    set_point(view, VertexHandle(4), view.point(VertexHandle(4)));  // to where it is
    split_edge(view, diagonal, Vec3(0.4, 0.4, 0), 0.4);
    const VertexHandle extra = add_vertex(view, Vec3(0, 0, 1));
    delete_vertex(view, extra);  // neither added nor removed
  });
  CHECK(split.notes().vertices.added == List{6});
  CHECK(split.notes().vertices_moved == List{5});
  CHECK(split.notes().faces.added == List{4, 5});
  CHECK(split.notes().faces.relinked == List{0, 1});
  CHECK(split.notes().edges.added == List{static_cast<std::uint32_t>(edges), static_cast<std::uint32_t>(edges + 1),
                                          static_cast<std::uint32_t>(edges + 2)});
  split.undo(mesh);

  ChangeSet removal = record(mesh, [](MeshView view) { delete_vertex(view, VertexHandle(5)); });
  CHECK(removal.notes().faces.removed == List{3});
  CHECK(removal.notes().vertices.removed == List{5});
  CHECK(removal.notes().edges.removed.size() == 2);
  CHECK(removal.notes().inverse().faces.added == List{3});
  removal.undo(mesh);

  mesh.request_face_colors();
  ChangeSet paint = record(mesh, [&](MeshView view) {
    about_to_set(view, FaceHandle(2));
    mesh.set_color(FaceHandle(2), Mesh::Color(1, 2, 3));
  });
  CHECK(paint.notes().faces.revalued == List{2});
  CHECK(paint.notes().faces.relinked.empty());
  paint.undo(mesh);

  Context context;
  CHECK(record(mesh, [&](MeshView view) { return fill_holes(view, {.max_edges = 3}, context); }).notes().empty());
  CHECK(record(mesh, [&](MeshView view) { return extract_boundaries(view, {}, context); })
            .notes()
            .properties_added.size() == 3);
}

TEST_CASE("change_set: the notes of random edits agree with a comparison of the whole mesh") {
  for (unsigned seed = 1; seed < 20; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    Mesh mesh = torn();
    const Mesh before = mesh;
    const ChangeSet change = record(
        mesh, [&](MeshView view) { Storm(view, random).run(12); },
        seed % 2 ? Recording::undoable : Recording::notes_only);
    const ChangeNotes& notes = change.notes();
    const auto has = [](const std::vector<std::uint32_t>& list, int i) {
      CHECK(std::is_sorted(list.begin(), list.end()));
      return std::binary_search(list.begin(), list.end(), static_cast<std::uint32_t>(i));
    };
    const auto there = [](const Mesh& m, auto h) {
      return h.idx() < static_cast<int>([&] {
               if constexpr (std::is_same_v<decltype(h), VertexHandle>)
                 return m.n_vertices();
               else if constexpr (std::is_same_v<decltype(h), EdgeHandle>)
                 return m.n_edges();
               else
                 return m.n_faces();
             }()) &&
             !m.status(h).deleted();
    };
    for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i) {
      const VertexHandle v(i);
      CHECK(has(notes.vertices.added, i) == (there(mesh, v) && !there(before, v)));
      CHECK(has(notes.vertices.removed, i) == (!there(mesh, v) && there(before, v)));
      if (there(mesh, v) && there(before, v)) CHECK(has(notes.vertices_moved, i) == (mesh.point(v) != before.point(v)));
    }
    for (int i = 0; i < static_cast<int>(mesh.n_edges()); ++i) {
      const EdgeHandle e(i);
      const HalfedgeHandle h(2 * i), o(2 * i + 1);
      CHECK(has(notes.edges.added, i) == (there(mesh, e) && !there(before, e)));
      CHECK(has(notes.edges.removed, i) == (!there(mesh, e) && there(before, e)));
      if (there(mesh, e) && there(before, e))
        CHECK(has(notes.edges.relinked, i) == (mesh.to_vertex_handle(h) != before.to_vertex_handle(h) ||
                                               mesh.to_vertex_handle(o) != before.to_vertex_handle(o)));
    }
    for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i) {
      const FaceHandle f(i);
      CHECK(has(notes.faces.added, i) == (there(mesh, f) && !there(before, f)));
      CHECK(has(notes.faces.removed, i) == (!there(mesh, f) && there(before, f)));
      if (!there(mesh, f) || !there(before, f)) continue;
      std::vector<int> corners, corners_before;
      for (const auto v : mesh.fv_range(f)) corners.push_back(v.idx());
      for (const auto v : before.fv_range(f)) corners_before.push_back(v.idx());
      if (corners != corners_before) CHECK(has(notes.faces.relinked, i));
    }
  }
}

TEST_CASE("change_set: a dry run reports and names what it would touch, and changes nothing; redo then does it") {
  EditorKernel mesh;
  copy_mesh(torn(), mesh);
  add_properties(mesh);
  const MeshState before = state_of(mesh);
  Context context;
  ChangeSet change = dry_run(mesh, fill_holes, {.max_edges = 20}, context);
  CHECK(difference(state_of(mesh), before) == "");
  REQUIRE(change.reports().size() == 1);
  CHECK(change.reports().front().faces_added > 0);
  CHECK(change.notes().faces.added.size() == change.reports().front().faces_added);
  change.redo(mesh);
  EditorKernel filled;
  copy_mesh(torn(), filled);
  add_properties(filled);
  record(filled, fill_holes, {.max_edges = 20}, context);
  CHECK(difference(state_of(mesh), state_of(filled)) == "");

  const Pipeline pipeline =
      Pipeline::from_json(R"({"version": 1, "steps": [{"op": "fill-holes"}, {"op": "flip-diagonals"}]})");
  ChangeSet whole = record(mesh, [&](MeshView view) { return pipeline.run(view, context); });
  CHECK(whole.reports().size() == 2);
}

TEST_CASE("change_set: polygon meshes are not triangle kernels, and a view without status is not recorded") {
  CHECK_FALSE(is_triangle_kernel<OpenMesh::PolyMesh_ArrayKernelT<>>);
  CHECK(is_triangle_kernel<BareKernel>);
  Mesh mesh = grid(2, 2);
  mesh.release_edge_status();
  CHECK_THROWS_AS(record(view_of(mesh), [](MeshView) {}), InvalidInput);
  CHECK_NOTHROW(record(mesh, [](MeshView) {}));  // requests it
  CHECK(mesh.has_edge_status());
}

TEST_CASE("change_set: what new elements inherit is the same in a recording, and an editor's own policy reaches it") {
  PropertyPolicy policy = PropertyPolicy::standard();
  policy.set_initial("editor:id", -7);
  EditorKernel mesh;
  copy_mesh(grid(2, 2), mesh);
  add_properties(mesh);
  OpenMesh::VPropHandleT<int> id;
  OpenMesh::VPropHandleT<float> weight;
  REQUIRE(mesh.get_property_handle(id, "editor:id"));
  REQUIRE(mesh.get_property_handle(weight, "editor:weight"));
  const auto split = [](MeshView view) { split_edge(view, EdgeHandle(0), Vec3(0.5, 0, 0), 0.5); };
  ChangeSet change = record(mesh, split, Recording::undoable, policy);
  const VertexHandle m(9);
  const auto h = EdgeHandle(0);
  CHECK(mesh.n_vertices() == 10);
  CHECK(mesh.property(id, m) == -7);
  const MeshState after = state_of(mesh);
  change.undo(mesh);
  const float a = mesh.property(weight, mesh.from_vertex_handle(mesh.halfedge_handle(h, 0)));
  const float b = mesh.property(weight, mesh.to_vertex_handle(mesh.halfedge_handle(h, 0)));
  change.redo(mesh);
  CHECK(difference(state_of(mesh), after) == "");
  CHECK(mesh.property(weight, m) == doctest::Approx((a + b) / 2));
}

TEST_CASE("property_policy: rules by name come before rules by type, and these before the general one") {
  PropertyPolicy policy = PropertyPolicy::standard();
  policy.types().add<Unknown>();
  policy.set_type<float>(NewValue::copy);
  policy.set("heat", NewValue::blend);
  policy.set("f:chart", NewValue::initial);
  policy.set_initial("number", 42);
  Mesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  OpenMesh::VPropHandleT<float> heat, cold;
  OpenMesh::VPropHandleT<int> number;
  OpenMesh::VPropHandleT<double> general;
  OpenMesh::FPropHandleT<int> chart;
  OpenMesh::VPropHandleT<Unknown> told;
  mesh.add_property(heat, "heat");
  mesh.add_property(cold, "cold");
  mesh.add_property(number, "number");
  mesh.add_property(general, "general");
  mesh.add_property(chart, "f:chart");
  mesh.add_property(told, "told");
  for (const auto v : mesh.vertices()) {
    mesh.property(heat, v) = mesh.property(cold, v) = static_cast<float>(v.idx());
    mesh.property(general, v) = v.idx();
    mesh.property(told, v).number = v.idx();
  }
  mesh.property(chart, FaceHandle(0)) = 5;
  MeshView view = view_of(mesh);
  view.policy = &policy;
  ChangeSet change = record(view, [](MeshView v) {
    split_face(v, FaceHandle(0), Vec3(0.2, 0.2, 0), {0.5, 0.25, 0.25});
  });
  const VertexHandle m(3);
  CHECK(mesh.property(heat, m) == doctest::Approx(mesh.property(general, m)));
  CHECK(mesh.property(cold, m) == std::floor(mesh.property(cold, m)));
  CHECK(mesh.property(number, m) == 42);
  CHECK(mesh.property(told, m).number == static_cast<int>(mesh.property(cold, m)));
  CHECK(mesh.property(chart, FaceHandle(0)) == 5);
  CHECK(mesh.property(chart, FaceHandle(1)) == 0);
  policy.set_general(NewValue::copy);
  const VertexHandle n = split_face(view, FaceHandle(1), Vec3(0.1, 0.1, 0), {0.5, 0.25, 0.25});
  CHECK(mesh.property(general, n) == std::max({mesh.property(general, n), std::floor(mesh.property(general, n))}));
}

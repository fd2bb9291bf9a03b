// Recording and undoing changes of a mesh of two million faces; beside it, a copy of the whole mesh, which is what undo
// costs without a recording. The check value is the number of faces that the change set names.

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

#include "meshops/editing/change_set.hpp"
#include "meshops/editing/mesh_edit.hpp"

namespace {

using namespace tri;

constexpr int columns = 1000;

/// A wavy grid of 1000 x 1000 cells with a property of each kind.
Mesh& big_mesh() {
  static const std::unique_ptr<Mesh> mesh = [] {
    auto m = std::make_unique<Mesh>();
    for (int y = 0; y <= columns; ++y)
      for (int x = 0; x <= columns; ++x) m->add_vertex(Vec3(x, y, std::sin(0.01 * x) * std::cos(0.013 * y)));
    m->reserve(m->n_vertices(), static_cast<std::size_t>(3 * columns * columns + 2 * columns),
               static_cast<std::size_t>(2 * columns * columns));
    for (int y = 0; y < columns; ++y)
      for (int x = 0; x < columns; ++x) {
        const int a = y * (columns + 1) + x, b = a + 1, c = b + columns + 1, d = c - 1;
        m->add_face(VertexHandle(a), VertexHandle(b), VertexHandle(c));
        m->add_face(VertexHandle(a), VertexHandle(c), VertexHandle(d));
      }
    OpenMesh::VPropHandleT<double> heat;
    OpenMesh::HPropHandleT<OpenMesh::Vec2f> texture;
    OpenMesh::FPropHandleT<std::string> label;
    m->add_property(heat, "heat");
    m->add_property(texture, "h:texture");
    m->add_property(label, "f:label");
    return m;
  }();
  return *mesh;
}

/// The diagonal of the i-th of 1000 cells, each in a row of its own.
EdgeHandle inner_edge(int i) {
  static const std::vector<EdgeHandle> edges = [] {
    std::vector<EdgeHandle> found;
    for (int y = 0; y < columns; ++y) {
      const VertexHandle a(y * (columns + 1) + (37 * y + 11) % columns), b(a.idx() + columns + 2);
      found.push_back(big_mesh().edge_handle(big_mesh().find_halfedge(a, b)));
    }
    return found;
  }();
  return edges[static_cast<std::size_t>(i)];
}

void report(benchmark::State& state, const ChangeSet& change) {
  state.counters["check"] =
      static_cast<double>(change.notes().faces.relinked.size() + change.notes().faces.added.size());
}

template <class Edit>
void record_and_undo(benchmark::State& state, const Edit& edit) {
  Mesh& mesh = big_mesh();
  ChangeSet change;
  for (auto _ : state) {
    change = record(mesh, [&](MeshView view) { edit(view); });
    change.undo(mesh);
  }
  report(state, change);
}

void flip_one(benchmark::State& state) {
  record_and_undo(state, [](MeshView view) { flip_edge(view, inner_edge(500)); });
}
BENCHMARK(flip_one)->Name("undo/flip/2M")->Unit(benchmark::kMicrosecond);

void flip_one_notes(benchmark::State& state) {
  Mesh& mesh = big_mesh();
  ChangeSet change;
  const EdgeHandle e = inner_edge(500);
  for (auto _ : state) {
    change = record(
        mesh, [&](MeshView view) { flip_edge(view, e); }, Recording::notes_only);
    flip_edge(view_of(mesh), e);  // back
  }
  report(state, change);
}
BENCHMARK(flip_one_notes)->Name("undo/flip-notes-only/2M")->Unit(benchmark::kMicrosecond);

void split_thousand(benchmark::State& state) {
  record_and_undo(state, [](MeshView view) {
    for (int i = 0; i < 1000; ++i) {
      const EdgeHandle e = inner_edge(i);
      split_edge(view, e, view.point(view.mesh.to_vertex_handle(view.mesh.halfedge_handle(e, 0))), 0.5);
    }
  });
}
BENCHMARK(split_thousand)->Name("undo/split-1000/2M")->Unit(benchmark::kMicrosecond);

void move_all(benchmark::State& state) {
  record_and_undo(state, [](MeshView view) {
    for (int i = 0; i < static_cast<int>(view.mesh.n_vertices()); ++i)
      set_point(view, VertexHandle(i), view.point(VertexHandle(i)) * 1.0000001);
  });
}
BENCHMARK(move_all)->Name("undo/move-all/2M")->Unit(benchmark::kMillisecond);

void flip_unrecorded(benchmark::State& state) {
  Mesh& mesh = big_mesh();
  const EdgeHandle e = inner_edge(500);
  for (auto _ : state) {
    flip_edge(view_of(mesh), e);
    flip_edge(view_of(mesh), e);
  }
}
BENCHMARK(flip_unrecorded)->Name("undo/two-flips-unrecorded/2M")->Unit(benchmark::kMicrosecond);

void copy_whole(benchmark::State& state) {
  const Mesh& mesh = big_mesh();
  for (auto _ : state) {
    const Mesh copy = mesh;
    benchmark::DoNotOptimize(copy.n_faces());
  }
}
BENCHMARK(copy_whole)->Name("undo/peer:copy-of-the-mesh/2M")->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();

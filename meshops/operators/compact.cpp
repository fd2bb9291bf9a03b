#include "meshops/operators/compact.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <functional>
#include <utility>

#include "meshops/editing/mesh_edit.hpp"
#include "meshops/editing/recorded_segments.hpp"
#include "meshops/error.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

using Connectivity = OpenMesh::TriConnectivity;
constexpr std::uint32_t removed = ElementMaps::removed;

/// New index of each element that stays, in order; `removed` for the others. Returns the number that stay.
template <class Goes>
std::size_t number_in_order(std::size_t count, const Goes& goes, std::vector<std::uint32_t>& map, Pace& pace) {
  map.resize(count);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < count; ++i, pace()) map[i] = goes(static_cast<int>(i)) ? removed : next++;
  return next;
}

/// Everything between an element and its new place goes, so swapping keeps the order of those that stay.
template <class Swap>
void move_down(const std::vector<std::uint32_t>& map, const Swap& swap) {
  for (std::size_t i = 0; i < map.size(); ++i)
    if (map[i] != removed && map[i] != i) swap(map[i], i);
}

using Tasks = std::vector<std::function<void()>>;

template <class Begin, class End>
void add_properties(Tasks& tasks, Begin begin, End end, const std::vector<std::uint32_t>& map) {
  for (auto it = begin; it != end; ++it)
    if (OpenMesh::BaseProperty* p = *it)
      tasks.push_back([p, &map] { move_down(map, [&](std::size_t to, std::size_t from) { p->swap(to, from); }); });
}

void check_consistent(const Connectivity& mesh, const ElementMaps& maps, Pace& pace) {
  for (std::size_t e = 0; e < maps.edges.size(); ++e, pace()) {
    if (maps.edges[e] == removed) continue;
    for (int side = 0; side < 2; ++side) {
      const HalfedgeHandle h = mesh.halfedge_handle(EdgeHandle(static_cast<int>(e)), side);
      if (maps.vertices[mesh.to_vertex_handle(h).idx()] == removed)
        throw InvalidInput(
            fmt::format("edge {} stays but its vertex {} is deleted", e, mesh.to_vertex_handle(h).idx()));
      if (!mesh.is_boundary(h) && maps.faces[mesh.face_handle(h).idx()] == removed)
        throw InvalidInput(fmt::format("edge {} stays but its face {} is deleted", e, mesh.face_handle(h).idx()));
      if (maps.edges[mesh.next_halfedge_handle(h).idx() / 2] == removed)
        throw InvalidInput(fmt::format("edge {} stays but the edge after it is deleted", e));
    }
  }
  for (std::size_t f = 0; f < maps.faces.size(); ++f, pace()) {
    const HalfedgeHandle h = mesh.halfedge_handle(FaceHandle(static_cast<int>(f)));
    if (maps.faces[f] != removed && maps.edges[h.idx() / 2] == removed)
      throw InvalidInput(fmt::format("face {} stays but its edge {} is deleted", f, h.idx() / 2));
  }
  for (std::size_t v = 0; v < maps.vertices.size(); ++v, pace()) {
    const HalfedgeHandle h = mesh.halfedge_handle(VertexHandle(static_cast<int>(v)));
    if (maps.vertices[v] != removed && h.is_valid() && maps.edges[h.idx() / 2] == removed)
      throw InvalidInput(fmt::format("vertex {} stays but its edge {} is deleted", v, h.idx() / 2));
  }
}

/// What takes turns with nothing else runs beside it, so that the part that cannot be interrupted is short.
void renumber(Connectivity& mesh, const ElementMaps& maps, const std::vector<std::uint32_t>& halfedges,
              const ElementCounts& counts) {
  Tasks tasks;
  tasks.push_back([&] {
    move_down(maps.vertices, [&](std::size_t to, std::size_t from) {
      std::swap(mesh.vertex(VertexHandle(static_cast<int>(to))), mesh.vertex(VertexHandle(static_cast<int>(from))));
    });
  });
  tasks.push_back([&] {
    move_down(maps.edges, [&](std::size_t to, std::size_t from) {
      std::swap(mesh.edge(EdgeHandle(static_cast<int>(to))), mesh.edge(EdgeHandle(static_cast<int>(from))));
    });
  });
  tasks.push_back([&] {
    move_down(maps.faces, [&](std::size_t to, std::size_t from) {
      std::swap(mesh.face(FaceHandle(static_cast<int>(to))), mesh.face(FaceHandle(static_cast<int>(from))));
    });
  });
  add_properties(tasks, mesh.vprops_begin(), mesh.vprops_end(), maps.vertices);
  add_properties(tasks, mesh.eprops_begin(), mesh.eprops_end(), maps.edges);
  add_properties(tasks, mesh.hprops_begin(), mesh.hprops_end(), halfedges);
  add_properties(tasks, mesh.fprops_begin(), mesh.fprops_end(), maps.faces);
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) { tasks[i](); });
  mesh.resize(counts.vertices, counts.edges, counts.faces);

  const auto renumbered = [&](HalfedgeHandle h) { return HalfedgeHandle(static_cast<int>(halfedges[h.idx()])); };
  const auto for_all = [](std::size_t count, const auto& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16384), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) body(static_cast<int>(i));
    });
  };
  for_all(counts.vertices, [&](int i) {
    const VertexHandle v(i);
    if (!mesh.is_isolated(v)) mesh.set_halfedge_handle(v, renumbered(mesh.halfedge_handle(v)));
  });
  for_all(2 * counts.edges, [&](int i) {
    const HalfedgeHandle h(i);
    mesh.set_vertex_handle(h, VertexHandle(static_cast<int>(maps.vertices[mesh.to_vertex_handle(h).idx()])));
    if (!mesh.is_boundary(h))
      mesh.set_face_handle(h, FaceHandle(static_cast<int>(maps.faces[mesh.face_handle(h).idx()])));
    // Also sets the previous half-edge of the next one, which nobody reads meanwhile, so every link is renumbered once.
    mesh.set_next_halfedge_handle(h, renumbered(mesh.next_halfedge_handle(h)));
  });
  for_all(counts.faces,
          [&](int i) { mesh.set_halfedge_handle(FaceHandle(i), renumbered(mesh.halfedge_handle(FaceHandle(i)))); });
}

}  // namespace

const OptionSchema& CompactOptions::schema() {
  using O = CompactOptions;
  static const OptionSchema schema =
      Schema<O>().boolean("isolated-vertices", &O::isolated_vertices, {.help = "drop vertices without a face as well"});
  return schema;
}

Report compact(MeshView view, const CompactOptions& options, Context& context) {
  validate(options);
  Connectivity& mesh = view.mesh;
  if (!mesh.has_vertex_status() || !mesh.has_edge_status() || !mesh.has_halfedge_status() || !mesh.has_face_status())
    throw InvalidInput("compact needs the status attributes of all elements; request them before elements are deleted");
  if (view.selection) throw InvalidInput("compact takes no selection: it renumbers the elements of the whole mesh");
  context.checkpoint();
  context.progress("compact", 0);

  Pace pace(context);
  ElementMaps maps;
  const std::size_t vertices = number_in_order(
      mesh.n_vertices(),
      [&](int i) {
        const VertexHandle v(i);
        return mesh.status(v).deleted() || (options.isolated_vertices && mesh.is_isolated(v));
      },
      maps.vertices, pace);
  const std::size_t edges = number_in_order(
      mesh.n_edges(), [&](int i) { return mesh.status(EdgeHandle(i)).deleted(); }, maps.edges, pace);
  const std::size_t faces = number_in_order(
      mesh.n_faces(), [&](int i) { return mesh.status(FaceHandle(i)).deleted(); }, maps.faces, pace);

  Report report;
  report.vertices_removed = mesh.n_vertices() - vertices;
  report.faces_removed = mesh.n_faces() - faces;
  const std::size_t edges_removed = mesh.n_edges() - edges;
  if (report.unchanged() && edges_removed == 0) {
    context.progress("compact", 1);
    return report;
  }
  if (edges_removed) report.figures["edges removed"] = static_cast<double>(edges_removed);
  check_consistent(mesh, maps, pace);
  context.progress("compact", 0.4);

  std::vector<std::uint32_t> halfedges(2 * maps.edges.size());
  for (std::size_t h = 0; h < halfedges.size(); ++h, pace())
    halfedges[h] = maps.edges[h / 2] == removed ? removed : 2 * maps.edges[h / 2] + static_cast<std::uint32_t>(h % 2);

  change_all(view, [&] { renumber(mesh, maps, halfedges, {vertices, edges, faces}); });
  context.progress("compact", 1);
  report.maps = std::move(maps);
  return report;
}

}  // namespace tri

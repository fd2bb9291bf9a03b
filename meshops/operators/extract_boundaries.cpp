#include "meshops/operators/extract_boundaries.hpp"

#include <fmt/format.h>

#include "meshops/editing/mesh_edit.hpp"

namespace tri {
namespace {

constexpr std::size_t noted_loops = 100;

}  // namespace

const OptionSchema& ExtractBoundariesOptions::schema() {
  using O = ExtractBoundariesOptions;
  static const OptionSchema schema =
      Schema<O>()
          .boolean("mark-vertices", &O::mark_vertices, {.help = "write the loop of each vertex as a vertex property"})
          .boolean("mark-edges", &O::mark_edges,
                   {.help = "write the loop of each edge, and whether it is outer, as edge properties"});
  return schema;
}

Report extract_boundaries(MeshView view, const ExtractBoundariesOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("extract-boundaries", 0);
  auto& mesh = view.mesh;
  std::vector<BoundaryLoop> loops = boundary_loops(view, &context);
  std::erase_if(loops, [&](const BoundaryLoop& loop) { return !view.may_fill(loop.halfedges); });
  context.checkpoint();

  Report report;
  report.operation = "extract-boundaries";
  if (options.mark_vertices) {
    const auto loop_of = property_to_fill<OpenMesh::VPropHandleT<int>>(view, property::boundary_loop);
    for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i) mesh.property(loop_of, VertexHandle(i)) = -1;
    for (std::size_t i = loops.size(); i-- > 0;)
      for (const HalfedgeHandle h : loops[i].halfedges)
        mesh.property(loop_of, mesh.from_vertex_handle(h)) = static_cast<int>(i);
  }
  if (options.mark_edges) {
    const auto loop_of = property_to_fill<OpenMesh::EPropHandleT<int>>(view, property::boundary_loop);
    const auto outer = property_to_fill<OpenMesh::EPropHandleT<int>>(view, property::boundary_outer);
    for (int i = 0; i < static_cast<int>(mesh.n_edges()); ++i)
      mesh.property(loop_of, EdgeHandle(i)) = mesh.property(outer, EdgeHandle(i)) = -1;
    for (std::size_t i = 0; i < loops.size(); ++i)
      for (const HalfedgeHandle h : loops[i].halfedges) {
        mesh.property(loop_of, mesh.edge_handle(h)) = static_cast<int>(i);
        mesh.property(outer, mesh.edge_handle(h)) = loops[i].outer ? 1 : 0;
      }
  }

  double edges = 0, length = 0, outer = 0;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const BoundaryLoop& loop = loops[i];
    edges += static_cast<double>(loop.halfedges.size());
    length += loop.length;
    outer += loop.outer;
    if (i >= noted_loops) continue;
    const Vec3& p = loop.polyline.front();
    report.notes.push_back(fmt::format("loop {}: {} edges, length {:.6g}, {}{}, from ({:.6g}, {:.6g}, {:.6g})", i,
                                       loop.halfedges.size(), loop.length,
                                       loop.outer ? "outer" : fmt::format("nested in {}", loop.parent),
                                       loop.simple ? "" : ", meets itself in a vertex", p[0], p[1], p[2]));
  }
  if (!loops.empty()) {
    report.figures["loops"] = static_cast<double>(loops.size());
    report.figures["outer loops"] = outer;
    report.figures["nested loops"] = static_cast<double>(loops.size()) - outer;
    report.figures["boundary edges"] = edges;
    report.figures["boundary length"] = length;
  }
  context.progress("extract-boundaries", 1);
  return report;
}

}  // namespace tri

#include "meshops/operators/fill_holes.hpp"

#include "meshops/add_faces.hpp"
#include "meshops/boundary_loops.hpp"
#include "meshops/fairing.hpp"
#include "meshops/mesh_edit.hpp"
#include "meshops/refine_faces.hpp"

namespace tri {

const OptionSchema& FillHolesOptions::schema() {
  using O = FillHolesOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("strategy", &O::strategy,
                  {{"nearest-diagonal", HoleStrategy::nearest_diagonal},
                   {"minimum-area-dihedral", HoleStrategy::minimum_area_dihedral},
                   {"minimum-area", HoleStrategy::minimum_area},
                   {"least-bending", HoleStrategy::least_bending}},
                  {.help = "how a hole is triangulated"})
          .integer("max-edges", &O::max_edges, {.unit = "edges", .min = 3, .help = "loops with more edges stay open"})
          .number("max-diameter", &O::max_diameter,
                  {.unit = "mm", .min = 0, .infinite = true, .help = "loops with two vertices farther apart stay open"})
          .integer("max-dynamic-edges", &O::max_dynamic_edges,
                   {.unit = "edges",
                    .min = 3,
                    .max = 1000,
                    .help = "longer loops are optimised piece by piece"})
          .boolean("refine", &O::refine, {.help = "puts vertices into the holes, as dense as at the rim"})
          .number("growth", &O::growth,
                  {.min = 0, .max = 10, .help = "growth of edges by distance from the rim when refining; 0: none"})
          .choice("fair", &O::fair,
                  {{"none", Fairness::none},
                   {"position", Fairness::position},
                   {"tangent", Fairness::tangent},
                   {"curvature", Fairness::curvature}},
                  {.help = "refines, and makes the filling go on smoothly from its surroundings"});
  return schema;
}

namespace {

/// Moves the vertices of a filling; false if neither kind of weight allows it.
bool fair_filling(MeshView view, const std::vector<VertexHandle>& vertices, Fairness fairness, const Context& context) {
  const Continuity continuity = fairness == Fairness::position  ? Continuity::position
                                : fairness == Fairness::tangent ? Continuity::tangent
                                                                : Continuity::curvature;
  for (const FairingWeights weights : {FairingWeights::cotangent, FairingWeights::uniform}) {
    const FairedPoints faired = faired_points(view, vertices, continuity, weights, context);
    if (faired.outcome != FairingOutcome::done) continue;
    for (std::size_t i = 0; i < faired.points.size(); ++i) set_point(view, faired.vertices[i], faired.points[i]);
    return true;
  }
  return false;
}

}  // namespace

Report fill_holes(MeshView view, const FillHolesOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  Report report;
  report.operation = "fill-holes";
  double filled = 0, cut = 0, not_faired = 0;
  const auto cycles = boundary_cycles(view);
  const auto sizes = cycles.empty() ? std::vector<std::size_t>() : component_sizes(view);
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    context.checkpoint();
    context.progress("fill-holes", static_cast<double>(i) / static_cast<double>(cycles.size()));
    if (!view.may_fill(cycles[i])) continue;
    Hole hole(view, cycles[i]);
    const auto skip = [&](const char* reason) { ++report.skipped[reason]; };
    if (hole.size() > options.max_edges) {
      skip("loop longer than max-edges");
    } else if (hole.wider_than(options.max_diameter)) {
      skip("loop wider than max-diameter");
    } else if (!hole.simple()) {
      skip("loop meets itself in a vertex");
    } else if (hole.around_single_triangle()) {
      skip("rim of a single triangle");
    } else if (hole.rim_of_sheet(
                   sizes[view.mesh.face_handle(view.mesh.opposite_halfedge_handle(cycles[i][0])).idx()])) {
      skip("rim of a sheet");
    } else if (options.reference && options.reference->keeps_open(hole.vertices())) {
      skip("kept open by the reference");
    } else {
      bool in_pieces = false;
      const std::vector<VertexTriple> triangles =
          hole.triangulate(options.strategy, options.max_dynamic_edges, context, in_pieces);
      std::vector<FaceHandle> added;
      if (triangles.empty() || add_faces(view, triangles, &added) != FitResult::fits) {
        skip("no triangulation without an existing edge");
        continue;
      }
      ++filled;
      cut += in_pieces;
      std::vector<VertexHandle> inner;
      if (options.refine || options.fair != Fairness::none) inner = refine_faces(view, added, options.growth, context);
      if (options.fair != Fairness::none && !inner.empty() && !fair_filling(view, inner, options.fair, context))
        ++not_faired;
      report.vertices_added += inner.size();
      for (const VertexHandle v : inner) report.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
      report.faces_added += added.size();
      for (const FaceHandle f : added) report.touched_faces.push_back(static_cast<std::uint32_t>(f.idx()));
      for (const VertexHandle v : hole.vertices())
        report.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
    }
  }
  if (!cycles.empty()) context.progress("fill-holes", 1);
  if (filled > 0) report.figures["holes filled"] = filled;
  if (cut > 0) report.figures["holes optimised in pieces"] = cut;
  if (not_faired > 0) report.figures["fillings not faired"] = not_faired;
  return report;
}

}  // namespace tri

#include "meshops/operators/fair.hpp"

#include <algorithm>

#include "meshops/editing/mesh_edit.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

std::vector<VertexHandle> chosen_vertices(MeshView view, const FairOptions& options) {
  const auto& mesh = view.mesh;
  std::vector<VertexHandle> chosen;
  if (!options.vertices.empty()) {
    chosen.assign(options.vertices.begin(), options.vertices.end());
    for (const VertexHandle v : chosen)
      if (!mesh.is_valid_handle(v) || mesh.status(v).deleted())
        throw InvalidInput("fair: vertex " + std::to_string(v.idx()) + " is not in the mesh");
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen;
  }
  OpenMesh::VPropHandleT<int> region;
  if (!options.region.empty() && !mesh.get_property_handle(region, options.region) && mesh.n_vertices() > 0)
    throw InvalidInput("fair: the mesh has no vertex property \"" + options.region + "\" of whole numbers");
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i) {
    const VertexHandle v(i);
    if (mesh.status(v).deleted()) continue;
    if (region.is_valid() ? mesh.property(region, v) > 0 : mesh.status(v).selected()) chosen.push_back(v);
  }
  return chosen;
}

}  // namespace

const OptionSchema& FairOptions::schema() {
  using O = FairOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("continuity", &O::continuity,
                  {{"position", Continuity::position},
                   {"tangent", Continuity::tangent},
                   {"curvature", Continuity::curvature}},
                  {.help = "how smoothly the region goes on from what stays around it"})
          .choice("weights", &O::weights,
                  {{"cotangent", FairingWeights::cotangent}, {"uniform", FairingWeights::uniform}},
                  {.help = "cotangent keeps vertices from sliding along the surface, uniform spreads them"})
          .text("region", &O::region,
                {.help = "vertex property whose values above 0 choose what moves; empty: the selected vertices"});
  return schema;
}

Report fair(MeshView view, const FairOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("fair", 0);
  Report report;
  report.operation = "fair";
  std::vector<VertexHandle> moving;
  for (const VertexHandle v : chosen_vertices(view, options)) {
    if (!view.may_move(v)) continue;
    if (view.mesh.is_isolated(v))
      ++report.skipped["isolated vertex"];
    else if (view.mesh.is_boundary(v))
      ++report.skipped["boundary vertex"];
    else
      moving.push_back(v);
  }
  if (moving.empty()) {
    context.progress("fair", 1);
    return report;
  }
  FairedPoints faired = faired_points(view, moving, options.continuity, options.weights, context);
  if (faired.without_rim > 0) report.skipped["no neighbour stays"] = faired.without_rim;
  if (options.weights == FairingWeights::cotangent &&
      (faired.outcome == FairingOutcome::no_area || faired.outcome == FairingOutcome::singular)) {
    report.notes.push_back("uniform weights, since with cotangents: " + std::string(to_string(faired.outcome)));
    faired = faired_points(view, moving, options.continuity, FairingWeights::uniform, context);
  }
  if (faired.outcome != FairingOutcome::done && faired.outcome != FairingOutcome::nothing_to_move)
    report.skipped[std::string(to_string(faired.outcome))] = faired.vertices.size();
  double largest = 0;
  for (std::size_t i = 0; i < faired.points.size(); ++i) {
    const VertexHandle v = faired.vertices[i];
    const double distance = (faired.points[i] - view.point(v)).norm();
    if (distance == 0) continue;
    largest = std::max(largest, distance);
    set_point(view, v, faired.points[i]);
    ++report.vertices_moved;
    report.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
  }
  if (largest > 0) report.figures["largest distance"] = largest;
  context.progress("fair", 1);
  return report;
}

}  // namespace tri

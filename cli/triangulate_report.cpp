#include "cli/triangulate_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/program.hpp"
#include "meshops/version.hpp"

namespace tri::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string topology_text(const SurfaceTopology& t) {
  return fmt::format("{} components, {} loops, Euler {}", t.components, t.loops, t.euler);
}

}  // namespace

Json triangulate_report(const TriangulateResult& r, const CadModel& model, std::uint64_t points, const Json& options) {
  Json json{{"version", version}, {"options", options}, {"points", points}};
  json.update(to_json(r, model));
  return json;
}

std::string triangulate_summary(const TriangulateResult& r, const CadModel& model, std::uint64_t points) {
  std::string text = fmt::format("{} triangles through {} of {} points", with_commas(r.mesh.n_faces()),
                                 with_commas(r.mesh.n_vertices()), with_commas(points));
  if (!r.outliers.empty()) text += fmt::format(", {} outliers left out", with_commas(r.outliers.size()));
  if (!r.duplicates.empty()) text += fmt::format(", {} duplicates left out", with_commas(r.duplicates.size()));
  text += fmt::format("\nmethod {}: {}\n", name_of(r.method), r.method_reason);
  text += fmt::format("deviation: standard deviation {:.4g} mm\n", r.sigma);
  text += r.checks.model == r.checks.mesh
              ? fmt::format("topology: {}, as the model has it\n", topology_text(r.checks.mesh))
              : fmt::format("topology: {}; the model has {}\n", topology_text(r.checks.mesh),
                            topology_text(r.checks.model));
  if (r.checks.self_intersections > 0)
    text += fmt::format("self-intersections: {} pairs of triangles\n", with_commas(r.checks.self_intersections));
  if (!r.unmeasured_faces.empty())
    text += fmt::format("faces without a point: {} of {}\n", r.unmeasured_faces.size(), r.faces.size());
  if (!r.holes.empty()) text += fmt::format("not measured, left open: {} regions\n", r.holes.size());
  constexpr std::size_t shown = 5;
  for (std::size_t i = 0; i < std::min(shown, r.holes.size()); ++i) {
    const UnmeasuredRegion& h = r.holes[i];
    text += fmt::format("  at ({:.4g}, {:.4g}, {:.4g}), radius {:.4g} mm, on faces {}\n", h.center[0], h.center[1],
                        h.center[2], h.radius, fmt::join(h.faces, ", "));
  }
  if (r.holes.size() > shown) text += fmt::format("  and {} more; --report has them all\n", r.holes.size() - shown);
  for (const UnusableFace& f : model.unusable_faces)
    text += fmt::format("face {} of the model is unusable: {}\n", f.index, f.reason);
  for (const std::string& note : r.notes) text += note + "\n";
  return text;
}

}  // namespace tri::cli

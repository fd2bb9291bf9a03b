#include "cli/triangulate_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/program.hpp"
#include "meshops/version.hpp"

namespace tri::cli {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Vec3& p) { return {p[0], p[1], p[2]}; }

Json to_json(const SurfaceTopology& t) { return {{"components", t.components}, {"loops", t.loops}, {"euler", t.euler}}; }

std::string to_text(const SurfaceTopology& t) {
  return fmt::format("{} components, {} loops, Euler {}", t.components, t.loops, t.euler);
}

}  // namespace

const char* name_of(Method method) {
  switch (method) {
    case Method::automatic:
      return "auto";
    case Method::patches:
      return "patches";
    case Method::shell:
      return "shell";
  }
  return "";
}

Json triangulate_report(const TriangulateResult& r, const CadModel& model, std::uint64_t points, const Json& options) {
  Json json{{"version", version},
            {"options", options},
            {"points", points},
            {"vertices", r.mesh.n_vertices()},
            {"triangles", r.mesh.n_faces()},
            {"method", name_of(r.method)},
            {"method_reason", r.method_reason},
            {"sigma", r.sigma},
            {"outliers", r.outliers},
            {"duplicates", r.duplicates}};
  json["faces"] = Json::array();
  for (const FaceCoverage& f : r.faces)
    json["faces"].push_back(
        {{"face", f.face}, {"name", f.name}, {"points", f.points}, {"area", f.area}, {"method", f.method}});
  json["unmeasured_faces"] = r.unmeasured_faces;
  json["holes"] = Json::array();
  for (const UnmeasuredRegion& h : r.holes)
    json["holes"].push_back(
        {{"center", to_json(h.center)}, {"radius", h.radius}, {"spacing", h.spacing}, {"faces", h.faces}});
  json["unusable_faces"] = Json::array();
  for (const UnusableFace& f : model.unusable_faces)
    json["unusable_faces"].push_back({{"face", f.index}, {"name", f.name}, {"reason", f.reason}});
  json["topology"] = {{"model", to_json(r.checks.model)},
                      {"mesh", to_json(r.checks.mesh)},
                      {"same", r.checks.model == r.checks.mesh}};
  json["checks"] = {{"self_intersections", r.checks.self_intersections},
                    {"folds", r.checks.folds},
                    {"turned", r.checks.turned},
                    {"bridging", r.checks.bridging},
                    {"bridging_share", r.checks.bridging_share},
                    {"unused_points", r.checks.unused_points}};
  json["seconds"] = Json::object();
  for (const auto& [step, seconds] : r.seconds) json["seconds"][step] = seconds;
  json["steps"] = Json::array();
  for (const Report& report : r.steps) json["steps"].push_back(tri::to_json(report));
  json["notes"] = r.notes;
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
              ? fmt::format("topology: {}, as the model has it\n", to_text(r.checks.mesh))
              : fmt::format("topology: {}; the model has {}\n", to_text(r.checks.mesh), to_text(r.checks.model));
  if (r.checks.self_intersections > 0)
    text += fmt::format("self-intersections: {} pairs of triangles\n", with_commas(r.checks.self_intersections));
  if (!r.unmeasured_faces.empty())
    text += fmt::format("faces without a point: {} of {}\n", r.unmeasured_faces.size(), r.faces.size());
  if (!r.holes.empty()) text += fmt::format("not measured, left open: {} regions\n", r.holes.size());
  constexpr std::size_t shown = 5;
  for (std::size_t i = 0; i < std::min(shown, r.holes.size()); ++i) {
    const UnmeasuredRegion& h = r.holes[i];
    text += fmt::format("  at ({:.4g}, {:.4g}, {:.4g}), radius {:.4g} mm, on faces {}\n", h.center[0], h.center[1], h.center[2],
                        h.radius, fmt::join(h.faces, ", "));
  }
  if (r.holes.size() > shown) text += fmt::format("  and {} more; --report has them all\n", r.holes.size() - shown);
  for (const UnusableFace& f : model.unusable_faces)
    text += fmt::format("face {} of the model is unusable: {}\n", f.index, f.reason);
  for (const std::string& note : r.notes) text += note + "\n";
  return text;
}

}  // namespace tri::cli

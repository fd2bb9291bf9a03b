#include <fmt/format.h>

#include "cli/deviation_report.hpp"
#include "cli/page_parts.hpp"
#include "cli/program.hpp"
#include "cli/triangulate_report.hpp"
#include "io/html/html_text.hpp"

namespace tri::cli {
namespace {

std::string words(const SurfaceTopology& t) {
  return fmt::format("{} components, {} loops, Euler {}", t.components, t.loops, t.euler);
}

HtmlTable hole_table(const TriangulateResult& r, const CadModel& model) {
  HtmlTable table;
  table.title = "Not measured";
  table.caption = "Regions of the model without points, which are open in the mesh.";
  table.columns = {{"middle, mm"}, {"radius, mm", true}, {"point spacing around, mm", true}, {"faces"}};
  for (const UnmeasuredRegion& h : r.holes)
    table.rows.push_back({place_text(h.center, model.diagonal), fmt::format("{:.4g}", h.radius),
                          fmt::format("{:.4g}", h.spacing), fmt::format("{}", fmt::join(h.faces, ", "))});
  return table;
}

}  // namespace

HtmlReport triangulate_page(const TriangulateResult& r, const CadModel& model, const TriangulateInputs& inputs,
                            const Soup& mesh, const Context& context) {
  const std::vector<Foot> feet = feet_of(r.mesh, model);
  const Deviations d = deviations(model, mesh.points, feet, {}, context);
  DeviationReport report;
  report.cad = inputs.cad;
  report.measured = inputs.points;
  report.triangles = mesh.triangles.size();
  report.model = &model;
  report.deviations = &d;
  report.scale = scale_of(d.values, std::nullopt);
  report.options_json = inputs.options;
  report.facts = {
      {"Method", name_of(r.method)},
      {"Topology", r.checks.model == r.checks.mesh ? words(r.checks.mesh) + ", as the model"
                                                   : words(r.checks.mesh) + "; the model: " + words(r.checks.model)},
      {"Made", date_now()}};
  report.blocks = {{"Summary", inputs.alignment + triangulate_summary(r, model, inputs.count)}};
  report.notes = r.notes;
  if (!r.outliers.empty())
    report.notes.insert(report.notes.begin(),
                        fmt::format("{} of {} points are outliers and left out; the JSON report lists them.",
                                    with_commas(r.outliers.size()), with_commas(inputs.count)));
  HtmlReport page = deviation_page(report, feet);
  page.kind = "Triangulation report";
  page.scene = &mesh;
  if (!r.holes.empty()) page.tables.push_back(hole_table(r, model));
  return page;
}

}  // namespace tri::cli

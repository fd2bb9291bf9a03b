#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/compare_options.hpp"
#include "cli/deviation_report.hpp"
#include "cli/page_parts.hpp"
#include "libtri/tessellation.hpp"

namespace tri::cli {
namespace {

constexpr double backdrop_deflection = 0.001;  // of the diagonal
constexpr double backdrop_angle = 0.3;         // radians
constexpr double suspicious_share = 0.05;      // of the diagonal

// The model in grey behind points.
Soup backdrop_of(const CadModel& model, const Context& context) {
  Tessellation t = tessellate(model, backdrop_deflection * model.diagonal, backdrop_angle, context);
  Soup soup;
  soup.points = std::move(t.points);
  soup.triangles = std::move(t.triangles);
  return soup;
}

void warn_of_frame(const Deviations& d, const CadModel& model) {
  if (d.values.empty()) return;
  std::vector<double> sizes;
  for (const double v : d.values) sizes.push_back(std::abs(v));
  const double median = percentile(sizes, 0.5);
  if (median > suspicious_share * model.diagonal)
    print_note(fmt::format("half of the points are farther than {:.4g} mm from the model; are they in its frame, and in the right --units?",
                           median));
}

}  // namespace

int compare_with_model(const CompareOptions& o, Program& program) {
  Context& context = program.context;
  const CadModel model = read_model(o.model, program);
  CompareResults results;
  Soup& soup = results.colored;
  soup = read_measured(o.inputs[0], o, program);
  const std::vector<Foot> feet = Registration(model, context).register_points(soup.points, context);

  DeviationReport report;
  report.options.tolerance = o.tolerance;
  if (o.max_distance > 0) report.options.max_distance = o.max_distance;
  const Deviations d = deviations(model, soup.points, feet, report.options, context);
  if (!program.quiet) warn_of_frame(d, model);
  report.cad = o.model.path;
  report.measured = o.inputs[0];
  report.triangles = soup.triangles.size();
  report.model = &model;
  report.deviations = &d;
  report.scale = scale_of(counted_values(d), o.tolerance);
  report.options_json = to_json(o);
  report.facts = {{"Alignment", "none: compared as they lie"}, {"Made", date_now()}};
  if (report.triangles > 0) report.notes.push_back("The vertices of the mesh were measured, not the insides of its triangles.");

  soup.vertex_scalars["deviation"] = d.values;
  soup.vertex_scalars["cad_face"].assign(d.faces.begin(), d.faces.end());
  if (!o.output.empty()) paint(soup, report.scale);
  results.json = deviation_json(report);
  results.csv = deviation_csv(report);
  results.text = deviation_text(report);
  Soup backdrop;
  results.page = [&] {
    HtmlReport page = deviation_page(report, feet);
    page.scene = &soup;
    if (soup.triangles.empty()) {
      backdrop = backdrop_of(model, context);
      page.backdrop = &backdrop;
    }
    return page;
  };
  return finish(o, program, results);
}

}  // namespace tri::cli

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cli/compare_options.hpp"
#include "cli/deviation_report.hpp"
#include "cli/page_parts.hpp"
#include "libtri/model/tessellation.hpp"

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
    print_note(
        fmt::format("half of the points are farther than {:.4g} mm from the model; are they in its frame, and in the "
                    "right --units?",
                    median));
}

void add_alignment(DeviationReport& report, const std::optional<AlignResult>& alignment, const AlignInput& input) {
  if (!alignment) {
    report.facts.push_back({"Alignment", "none: compared as they lie"});
    return;
  }
  report.facts.push_back({"Alignment", input.mode == "none" ? "as given"
                                       : alignment->kept
                                           ? "already on the model, not moved"
                                           : fmt::format("{}, {}", input.mode, name_of(alignment->status))});
  std::string text = alignment_text(*alignment) + "\n";
  for (const auto& row : alignment->pose.matrix())
    text += fmt::format("{:14.9f} {:14.9f} {:14.9f} {:16.9f}\n", row[0], row[1], row[2], row[3]);
  report.blocks.push_back({"Pose that takes the points to the model", text});
  report.alignment = to_json(*alignment);
  if (input.mode != "none")
    for (const std::string& reason : alignment->reasons) report.notes.push_back("Alignment: " + reason);
}

}  // namespace

int compare_with_model(const CompareOptions& o, Program& program) {
  Context& context = program.context;
  const CadModel model = read_model(o.model, program);
  CompareResults results;
  Soup& soup = results.colored;
  double factor = 1;
  soup = read_measured(o.inputs[0], o, program, &factor);
  const Registration registration(model, context);
  const std::optional<AlignResult> alignment =
      align_points(o.align, model, registration, soup.points, soup.vertex_normals, factor, context);
  const std::vector<Foot> feet = registration.register_points(soup.points, context);

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
  add_alignment(report, alignment, o.align);
  if (o.align.probe_radius > 0)
    report.facts.push_back(
        {"Probe", fmt::format("ball of {:.6g} mm: deviations are of the places it touched", o.align.probe_radius)});
  report.facts.push_back({"Made", date_now()});
  if (report.triangles > 0)
    report.notes.push_back("The vertices of the mesh were measured, not the insides of its triangles.");

  soup.vertex_scalars["deviation"] = d.values;
  soup.vertex_scalars["cad_face"].assign(d.faces.begin(), d.faces.end());
  if (!o.output.empty()) paint(soup, report.scale);
  results.json = deviation_json(report);
  results.csv = deviation_csv(report);
  results.text = (alignment ? alignment_text(*alignment) : "") + deviation_text(report);
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

#include "cli/deviation_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/page_parts.hpp"
#include "cli/program.hpp"
#include "io/html/html_text.hpp"
#include "io/result_json.hpp"
#include "meshops/version.hpp"

namespace tri::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string csv_numbers(const ValueStatistics& s, bool tolerance) {
  if (s.count == 0) return tolerance ? "0,,,,,,,,,0," : "0,,,,,,,,,,";
  std::string text = fmt::format("{},{},{},{},{},{},{},{},{},", s.count, s.mean, s.rms, s.standard_deviation, s.min,
                                 s.p5, s.median, s.p95, s.max);
  if (!tolerance) return text + ",";
  return text +
         fmt::format("{},{}", s.in_tolerance, static_cast<double>(s.in_tolerance) / static_cast<double>(s.count));
}

std::string row(const std::string& name, const ValueStatistics& s, int decimals, bool tolerance,
                const std::string& behind) {
  std::string text = fmt::format("{:>8} {:>10}", name, with_commas(s.count));
  for (const double v : {s.mean, s.standard_deviation, s.rms, s.min, s.max})
    text += fmt::format(" {:>10.{}f}", v, decimals);
  if (tolerance)
    text += fmt::format(" {:>8.2f}%", 100.0 * static_cast<double>(s.in_tolerance) / static_cast<double>(s.count));
  return text + (behind.empty() ? "" : "  " + behind) + "\n";
}

}  // namespace

Json deviation_json(const DeviationReport& r) {
  const Deviations& d = *r.deviations;
  const bool tolerance = r.options.tolerance.has_value();
  Json json{{"version", version},
            {"options", r.options_json},
            {"measured", r.triangles > 0 ? "vertices of a mesh" : "points"},
            {"points", d.values.size()},
            {"triangles", r.triangles},
            {"alignment", r.alignment},
            {"tolerance", nullptr},
            {"colors", {{"low", r.scale.low}, {"high", r.scale.high}}}};
  if (tolerance) json["tolerance"] = {r.options.tolerance->low, r.options.tolerance->high};
  json.update(to_json(d, *r.model, r.options));
  json["notes"] = r.notes;
  return json;
}

std::string deviation_csv(const DeviationReport& r) {
  const bool tolerance = r.options.tolerance.has_value();
  std::string text =
      "face,name,surface,area,points,mean,rms,standard_deviation,min,p5,median,p95,max,in_tolerance,share_in_"
      "tolerance\n";
  double area = 0;
  for (const FaceDeviation& f : r.deviations->per_face) area += f.area;
  text += fmt::format("all,,,{},", area) + csv_numbers(r.deviations->overall, tolerance) + "\n";
  for (const FaceDeviation& f : r.deviations->per_face)
    text += fmt::format("{},{},{},{},", f.face, csv_field(f.name), csv_field(f.surface_type), f.area) +
            csv_numbers(f.statistics, tolerance) + "\n";
  return text;
}

std::string deviation_text(const DeviationReport& r) {
  const Deviations& d = *r.deviations;
  const ValueStatistics& s = d.overall;
  const bool tolerance = r.options.tolerance.has_value();
  std::string text = fmt::format("{}: deviation of {} {} from {}\n", r.measured, with_commas(d.values.size()),
                                 r.triangles > 0 ? "vertices" : "points", r.cad);
  if (!d.far.empty()) {
    text += fmt::format("{} of them are farther than {:g} mm and not counted: {}", with_commas(d.far.size()),
                        *r.options.max_distance, name_of_one(r));
    constexpr std::size_t shown = 10;
    for (std::size_t i = 0; i < std::min(shown, d.far.size()); ++i)
      text += fmt::format("{} {}", i > 0 ? "," : "", d.far[i]);
    text += d.far.size() > shown ? fmt::format(" and {} more; --report has them all\n", d.far.size() - shown) : "\n";
  }
  if (s.count == 0) return text + "no point is left\n";
  if (tolerance)
    text += fmt::format("in tolerance {}: {} of {} ({})\n", tolerance_text(r.options.tolerance),
                        with_commas(s.in_tolerance), with_commas(s.count), percent(s));
  const int decimals = decimals_for(std::max({std::abs(s.min), std::abs(s.max), 1e-9}));
  text += fmt::format("\n{:>8} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}{}\n", "face", "points", "mean", "std dev",
                      "RMS", "min", "max", tolerance ? "    in tol" : "");
  text += row("all", s, decimals, tolerance, "");
  std::vector<int> without;
  for (const FaceDeviation& f : d.per_face) {
    if (f.statistics.count == 0)
      without.push_back(f.face);
    else
      text += row(std::to_string(f.face), f.statistics, decimals, tolerance, f.name);
  }
  if (!without.empty()) {
    constexpr std::size_t shown = 20;
    const bool cut = without.size() > shown;
    const std::size_t count = without.size();
    without.resize(std::min(shown, count));
    text += fmt::format("\n{} of {} faces without a point: {}{}\n", count, d.per_face.size(), fmt::join(without, ", "),
                        cut ? ", …" : "");
  }
  text += "\nworst places:\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(5, d.spots.size()); ++i) {
    const DeviationSpot& spot = d.spots[i];
    text += fmt::format("  {:+.{}f} mm at ({:.6g}, {:.6g}, {:.6g}), {} {}, face {}\n", spot.deviation, decimals,
                        spot.position[0], spot.position[1], spot.position[2], name_of_one(r), spot.point, spot.face);
  }
  for (const UnusableFace& f : r.model->unusable_faces)
    text += fmt::format("face {} of the model is unusable: {}\n", f.index, f.reason);
  for (const std::string& note : r.notes) text += note + "\n";
  return text + scale_note(r.scale, "mm") + "\n";
}

}  // namespace tri::cli

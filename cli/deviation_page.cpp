#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/deviation_report.hpp"
#include "cli/page_parts.hpp"
#include "cli/program.hpp"
#include "io/html/html_text.hpp"

namespace tri::cli {
namespace {

HtmlTable face_table(const DeviationReport& r, int decimals) {
  const bool tolerance = r.options.tolerance.has_value();
  HtmlTable table;
  table.title = "Faces of the model";
  table.caption = "Deviations in mm. A click on a face shows it, a click on a head sorts.";
  table.columns = {{"face", true}, {"name"},          {"surface"},    {name_of_many(r), true},
                   {"mean", true}, {"std dev", true}, {"RMS", true},  {"min", true},
                   {"5 %", true},  {"median", true},  {"95 %", true}, {"max", true}};
  if (tolerance) table.columns.push_back({"in tolerance", true});
  for (const FaceDeviation& f : r.deviations->per_face) {
    const ValueStatistics& s = f.statistics;
    std::vector<std::string> cells{std::to_string(f.face), f.name, f.surface_type, with_commas(s.count)};
    for (const double v : {s.mean, s.standard_deviation, s.rms, s.min, s.p5, s.median, s.p95, s.max})
      cells.push_back(s.count > 0 ? fixed_text(v, decimals) : "");
    if (tolerance) cells.push_back(percent(s));
    table.rows.push_back(std::move(cells));
    table.faces.push_back(s.count > 0 ? f.face : 0);
  }
  return table;
}

HtmlTable far_table(const DeviationReport& r) {
  constexpr std::size_t shown = 200;
  const Deviations& d = *r.deviations;
  HtmlTable table;
  table.title = "Too far to be counted";
  table.caption =
      fmt::format("{} {} are farther than {:g} mm from the model and take no part in the numbers.{}",
                  with_commas(d.far.size()), name_of_many(r), *r.options.max_distance,
                  d.far.size() > shown ? fmt::format(" The first {} of them; the JSON report lists all.", shown) : "");
  table.columns = {{name_of_one(r), true}, {"deviation, mm", true}, {"nearest face", true}};
  for (std::size_t i = 0; i < std::min(shown, d.far.size()); ++i)
    table.rows.push_back(
        {std::to_string(d.far[i]), fmt::format("{:+.4g}", d.values[d.far[i]]), std::to_string(d.faces[d.far[i]])});
  return table;
}

void add_figures(HtmlReport& page, const DeviationReport& r, int decimals) {
  const ValueStatistics& s = r.deviations->overall;
  const auto mm = [&](double v, bool sign) {
    return sign ? signed_text(v, decimals) + " mm" : fmt::format("{:.{}f} mm", v, decimals);
  };
  if (r.options.tolerance)
    page.figures.push_back({"in tolerance", percent(s),
                            fmt::format("{} of {} {} outside", with_commas(s.count - s.in_tolerance),
                                        with_commas(s.count), name_of_many(r)),
                            s.in_tolerance < s.count});
  page.figures.push_back({"mean", mm(s.mean, true), fmt::format("median {}", mm(s.median, true))});
  page.figures.push_back(
      {"standard deviation", mm(s.standard_deviation, false), fmt::format("RMS {}", mm(s.rms, false))});
  page.figures.push_back({fmt::format("90 % of the {}", name_of_many(r)),
                          signed_text(s.p5, decimals) + " … " + signed_text(s.p95, decimals),
                          "5th to 95th percentile, mm"});
  page.figures.push_back({"lowest", mm(s.min, true),
                          fmt::format("{} {}, face {}", name_of_one(r), s.min_index, r.deviations->faces[s.min_index]),
                          r.options.tolerance && s.min < r.options.tolerance->low});
  page.figures.push_back({"highest", mm(s.max, true),
                          fmt::format("{} {}, face {}", name_of_one(r), s.max_index, r.deviations->faces[s.max_index]),
                          r.options.tolerance && s.max > r.options.tolerance->high});
}

}  // namespace

HtmlReport deviation_page(const DeviationReport& r, std::span<const Foot> feet) {
  const Deviations& d = *r.deviations;
  const ValueStatistics& s = d.overall;
  const int decimals = decimals_for(std::max(std::abs(r.scale.low), std::abs(r.scale.high)));
  const auto faces_met = std::count_if(d.per_face.begin(), d.per_face.end(),
                                       [](const FaceDeviation& f) { return f.statistics.count > 0; });
  HtmlReport page;
  page.title = file_name(r.measured);
  page.facts = {
      {"CAD model", fmt::format("{} ({} faces)", r.cad, d.per_face.size())},
      {"Measured",
       fmt::format("{} ({} {})", r.measured, with_commas(d.values.size()),
                   r.triangles > 0 ? fmt::format("vertices, {} triangles", with_commas(r.triangles)) : "points")},
      {"Faces measured", fmt::format("{} of {}", faces_met, d.per_face.size())},
      {"Tolerance", tolerance_text(r.options.tolerance)}};
  page.facts.insert(page.facts.end(), r.facts.begin(), r.facts.end());
  page.scale = r.scale;
  page.scale_note = "Signed distance from the model, positive outside. " + scale_note(r.scale, "mm");
  page.notes = r.notes;
  for (const UnusableFace& f : r.model->unusable_faces)
    page.notes.push_back(fmt::format("Face {} of the model is unusable and was not compared: {}", f.index, f.reason));
  if (s.count > 0) {
    add_figures(page, r, decimals);
    page.histogram = histogram_to_show(counted_values(d), r.scale);
    page.mean = s.mean;
  } else {
    page.notes.push_back("No point is near enough to be counted.");
  }
  page.spot_columns = {{"deviation", true}, {"face", true}, {"place, mm"}};
  for (const DeviationSpot& spot : d.spots) {
    const std::array<float, 3>& n = feet[spot.point].normal;
    page.spots.push_back(
        {spot.position,
         Vec3(n[0], n[1], n[2]),
         fmt::format("{:+.{}f} mm   face {}\n{} {}", spot.deviation, decimals, spot.face, name_of_one(r), spot.point),
         {signed_text(spot.deviation, decimals), std::to_string(spot.face),
          place_text(spot.position, r.model->diagonal)}});
  }
  page.tables.push_back(face_table(r, decimals));
  if (!d.far.empty()) page.tables.push_back(far_table(r));
  page.blocks = r.blocks;
  page.blocks.push_back(options_block(r.options_json));
  return page;
}

}  // namespace tri::cli

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/compare_options.hpp"
#include "cli/page_parts.hpp"
#include "io/html/html_text.hpp"
#include "meshops/checks/mesh_distance.hpp"
#include "meshops/version.hpp"

namespace tri::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double spot_radius = 0.1;  // of the diagonal
constexpr std::size_t spots = 10;

// The comparison, as every report states it.
struct Meshes {
  const CompareOptions& options;
  const Soup& first;
  const MeshDistance& distance;
  ValueStatistics at_vertices;  // signed, of the first
  DeviationScale scale;
  int decimals = 3;

  const std::string& a() const { return options.inputs[0]; }
  const std::string& b() const { return options.inputs[1]; }
  std::string mm(double v) const { return fmt::format("{:.{}f}", v, decimals); }
};

Json meshes_json(const Meshes& m) {
  Json json{{"version", version}, {"options", to_json(m.options)}};
  json.update(to_json(m.distance));
  json["colors"] = {{"low", m.scale.low}, {"high", m.scale.high}};
  json["vertices"] = statistics_json(m.at_vertices, m.options.tolerance.has_value());
  return json;
}

std::string meshes_csv(const Meshes& m) {
  std::string text = "from,to,area,samples,mean,mean_error,rms,max,max_bound\n";
  const auto row = [&](const std::string& from, const std::string& to, const OneSidedDistance& d) {
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", csv_field(from), csv_field(to), d.area, d.samples, d.mean,
                        d.mean_error, d.rms, d.max, d.max_bound);
  };
  row(m.a(), m.b(), m.distance.forward);
  row(m.b(), m.a(), m.distance.backward);
  return text;
}

std::string direction_text(const std::string& from, const std::string& to, const OneSidedDistance& d) {
  std::string text = fmt::format("from {} to {}: mean {:.6g} (standard error at most {:.2g}), RMS {:.6g}\n", from, to,
                                 d.mean, d.mean_error, d.rms);
  text += d.samples > 0 ? fmt::format("  over {} places, {:.3g} a square mm\n", with_commas(d.samples),
                                      static_cast<double>(d.samples) / d.area)
                        : "  over the vertices, as the surface has no area\n";
  return text + fmt::format("  greatest {:.6g}, proven to be at most {:.6g}, at ({:.6g}, {:.6g}, {:.6g})\n", d.max,
                            d.max_bound, d.place[0], d.place[1], d.place[2]);
}

std::string meshes_text(const Meshes& m) {
  const MeshDistance& d = m.distance;
  const ValueStatistics& s = m.at_vertices;
  std::string text =
      fmt::format("Hausdorff distance {:.6g} mm, proven to be at most {:.6g} mm\n", d.hausdorff, d.hausdorff_bound);
  text += fmt::format("RMS {:.6g} mm, mean {:.6g} mm over both surfaces\n", d.rms, d.mean);
  text += direction_text(m.a(), m.b(), d.forward) + direction_text(m.b(), m.a(), d.backward);
  text += fmt::format(
      "signed, at the {} vertices of {}: mean {:+.4g}, standard deviation {:.4g}, from {:+.4g} to {:+.4g} mm\n",
      with_commas(s.count), m.a(), s.mean, s.standard_deviation, s.min, s.max);
  if (m.options.tolerance)
    text += fmt::format("in tolerance {:+g} to {:+g} mm: {} of {} vertices ({})\n", m.options.tolerance->low,
                        m.options.tolerance->high, with_commas(s.in_tolerance), with_commas(s.count), percent(s));
  return text + scale_note(m.scale, "mm") + "\n";
}

void add_mesh_figures(HtmlReport& page, const Meshes& m) {
  const MeshDistance& d = m.distance;
  const ValueStatistics& s = m.at_vertices;
  if (m.options.tolerance)
    page.figures.push_back(
        {"in tolerance", percent(s),
         fmt::format("{} of {} vertices outside", with_commas(s.count - s.in_tolerance), with_commas(s.count)),
         s.in_tolerance < s.count});
  page.figures.push_back({"Hausdorff distance", m.mm(d.hausdorff) + " mm",
                          fmt::format("proven to be at most {} mm", m.mm(d.hausdorff_bound))});
  page.figures.push_back({"RMS distance", m.mm(d.rms) + " mm", fmt::format("mean {} mm, over both", m.mm(d.mean))});
  page.figures.push_back({"mean deviation", signed_text(s.mean, m.decimals) + " mm",
                          fmt::format("standard deviation {} mm", m.mm(s.standard_deviation))});
  page.figures.push_back({"lowest", signed_text(s.min, m.decimals) + " mm", fmt::format("vertex {}", s.min_index),
                          m.options.tolerance && s.min < m.options.tolerance->low});
  page.figures.push_back({"highest", signed_text(s.max, m.decimals) + " mm", fmt::format("vertex {}", s.max_index),
                          m.options.tolerance && s.max > m.options.tolerance->high});
}

HtmlTable direction_table(const Meshes& m) {
  HtmlTable table;
  table.title = "Distances";
  table.caption =
      "From every place of one surface to the closest place of the other, in mm. The greatest is searched between "
      "proven bounds; mean "
      "and RMS are over random places, stratified by area.";
  table.columns = {{"from"},
                   {"to"},
                   {"area, mm²", true},
                   {"places", true},
                   {"mean", true},
                   {"standard error, at most", true},
                   {"RMS", true},
                   {"greatest", true},
                   {"proven bound", true}};
  const auto row = [&](const std::string& from, const std::string& to, const OneSidedDistance& d) {
    table.rows.push_back({from, to, fmt::format("{:.6g}", d.area), with_commas(d.samples), m.mm(d.mean),
                          fmt::format("{:.2g}", d.mean_error), m.mm(d.rms), m.mm(d.max), m.mm(d.max_bound)});
  };
  row(m.a(), m.b(), m.distance.forward);
  row(m.b(), m.a(), m.distance.backward);
  return table;
}

void add_spots(HtmlReport& page, const Meshes& m) {
  Vec3 low = m.first.points[0], high = low;
  for (const Vec3& p : m.first.points) low.minimize(p), high.maximize(p);
  std::vector<double> severity;
  for (const double v : m.distance.forward.vertices)
    severity.push_back(m.options.tolerance ? m.options.tolerance->excess(v) : std::abs(v));
  page.spot_columns = {{"deviation", true}, {"vertex", true}, {"place, mm"}};
  const double diagonal = (high - low).norm();
  const bool back = m.distance.backward.max > m.distance.forward.max;
  const OneSidedDistance& greater = back ? m.distance.backward : m.distance.forward;
  page.spots.push_back(
      {greater.place,
       Vec3(0, 0, 0),
       fmt::format("{} mm from {}\ngreatest distance", m.mm(greater.max), file_name(back ? m.a() : m.b())),
       {m.mm(greater.max), back ? "greatest, of the other" : "greatest", place_text(greater.place, diagonal)}});
  for (const std::uint32_t i : worst_places(m.first.points, severity, spot_radius * diagonal, spots)) {
    const std::string value = signed_text(m.distance.forward.vertices[i], m.decimals);
    page.spots.push_back({m.first.points[i],
                          Vec3(0, 0, 0),
                          fmt::format("{} mm\nvertex {}", value, i),
                          {value, std::to_string(i), place_text(m.first.points[i], diagonal)}});
  }
}

HtmlReport meshes_page(const Meshes& m) {
  HtmlReport page;
  page.kind = "Comparison of two meshes";
  page.title = file_name(m.a());
  page.facts = {{"Compared", fmt::format("{} ({} vertices, {} triangles)", m.a(), with_commas(m.first.points.size()),
                                         with_commas(m.first.triangles.size()))},
                {"With", fmt::format("{} ({} vertices)", m.b(), with_commas(m.distance.backward.vertices.size()))},
                {"Tolerance", tolerance_text(m.options.tolerance)},
                {"Made", date_now()}};
  page.scene = &m.first;
  page.scale = m.scale;
  page.scale_note =
      fmt::format("Signed distance of the vertices of {} from {}, positive on the side that its triangles face. {}",
                  file_name(m.a()), file_name(m.b()), scale_note(m.scale, "mm"));
  add_mesh_figures(page, m);
  page.histogram = histogram_to_show(m.distance.forward.vertices, m.scale);
  page.mean = m.at_vertices.mean;
  add_spots(page, m);
  page.tables = {direction_table(m)};
  page.blocks = {options_block(to_json(m.options))};
  return page;
}

}  // namespace

int compare_meshes(const CompareOptions& o, Program& program) {
  Context& context = program.context;
  CompareResults results;
  Soup& first = results.colored;
  first = read_measured(o.inputs[0], o, program);
  const Soup second = read_measured(o.inputs[1], o, program);
  MeshDistanceOptions options;
  if (o.samples > 0) options.samples = o.samples;
  options.seed = o.seed;
  const MeshDistance d = mesh_distance(first, second, options, context);

  Meshes m{o, first, d, value_statistics(d.forward.vertices, o.tolerance, context),
           scale_of(d.forward.vertices, o.tolerance)};
  m.decimals = decimals_for(std::max(m.scale.high, -m.scale.low));
  first.vertex_scalars["deviation"] = d.forward.vertices;
  first.vertex_scalars.erase("cad_face");  // of another comparison
  if (!o.output.empty()) paint(first, m.scale);
  results.json = meshes_json(m);
  results.csv = meshes_csv(m);
  results.text = meshes_text(m);
  results.page = [&] { return meshes_page(m); };
  return finish(o, program, results);
}

}  // namespace tri::cli

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "cli/commands.hpp"
#include "cli/compare_options.hpp"
#include "cli/number_checks.hpp"
#include "cli/page_parts.hpp"
#include "io/atomic_file.hpp"
#include "io/json_file.hpp"
#include "io/mesh_file.hpp"
#include "meshops/points/point_soup.hpp"

namespace tri::cli {
namespace {

// "-0.1,0.2", or "0.1" for -0.1,0.1.
Tolerance parse_tolerance(const std::string& text) {
  const auto comma = text.find(',');
  const auto number = [&](const std::string& part) {
    double value = 0;
    if (!CLI::detail::lexical_cast(part, value) || !std::isfinite(value))
      throw UsageError(fmt::format("--tolerance {}: not two numbers LOW,HIGH or one number", text));
    return value;
  };
  Tolerance tolerance;
  tolerance.high = number(comma == std::string::npos ? text : text.substr(comma + 1));
  tolerance.low = comma == std::string::npos ? -tolerance.high : number(text.substr(0, comma));
  if (!(tolerance.low < tolerance.high))
    throw UsageError(fmt::format("--tolerance {}: its lower end must be below its upper end", text));
  return tolerance;
}

}  // namespace

Soup read_measured(const std::string& path, const CompareOptions& options, Program& program, double* factor) {
  PointsFileInfo file;
  Soup soup;
  if (kind_of(path) == "mesh") {
    soup = read_mesh(path, program.context);
    const double millimetres = factor_of(options.units, file);
    if (millimetres != 1)
      for (Vec3& p : soup.points) p *= millimetres;
  } else {
    soup = to_soup(read_points_in_mm(path, options.units, program, &file));
  }
  if (factor) *factor = factor_of(options.units, file);
  return soup;
}

nlohmann::ordered_json to_json(const CompareOptions& o) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
#ifdef TRI_WITH_CAD
  if (!o.model.path.empty()) {
    json["cad"] = o.model.path;
    json["sew"] = o.model.sew;
    json.update(to_json(o.align));
  }
#endif
  json["files"] = o.inputs;
  json["units"] = o.units.given;
  json["tolerance"] = nullptr;
  if (o.tolerance) json["tolerance"] = {o.tolerance->low, o.tolerance->high};
  json["max_distance"] = nullptr;
  if (o.max_distance > 0) json["max_distance"] = o.max_distance;
  return json;
}

void paint(Soup& soup, const DeviationScale& scale) {
  const std::vector<double>& values = soup.vertex_scalars.at("deviation");
  soup.vertex_colors.resize(soup.points.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Vec3 color = deviation_color(values[i], scale);
    for (int k = 0; k < 3; ++k)
      soup.vertex_colors[i][static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(std::lround(255 * color[k]));
  }
}

int finish(const CompareOptions& o, Program& program, CompareResults& results) {
  program.context.checkpoint();
  Context uncancelled;  // an interrupt between two files would leave half of the result
  std::string written;
  for (const std::string& path : o.reports) {
    if (is_page(path))
      write_page(path, results.page(), program);
    else
      write_json(path, results.json);
    written += fmt::format("{}: the report\n", path);
  }
  if (!o.csv.empty()) {
    write_file(o.csv, results.csv);
    written += fmt::format("{}: the table\n", o.csv);
  }
  if (!o.output.empty()) {
    write_mesh(o.output, results.colored, {}, uncancelled);
    written += fmt::format("{}: {} in the colours of the deviation\n", o.output,
                           results.colored.triangles.empty() ? "points" : "mesh");
  }
  if (o.json)
    print_result(results.json);
  else
    print_result(results.text + written);
  return exit_done;
}

void add_compare_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("compare", "Say how a measured part deviates from its CAD model, or a mesh from a mesh");
  const auto a = std::make_shared<CompareOptions>();
  const auto tolerance = std::make_shared<std::string>();
#ifdef TRI_WITH_CAD
  add_model_options(*command, a->model, false);
#endif
  command
      ->add_option("files", a->inputs,
                   "With --cad: the measured points or mesh, in the model's frame. Without: two meshes")
      ->required()
      ->expected(1, 2);
  command
      ->add_option("-o,--output", a->output,
                   "Points or mesh in the colours of the deviation: .ply, with deviation and cad_face")
      ->type_name("FILE");
  command
      ->add_option("--report", a->reports,
                   ".html: one page that opens anywhere, with the part to turn; .json: all numbers. May be "
                   "given for each")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command->add_option("--csv", a->csv, "The table: one line for all points and one a face")->type_name("FILE");
  command
      ->add_option(
          "--tolerance", *tolerance,
          "LOW,HIGH in mm, or one number for both sides: what is within is in tolerance, and the colours end there. "
          "Without, they end where 98% of the points do")
      ->type_name("LOW,HIGH");
  command
      ->add_option(
          "--max-distance", a->max_distance,
          "With --cad: points farther from the model, in mm, are listed and not counted; default: all are counted")
      ->check(above_zero());
  command
      ->add_option(
          "--samples", a->samples,
          "Of two meshes: places on each surface that mean and RMS are taken over; default: as many as vertices, at "
          "least 100,000")
      ->check(CLI::Range(1.0, 1e10));
#ifdef TRI_WITH_CAD
  add_align_options(*command, a->align);  // its seed is that of the places, too
#else
  command->add_option("--seed", a->seed, "Of these places")->capture_default_str();
#endif
  add_units_option(*command, a->units);
  command->add_flag("--json", a->json, "All numbers as JSON on standard output");
  add_common_options(*command, program);
  command->footer(
      "With --cad: the signed distance of each point from the trimmed model, positive outside; overall and for each "
      "face\n"
      "the mean, standard deviation, RMS, extremes, percentiles and the share in tolerance. Of a mesh the vertices "
      "count.\n"
      "Points are compared as they lie, unless --align, --pose or --pairs says otherwise.\n"
      "Two meshes: the Hausdorff distance between proven bounds, mean and RMS over both areas.\n\n"
      "Examples:\n"
      "  tri compare --cad part.step scan.xyz --tolerance -0.1,0.1 --report part.html\n"
      "  tri compare --cad part.step scan.csv --align auto -o colours.ply --csv faces.csv\n"
      "  tri compare before.stl after.stl -o colours.ply");
  command->callback([a, tolerance, &program] {
    bool with_model = false;
#ifdef TRI_WITH_CAD
    with_model = !a->model.path.empty();
    a->seed = a->align.seed;
    if (!with_model && (a->align.mode != "none" || !a->align.pose.empty() || !a->align.pairs.empty()))
      throw UsageError("--align, --pose and --pairs need --cad");
#endif
    if (a->inputs.size() != (with_model ? 1 : 2))
      throw UsageError(with_model ? "compare --cad takes one file of points or a mesh"
                                  : "compare takes two meshes, or --cad and one file of points or a mesh");
    if (!a->output.empty()) require_extension(a->output, {"ply"}, "the output");
    if (!a->csv.empty()) require_extension(a->csv, {"csv"}, "the table");
    for (const std::string& report : a->reports) require_extension(report, {"html", "htm", "json"}, "the report");
    if (!tolerance->empty()) a->tolerance = parse_tolerance(*tolerance);
    if (!std::isfinite(a->max_distance)) throw UsageError("--max-distance is not a finite number");
    if (!with_model) {
      if (a->max_distance > 0) throw UsageError("--max-distance needs --cad");
      for (const std::string& input : a->inputs)
        if (!kind_of(input).empty() && kind_of(input) != "mesh")
          throw UsageError(fmt::format("compare takes two meshes, or --cad and one file: \"{}\" is no mesh", input));
    }
    program.action = [a, with_model, &program] {
      for (const std::string& path : {a->output, a->csv})
        if (!path.empty()) check_output(path);
      for (const std::string& path : a->reports) check_output(path);
#ifdef TRI_WITH_CAD
      if (with_model) return compare_with_model(*a, program);
#endif
      return compare_meshes(*a, program);
    };
  });
}

}  // namespace tri::cli

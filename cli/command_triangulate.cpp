#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>

#include "cli/alignment.hpp"
#include "cli/commands.hpp"
#include "cli/model_input.hpp"
#include "cli/number_checks.hpp"
#include "cli/page_parts.hpp"
#include "cli/points_input.hpp"
#include "cli/triangulate_report.hpp"
#include "io/json_file.hpp"
#include "io/mesh_file.hpp"
#include "libtri/triangulation/triangulate.hpp"
#include "meshops/points/point_soup.hpp"
#include "meshops/to_soup.hpp"

namespace tri::cli {
namespace {

struct TriangulateArguments {
  ModelInput model;
  AlignInput align;
  std::string points, output, patches, method = "auto", unmeasured = "hole";
  double hole_size = 3, noise = 0, outlier_distance = 0;
  std::vector<std::string> reports;
  PointUnits units;
  PointsPreparation preparation;
  bool ascii = false, json = false;
};

nlohmann::ordered_json options_json(const TriangulateArguments& a, const PointsFileInfo& file) {
  nlohmann::ordered_json json{{"cad", a.model.path},        {"points", a.points},       {"method", a.method},
                              {"unmeasured", a.unmeasured}, {"hole_size", a.hole_size}, {"sew", a.model.sew},
                              {"outlier_distance", nullptr}};
  if (a.outlier_distance > 0) json["outlier_distance"] = a.outlier_distance;
  json.update(to_json(a.align));
  json.update(to_json(a.units, file));
  json.update(to_json(a.preparation));
  return json;
}

TriangulateOptions options_of(const TriangulateArguments& a) {
  TriangulateOptions options;
  options.method = a.method == "patches" ? Method::patches : a.method == "shell" ? Method::shell : Method::automatic;
  options.unmeasured = a.unmeasured == "span" ? Unmeasured::span : Unmeasured::hole;
  options.hole_size = a.hole_size;
  if (a.outlier_distance > 0) options.outlier_distance = a.outlier_distance;
  options.keep_patches = !a.patches.empty();
  return options;
}

void write(const std::string& path, Mesh& mesh, const PointSet& set, const PreparedPoints& prepared,
           const TriangulateArguments& a, Program& program) {
  Context uncancelled;  // an interrupt between two files would leave half of the result
  Soup soup = to_soup(view_of(mesh));
  carry_columns(soup, set, prepared.original);
  const MeshWriteReport written = write_mesh(path, soup, {.ascii = a.ascii}, uncancelled);
  if (program.quiet) return;
  for (const std::string& note : written.notes) print_note(path + ": " + note);
}

int run(const TriangulateArguments& a, Program& program) {
  Context& context = program.context;
  for (const std::string& path : {a.output, a.patches})
    if (!path.empty()) check_output(path);
  for (const std::string& path : a.reports) check_output(path);
  PointsInBackground background(a.points, a.units, program);
  const CadModel model = read_model(a.model, program);
  PointsFileInfo file;
  PointSet set = background.get(&file);
  const PreparedPoints prepared = prepare(set, a.preparation, context);
  const Registration registration(model, context);
  const std::optional<AlignResult> alignment =
      align_points(a.align, model, registration, set.points, set.normals, factor_of(a.units, file), context);
  TriangulateResult result = triangulate(model, registration, set.points, options_of(a), context);
  context.checkpoint();

  prepared.name_as_in_file(result.outliers);
  prepared.name_as_in_file(result.duplicates);
  auto report = triangulate_report(result, model, set.points.size(), options_json(a, file));
  add_to_report(report, prepared);
  if (alignment) report["alignment"] = to_json(*alignment);
  if (result.patches) write(a.patches, *result.patches, set, prepared, a, program);
  write(a.output, result.mesh, set, prepared, a, program);
  std::string written;
  for (const std::string& path : a.reports) {
    if (is_page(path)) {
      const Soup mesh = to_soup(view_of(result.mesh));
      const TriangulateInputs inputs{a.model.path, a.points, set.points.size(), options_json(a, file),
                                     alignment ? alignment_text(*alignment) : ""};
      Context uncancelled;
      write_page(path, triangulate_page(result, model, inputs, mesh, uncancelled), program);
    } else {
      write_json(path, report);
    }
    written += fmt::format("{}: the report\n", path);
  }
  if (a.json)
    print_result(report);
  else
    print_result(summary(prepared) + (alignment ? alignment_text(*alignment) : "") +
                 triangulate_summary(result, model, set.points.size()) + fmt::format("{}: the mesh\n", a.output) +
                 (result.patches ? fmt::format("{}: the mesh before stitching\n", a.patches) : "") + written);
  return exit_done;
}

}  // namespace

void add_triangulate_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("triangulate", "Make one mesh of a CAD file and unordered points measured on the part");
  const auto a = std::make_shared<TriangulateArguments>();
  add_model_options(*command, a->model);
  command
      ->add_option("points", a->points,
                   "Measured points in any pose: XYZ, ASC, CSV, TXT, PLY, PCD, PTX or E57, in any order")
      ->required();
  command
      ->add_option(
          "-o,--output", a->output,
          "Mesh to write: .ply (with point index, CAD face, u, v, deviation, and what the file says of each point), .stl, .obj, .off, .3mf, .glb, .gltf, .vtp")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--report", a->reports,
                   "Write what was made and what is missing: .html makes a page with the part to turn and its "
                   "deviation, any other name JSON. May be given for each")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command->add_option("--patches", a->patches, "Also write the mesh before stitching: one patch for each CAD face")
      ->type_name("FILE");
  command
      ->add_option("--method", a->method,
                   "patches: Delaunay on each face, stitched at the edges; shell: insertion into the "
                   "model's own triangulation; auto: patches, and where its checks find something the better of both")
      ->check(CLI::IsMember({"auto", "patches", "shell"}))
      ->capture_default_str();
  command
      ->add_option("--unmeasured", a->unmeasured,
                   "Where nothing was measured: leave a hole, or span it by long triangles")
      ->check(CLI::IsMember({"hole", "span"}))
      ->capture_default_str();
  command
      ->add_option("--hole-size", a->hole_size,
                   "A gap is a hole when it holds a disc of more than so many local point "
                   "spacings in radius")
      ->check(above_zero())
      ->capture_default_str();
  command
      ->add_option("--noise", a->noise,
                   "Standard deviation of the measurement in mm: points farther than 6 of them from "
                   "the model are outliers")
      ->check(above_zero());
  command
      ->add_option("--outlier-distance", a->outlier_distance,
                   "Points farther than this from the model, in mm, are outliers; default: by the points' own spread")
      ->check(above_zero())
      ->excludes("--noise");
  add_align_options(*command, a->align);
  add_units_option(*command, a->units);
  add_preparation_options(*command, a->preparation);
  command->add_flag("--ascii", a->ascii, "Text instead of binary, for PLY and STL");
  command->add_flag("--json", a->json, "The report on standard output");
  add_common_options(*command, program);
  command->footer(
      "Every point that is not reported as an outlier is a vertex, once, at its measured position, aligned to\n"
      "the model; points that already lie on it are not moved at all. A region without points stays open and is named in\n"
      "the report; that is a result, not a failure.\n\n"
      "Examples:\n"
      "  tri triangulate --cad lid.igs lid.xyz -o lid.ply --report lid.json\n"
      "  tri triangulate --cad part.step scan.csv -o part.stl --unmeasured span\n"
      "  tri triangulate --cad lid.igs lid.xyz -o lid.ply --method patches --patches patches.ply");
  command->callback([a, &program] {
    require_extension(a->output, mesh_extensions, "the mesh");
    if (!a->patches.empty()) require_extension(a->patches, mesh_extensions, "the mesh before stitching");
    for (const double value : {a->hole_size, a->noise, a->outlier_distance})
      if (!std::isfinite(value)) throw UsageError("an option is not a finite number");
    if (a->noise > 0) a->outlier_distance = 6 * a->noise;
    program.action = [a, &program] { return run(*a, program); };
  });
}

}  // namespace tri::cli

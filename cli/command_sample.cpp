#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <numbers>

#include "cli/commands.hpp"
#include "cli/model_input.hpp"
#include "cli/number_checks.hpp"
#include "io/json_file.hpp"
#include "io/points_file.hpp"
#include "io/truth_file.hpp"
#include "libtri/sampling/virtual_measurement.hpp"

namespace tri::cli {
namespace {

struct SampleArguments {
  std::string cad, output, truth, pose, pattern = "random";
  MeasurementOptions options;
  double max_angle = 75;  // degrees
  std::vector<double> flat_views, flat_centres;
  bool no_truth = false, json = false;
};

std::vector<Vec3> in_threes(const std::vector<double>& flat) {
  std::vector<Vec3> list;
  for (std::size_t i = 0; i + 2 < flat.size(); i += 3) list.push_back({flat[i], flat[i + 1], flat[i + 2]});
  return list;
}

// "scan.xyz" and ".truth.csv" make "scan.truth.csv".
std::string beside(const std::string& path, const std::string& ending) {
  const auto dot = path.rfind('.'), slash = path.rfind('/');
  const bool has_ending = dot != std::string::npos && (slash == std::string::npos || dot > slash);
  return path.substr(0, has_ending ? dot : path.size()) + ending;
}

nlohmann::ordered_json pose_json(const VirtualMeasurement& m) {
  return {{"matrix", m.to_model}, {"meaning", "takes the points to the model"}};
}

int run(const SampleArguments& a, Program& program) {
  Context& context = program.context;
  for (const std::string& path : {a.output, a.truth, a.pose})
    if (!path.empty()) check_output(path);
  const CadFile cad = read_cad_or_end(a.cad, context);
  const VirtualMeasurement m = measure(cad.shape, a.options, context);
  if (!program.quiet)
    for (const int face : m.unusable_faces)
      print_note(fmt::format("face {} cannot be sampled and holds no point", face));
  context.checkpoint();
  Context uncancelled;  // an interrupt between two files would leave half of the result
  if (!a.truth.empty()) write_truth(a.truth, m, uncancelled);
  if (!a.pose.empty()) write_json(a.pose, pose_json(m));
  write_points(a.output, {m.points, {}}, uncancelled);
  if (a.json) {
    nlohmann::ordered_json json{{"points_file", a.output},
                                {"truth_file", nullptr},
                                {"pose_file", nullptr},
                                {"points", m.points.size()},
                                {"spacing", m.spacing},
                                {"line_spacing", m.line_spacing},
                                {"unusable_faces", m.unusable_faces},
                                {"drop_out_centres", nlohmann::ordered_json::array()}};
    if (!a.truth.empty()) json["truth_file"] = a.truth;
    if (!a.pose.empty()) json["pose_file"] = a.pose;
    for (const Vec3& c : m.drop_out_centres) json["drop_out_centres"].push_back({c[0], c[1], c[2]});
    print_result(json);
    return exit_done;
  }
  std::string text = fmt::format("{}: {} points, spacing {:.4g} mm", a.output, with_commas(m.points.size()), m.spacing);
  if (m.line_spacing > 0) text += fmt::format(", lines {:.4g} mm apart", m.line_spacing);
  text += "\n";
  if (!a.truth.empty()) text += fmt::format("{}: where each point truly lies\n", a.truth);
  if (!a.pose.empty()) text += fmt::format("{}: the motion that takes the points back to the model\n", a.pose);
  print_result(text);
  return exit_done;
}

}  // namespace

void add_sample_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("sample", "Measure a CAD model virtually: points with noise, and the truth beside them");
  const auto a = std::make_shared<SampleArguments>();
  MeasurementOptions& o = a->options;
  command->add_option("--cad", a->cad, "CAD model: IGES, STEP or BREP")->required()->type_name("FILE");
  command->add_option("-o,--output", a->output, "Points to write: .xyz, .txt, .asc, .csv, .ply or .pcd, in millimetres")
      ->required()
      ->type_name("FILE");
  command->add_option("-n,--points", o.points, "How many")->check(CLI::Range(1.0, 1e9))->capture_default_str();
  command->add_option("--pattern", a->pattern, "random over the area, on scan lines, or a grid on every face")
      ->check(CLI::IsMember({"random", "scan", "grid"}))
      ->capture_default_str();
  command->add_option("--line-ratio", o.line_ratio, "scan: distance between lines over distance along a line")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  command->add_option("--noise", o.noise, "Standard deviation along the normal, mm")
      ->check(not_negative())
      ->capture_default_str();
  command->add_option("--outliers", o.outliers, "Share of points moved away by 1% to 10% of the part's diagonal")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--drop-out", o.drop_out_radius, "Radius in mm of the places that were not measured")
      ->check(not_negative())
      ->capture_default_str();
  command->add_option("--drop-outs", o.drop_outs, "How many such places, chosen at random")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  command->add_option("--drop-out-at", a->flat_centres, "A further such place; may be given several times")
      ->delimiter(',')
      ->type_size(3)
      ->expected(1, 100000)
      ->type_name("X,Y,Z");
  command
      ->add_option("--view", a->flat_views,
                   "Direction from the part to the sensor, which sees what is not hidden; may be "
                   "given several times. Default: all sides are measured")
      ->delimiter(',')
      ->type_size(3)
      ->expected(1, 100000)
      ->type_name("X,Y,Z");
  command->add_option("--max-angle", a->max_angle, "Largest angle in degrees between the sensor's view and the normal")
      ->check(CLI::Range(1e-6, 90.0))
      ->capture_default_str();
  command->add_flag("--move", o.move, "A random rigid motion; its inverse goes to a pose file");
  command->add_flag("--shuffle", o.shuffle, "Points in random order");
  command->add_option("--seed", o.seed, "The same seed gives the same points")->capture_default_str();
  command->add_option("--truth", a->truth, "Where to write the truth; default: beside the points, ending in .truth.csv")
      ->type_name("FILE");
  command->add_flag("--no-truth", a->no_truth, "Do not write it");
  command->add_flag("--json", a->json, "Say what was made as JSON on standard output");
  add_common_options(*command, program);
  command->footer(
      "The truth is a CSV file with one line a point: index,face,u,v,x,y,z,nx,ny,nz,outlier.\n\n"
      "Examples:\n"
      "  tri sample --cad lid.igs -n 3400 --noise 0.02 -o lid.xyz\n"
      "  tri sample --cad part.step -n 100000 --pattern scan --outliers 0.01 --seed 7 -o scan.xyz\n"
      "  tri sample --cad part.step -n 50000 --drop-out 8 --drop-outs 2 -o gaps.xyz\n"
      "  tri sample --cad part.step -n 50000 --view 0,0,1 --move -o moved.xyz");
  command->callback([a, &program] {
    require_extension(a->output, points_extensions, "the points");
    MeasurementOptions& options = a->options;
    options.pattern = usage([&] { return sampling_pattern(a->pattern); });
    options.max_angle = a->max_angle * std::numbers::pi / 180;
    options.views = in_threes(a->flat_views);
    options.drop_out_centres = in_threes(a->flat_centres);
    const bool places = options.drop_outs > 0 || !options.drop_out_centres.empty();
    if (places && !(options.drop_out_radius > 0))
      throw UsageError("--drop-outs and --drop-out-at need a radius: --drop-out MM");
    if (!places && options.drop_out_radius > 0) options.drop_outs = 1;
    for (const Vec3& view : options.views)
      if (!(view.norm() > 0)) throw UsageError("--view 0,0,0 is no direction");
    if (a->no_truth && !a->truth.empty()) throw UsageError("--truth and --no-truth exclude each other");
    if (!a->no_truth && a->truth.empty()) a->truth = beside(a->output, ".truth.csv");
    if (options.move) a->pose = beside(a->output, ".pose.json");
    program.action = [a, &program] { return run(*a, program); };
  });
}

}  // namespace tri::cli

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "cli/alignment.hpp"
#include "cli/commands.hpp"
#include "cli/model_input.hpp"
#include "cli/number_checks.hpp"
#include "cli/points_input.hpp"
#include "io/json_file.hpp"
#include "io/pose_file.hpp"
#include "meshops/version.hpp"

namespace tri::cli {
namespace {

struct AlignArguments {
  ModelInput model;
  AlignInput align;
  std::string points, output, pose, report, metric = "plane";
  PointUnits units;
  PointsPreparation preparation;
  double keep = 1;
  bool json = false;
};

int run(const AlignArguments& a, Program& program) {
  Context& context = program.context;
  for (const std::string& path : {a.output, a.pose, a.report})
    if (!path.empty()) check_output(path);
  const CadModel model = read_model(a.model, program);
  PointsFileInfo file;
  PointSet set = read_points_in_mm(a.points, a.units, program, &file);
  const PreparedPoints prepared = prepare(set, a.preparation, context);
  const double factor = factor_of(a.units, file);
  AlignOptions options = align_options(a.align, factor);
  options.metric = a.metric == "point" ? Metric::point : Metric::plane;
  options.keep = a.keep;
  const Registration registration(model, context);
  const AlignResult result = align(model, registration, set.points, set.normals, options, context);
  context.checkpoint();

  nlohmann::ordered_json given{
      {"cad", a.model.path}, {"points", a.points}, {"sew", a.model.sew}, {"metric", a.metric}, {"keep", a.keep}};
  given.update(to_json(a.align));
  given.update(to_json(a.units, file));
  given.update(to_json(a.preparation));
  nlohmann::ordered_json report{{"version", version}, {"options", given}, {"points", set.size()}};
  add_to_report(report, prepared);
  report["alignment"] = to_json(result);
  if (!a.report.empty()) write_json(a.report, report);
  if (a.json) print_result(report);
  require_fit(result, factor);

  if (!result.pose.is_identity()) {
    for (Vec3& p : set.points) p = result.pose(p);
    for (Vec3& n : set.normals) n = result.pose.turn(n);
  }
  Context uncancelled;  // an interrupt between two files would leave half of the result
  if (!a.pose.empty()) write_pose(a.pose, result.pose);
  write_points(a.output, set, uncancelled);
  if (a.json) return exit_done;
  std::string text = summary(prepared) + alignment_text(result);
  text += fmt::format("{}: {} points in the model's frame\n", a.output, with_commas(set.size()));
  if (!a.pose.empty()) text += fmt::format("{}: the pose\n", a.pose);
  if (!a.report.empty()) text += fmt::format("{}: the report\n", a.report);
  print_result(text);
  return exit_done;
}

}  // namespace

void add_align_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("align", "Move measured points onto a CAD model, from any pose");
  const auto a = std::make_shared<AlignArguments>();
  add_model_options(*command, a->model);
  command
      ->add_option("points", a->points,
                   "Measured points in any pose: any file that `tri info` knows as points, or \"-\"")
      ->required();
  command
      ->add_option("-o,--output", a->output,
                   "The points in the model's frame, in their order: .xyz, .txt, .asc, .csv, .ply or .pcd, in mm")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--write-pose", a->pose, "Write the pose as JSON: a 4x4 matrix that takes the points to the model")
      ->type_name("FILE");
  command->add_option("--report", a->report, "Write the pose and how far it can be trusted, as JSON")
      ->type_name("FILE");
  add_align_options(*command, a->align);
  command
      ->add_option(
          "--metric", a->metric,
          "plane: distance along the surface's normal; point: distance to the closest point, solved by SVD, in many "
          "more steps")
      ->check(CLI::IsMember({"plane", "point"}))
      ->capture_default_str();
  command
      ->add_option("--keep", a->keep,
                   "Share of the points that count in each step, those nearest to the model, in (0, 1]")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  add_units_option(*command, a->units);
  add_preparation_options(*command, a->preparation);
  command->add_flag("--json", a->json, "The report on standard output");
  add_common_options(*command, program);
  command->footer(
      "The result is good, ambiguous (it fits, but other poses fit as well or a motion is not fixed: they are named) or\n"
      "failed (exit code 1, nothing written but the report). Points that already lie on the model stay as they are, bit\n"
      "for bit, unless refinement is better by more than chance.\n\n"
      "Examples:\n"
      "  tri align --cad part.step scan.xyz -o aligned.xyz --write-pose pose.json\n"
      "  tri align --cad part.step centres.xyz --probe-radius 2.5 -o aligned.xyz\n"
      "  tri align --cad part.step scan.xyz --pairs pairs.txt -o aligned.xyz\n"
      "  tri align --cad part.step more.xyz --pose pose.json --align none -o aligned.xyz");
  command->callback([a, &program] {
    require_extension(a->output, points_extensions, "the points");
    program.action = [a, &program] { return run(*a, program); };
  });
}

}  // namespace tri::cli

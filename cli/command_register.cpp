#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "cli/alignment.hpp"
#include "cli/commands.hpp"
#include "cli/model_input.hpp"
#include "cli/number_checks.hpp"
#include "cli/points_input.hpp"
#include "io/json_file.hpp"
#include "io/registration_file.hpp"
#include "libtri/registration.hpp"
#include "meshops/checks/value_statistics.hpp"
#include "meshops/version.hpp"

namespace tri::cli {
namespace {

using Json = nlohmann::ordered_json;

struct RegisterArguments {
  ModelInput model;
  std::string points, output, report;
  PointUnits units;
  AlignInput align{.mode = "none"};
  double far = 0;  // mm; 0 for a share of the diagonal
  bool json = false;
};

constexpr double far_share = 0.01;  // of the model's diagonal

// What is said about all the feet.
struct Summary {
  ValueStatistics deviation;
  double far_distance = 0;
  std::vector<std::uint64_t> far;
  std::uint64_t on_edge = 0;
  std::vector<std::uint64_t> per_face;  // beside CadModel::faces
};

Summary summarise(const std::vector<Foot>& feet, const CadModel& model, const RegisterArguments& a,
                  const Context& context) {
  Summary s;
  s.far_distance = a.far > 0 ? a.far : far_share * model.diagonal;
  s.per_face.assign(model.faces.size(), 0);
  std::vector<double> deviations;
  deviations.reserve(feet.size());
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const Foot& foot = feet[i];
    deviations.push_back(foot.deviation);
    if (std::abs(foot.deviation) > s.far_distance) s.far.push_back(i);
    if (foot.edge >= 0) ++s.on_edge;
    ++s.per_face[static_cast<std::size_t>(foot.face)];
  }
  s.deviation = value_statistics(deviations, {}, context);
  return s;
}

Json report_json(const Summary& s, const CadModel& model, const RegisterArguments& a, const PointsFileInfo& file,
                 const Json& seconds) {
  Json options{{"cad", a.model.path}, {"points", a.points}, {"sew", a.model.sew}, {"far", s.far_distance}};
  options.update(to_json(a.units, file));
  options.update(to_json(a.align));
  const ValueStatistics& d = s.deviation;
  Json json{{"version", version},
            {"options", options},
            {"output", a.output},
            {"points", d.count},
            {"on_edge", s.on_edge},
            {"deviation",
             {{"mean", d.mean},
              {"rms", d.rms},
              {"standard_deviation", d.standard_deviation},
              {"min", d.min},
              {"min_index", d.min_index},
              {"max", d.max},
              {"max_index", d.max_index},
              {"p5", d.p5},
              {"median", d.median},
              {"p95", d.p95}}},
            {"far", {{"distance", s.far_distance}, {"points", s.far.size()}, {"indices", s.far}}}};
  json["faces"] = Json::array();
  for (std::size_t f = 0; f < model.faces.size(); ++f)
    json["faces"].push_back({{"face", model.faces[f].index}, {"name", model.faces[f].name}, {"points", s.per_face[f]}});
  json["unusable_faces"] = Json::array();
  for (const UnusableFace& f : model.unusable_faces)
    json["unusable_faces"].push_back({{"face", f.index}, {"name", f.name}, {"reason", f.reason}});
  json["seconds"] = seconds;
  return json;
}

std::string report_text(const Summary& s, const CadModel& model, const RegisterArguments& a) {
  const ValueStatistics& d = s.deviation;
  const auto met = s.per_face.size() - static_cast<std::size_t>(std::count(s.per_face.begin(), s.per_face.end(), 0u));
  std::string text = fmt::format("{} points on {} of {} faces, {} of them on edges\n", with_commas(d.count), met,
                                 model.faces.size(), with_commas(s.on_edge));
  text += fmt::format(
      "deviation: mean {:.4g} mm, standard deviation {:.4g} mm, from {:.4g} mm (point {}) to {:.4g} mm "
      "(point {})\n",
      d.mean, d.standard_deviation, d.min, d.min_index, d.max, d.max_index);
  for (const UnusableFace& f : model.unusable_faces)
    text += fmt::format("face {} of the model is unusable: {}\n", f.index, f.reason);
  text += fmt::format("{}: where each point lies\n", a.output);
  if (!a.report.empty()) text += fmt::format("{}: the report\n", a.report);
  return text;
}

void warn_of_far_points(const Summary& s) {
  if (s.far.empty()) return;
  const ValueStatistics& d = s.deviation;
  const bool below = -d.min > d.max;
  std::string text = fmt::format("{} of {} points are farther than {:.4g} mm from the model, point {} by {:.4g} mm",
                                 with_commas(s.far.size()), with_commas(d.count), s.far_distance,
                                 below ? d.min_index : d.max_index, below ? -d.min : d.max);
  if (2 * s.far.size() > d.count) text += "; are the points in the model's frame, and in the right --units?";
  print_note(text);
}

int run(const RegisterArguments& a, Program& program) {
  Context& context = program.context;
  for (const std::string& path : {a.output, a.report})
    if (!path.empty()) check_output(path);
  Json seconds = Json::object();
  auto last = std::chrono::steady_clock::now();
  const auto time = [&](const char* step) {
    const auto now = std::chrono::steady_clock::now();
    seconds[step] = std::chrono::duration<double>(now - last).count();
    last = now;
  };
  PointsInBackground background(a.points, a.units, program);
  const CadModel model = read_model(a.model, program);
  PointsFileInfo file;
  PointSet set = background.get(&file);
  time("read");
  const Registration registration(model, context);
  time("index_model");
  const std::optional<AlignResult> alignment =
      align_points(a.align, model, registration, set.points, set.normals, factor_of(a.units, file), context);
  time("align");
  const std::vector<Foot> feet = registration.register_points(set.points, context);
  time("register");
  const Summary summary = summarise(feet, model, a, context);
  context.checkpoint();
  write_registration(a.output, set, feet, model, context);
  time("write");
  Json report = report_json(summary, model, a, file, seconds);
  if (alignment) report["alignment"] = to_json(*alignment);
  if (!a.report.empty()) write_json(a.report, report);
  if (!program.quiet) warn_of_far_points(summary);
  if (a.json)
    print_result(report);
  else
    print_result((alignment ? alignment_text(*alignment) : "") + report_text(summary, model, a));
  return exit_done;
}

}  // namespace

void add_register_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("register", "Find for every point the closest point on a CAD model: face, u, v, deviation");
  const auto a = std::make_shared<RegisterArguments>();
  add_model_options(*command, a->model);
  command
      ->add_option(
          "points", a->points,
          "Points: any file that `tri info` knows as points, or \"-\"; taken as they are unless --align or --pose says more")
      ->required();
  command->add_option("-o,--output", a->output, "Where each point lies: .csv, or .ply with the same as properties")
      ->required()
      ->type_name("FILE");
  command->add_option("--report", a->report, "Write the summary as JSON")->type_name("FILE");
  command
      ->add_option("--far", a->far,
                   "Points farther than this from the model, in mm, are counted and listed in the report; default: a "
                   "hundredth of the model's diagonal")
      ->check(above_zero());
  add_units_option(*command, a->units);
  add_align_options(*command, a->align);
  command->add_flag("--json", a->json, "The summary as JSON on standard output");
  add_common_options(*command, program);
  command->footer(
      "The CSV file has the header index,x,y,z,face,u,v,fx,fy,fz,deviation,on_edge and one line a point, in the order\n"
      "of the points: (x,y,z) the point in mm, aligned if asked for, face the number of the closest face, (u,v) on that face's own surface,\n"
      "(fx,fy,fz) the closest point on the trimmed model, deviation positive outside, on_edge 1 where that closest\n"
      "point lies on a trimming curve. In PLY index and face are called point_index and cad_face. Points on an edge\n"
      "belong to the adjacent face of the lowest number. Normals, intensity, colours and further columns of the points\n"
      "follow.\n\n"
      "Examples:\n"
      "  tri register --cad part.step scan.xyz -o registered.csv\n"
      "  tri register --cad lid.igs lid.xyz -o lid.ply --report lid.json\n"
      "  tri register --cad part.step scan.xyz --align auto -o registered.csv");
  command->callback([a, &program] {
    require_extension(a->output, {"csv", "ply"}, "the output");
    if (!std::isfinite(a->far)) throw UsageError("--far is not a finite number");
    program.action = [a, &program] { return run(*a, program); };
  });
}

}  // namespace tri::cli

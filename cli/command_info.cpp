#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/commands.hpp"
#include "cli/info.hpp"

namespace tri::cli {

void add_box(Info& info, const Vec3& low, const Vec3& high) {
  for (int k = 0; k < 3; ++k)
    info.line(fmt::format("{}", "xyz"[k]),
              fmt::format("{:.8g} to {:.8g}, length {:.8g}", low[k], high[k], high[k] - low[k]));
  info.json["box_min"] = {low[0], low[1], low[2]};
  info.json["box_max"] = {high[0], high[1], high[2]};
  info.json["diagonal"] = (high - low).norm();
}

namespace {

struct InfoArguments {
  std::string input, kind = "auto";
  PointUnits units;
  double sew = 0.01;
  bool json = false;
};

Info surface_info(const InfoArguments& a, Program& program) {
  if (a.kind == "points") return points_info(a.input, a.units, program);
  Info info = mesh_info(a.input, program.context);
  // A PLY without faces holds points, unless the user says otherwise.
  if (a.kind == "auto" && info.json["triangles"] == 0 && info.json["format"] == "PLY")
    return points_info(a.input, a.units, program);
  if (a.units.given != "auto") throw UsageError("--units is for points; a mesh has no unit");
  return info;
}

int run(const InfoArguments& a, Program& program) {
#ifdef TRI_WITH_CAD
  const Info info = a.kind == "cad" ? cad_info(a.input, a.sew, program.context) : surface_info(a, program);
#else
  const Info info = surface_info(a, program);
#endif
  if (a.json) {
    print_result(info.json);
    return exit_done;
  }
  std::size_t width = 0;
  for (const auto& [label, text] : info.lines) width = std::max(width, label.size());
  std::string text;
  for (const auto& [label, value] : info.lines) text += fmt::format("{:<{}}  {}\n", label, width, value);
  constexpr std::size_t shown = 20;
  for (std::size_t i = 0; i < std::min(shown, info.notes.size()); ++i) text += fmt::format("note: {}\n", info.notes[i]);
  if (info.notes.size() > shown) text += fmt::format("note: {} more; --json has them all\n", info.notes.size() - shown);
  print_result(text);
  return exit_done;
}

}  // namespace

void add_info_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("info", "Say what matters about a mesh, points or a CAD file");
  const auto a = std::make_shared<InfoArguments>();
  command
      ->add_option(
          "file", a->input,
          "Mesh (PLY, STL, OBJ, OFF, 3MF, glTF), points (XYZ, ASC, CSV, TXT, PTS, PLY, PCD, PTX, E57) or CAD (IGES, STEP, BREP)")
      ->required();
  command
      ->add_option("--as", a->kind, "What the file holds; auto goes by its name, and a PLY without faces holds points")
      ->check(CLI::IsMember({"auto", "mesh", "points", "cad"}))
      ->capture_default_str();
  add_units_option(*command, a->units);
#ifdef TRI_WITH_CAD
  command->add_option("--sew", a->sew, "Distance in mm at which loose CAD faces are joined")
      ->check(CLI::Range(1e-9, 1e9))
      ->capture_default_str();
#endif
  command->add_flag("--json", a->json,
                    "Everything as JSON on standard output; of a CAD model also the list of its faces");
  add_common_options(*command, program);
  command->footer(
      "Mesh: size, topology, defects. Points: number, spacing. CAD: unit, faces by surface, unusable faces, "
      "topology.\n\n"
      "Examples:\n"
      "  tri info part.stl\n"
      "  tri info lid.igs\n"
      "  tri info scan.xyz --json");
  command->callback([a, &program] {
    if (a->kind == "auto") {
      const std::string kind = kind_of(a->input);
      if (kind.empty())
        throw UsageError(
            fmt::format("\"{}\": the name does not say what it holds; add --as mesh, points or cad", a->input));
      if (kind != "mesh") a->kind = kind;
    }
    if (a->kind == "cad" && a->units.given != "auto")
      throw UsageError("--units is for points; CAD files say their unit");
#ifndef TRI_WITH_CAD
    if (a->kind == "cad") throw UsageError("this program was built without CAD files");
#endif
    program.action = [a, &program] { return run(*a, program); };
  });
}

}  // namespace tri::cli

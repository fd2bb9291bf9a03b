#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "cli/report_text.hpp"
#include "io/copy_file.hpp"
#include "io/input_file.hpp"
#include "io/json_file.hpp"
#include "io/mesh_file.hpp"
#include "meshops/repair.hpp"

namespace tri::cli {
namespace {

struct RepairArguments {
  std::string input, output, report, goal = "auto";
  double max_deviation = RepairOptions{}.max_deviation;
  bool json = false, dry_run = false, ascii = false;
};

RepairGoal goal_of(const std::string& name) {
  if (name == "solid") return RepairGoal::solid;
  return name == "surface" ? RepairGoal::surface : RepairGoal::automatic;
}

std::string point_text(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]);
}

/// The first few; JSON has more.
std::string places_text(const std::vector<RepairPlace>& places) {
  constexpr std::size_t shown = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(shown, places.size()); ++i)
    text += fmt::format("{}{} {} {}", i == 0 ? "  at " : ", ", places[i].is_triangle ? "triangle" : "vertex",
                        places[i].index, point_text(places[i].at));
  return text.empty() ? text : text + (places.size() > shown ? " …\n" : "\n");
}

bool holds_floats(const std::string& output) {
  const std::string extension = file_extension(output);
  return extension == "stl" || extension == "glb" || extension == "gltf";
}

/// Whether the output has the format and encoding of the input, so that its bytes can stay as they are.
bool would_be_written_alike(const MeshFileInfo& file, const RepairArguments& a) {
  if (a.input == "-") return false;
  const std::string extension = file_extension(a.output);
  const bool text = file.encoding == MeshEncoding::ascii;
  switch (file.format) {
    case MeshFormat::stl:
      return extension == "stl" && text == a.ascii;
    case MeshFormat::ply:
      return extension == "ply" && text == a.ascii;
    case MeshFormat::obj:
      return extension == "obj";
    case MeshFormat::off:
      return extension == "off" && text;
    default:
      return false;
  }
}

int run(const RepairArguments& a, Program& program) {
  Context& context = program.context;
  if (!a.output.empty() && !a.dry_run) check_output(a.output);
  if (!a.report.empty()) check_output(a.report);
  MeshFileInfo file;
  Soup soup = read_mesh(a.input, context, &file);
  const std::size_t vertices = soup.points.size(), triangles = soup.triangles.size();
  const RepairResult result = repair(soup, {goal_of(a.goal), a.max_deviation, holds_floats(a.output)}, context);
  nlohmann::ordered_json json{{"input", a.input},
                              {"goal", result.goal == RepairGoal::solid ? "solid" : "surface"},
                              {"changed", result.changed},
                              {"left", result.left},
                              {"before", {{"vertices", vertices}, {"triangles", triangles}}},
                              {"after", {{"vertices", soup.points.size()}, {"triangles", soup.triangles.size()}}},
                              {"steps", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < result.steps.size(); ++i) {
    json["steps"].push_back(to_json(result.steps[i]));
    for (const RepairPlace& p : result.places[i])
      json["steps"].back()["places"].push_back(
          {{p.is_triangle ? "triangle" : "vertex", p.index}, {"at", {p.at[0], p.at[1], p.at[2]}}});
  }
  if (result.deviation) {
    const RepairDeviation& d = *result.deviation;
    json["deviation"] = {{"lost", d.lost},
                         {"lost_at", {d.lost_at[0], d.lost_at[1], d.lost_at[2]}},
                         {"added", d.added},
                         {"added_at", {d.added_at[0], d.added_at[1], d.added_at[2]}}};
  }
  std::string text = fmt::format("goal: a {}\n", result.goal == RepairGoal::solid ? "solid" : "surface");
  for (std::size_t i = 0; i < result.steps.size(); ++i)
    text += to_text(result.steps[i]) + places_text(result.places[i]);
  if (result.deviation)
    text += fmt::format(
        "farthest from the result: {:.3g} of what was there, at {}; farthest from what was there: {:.3g}, at {}\n",
        result.deviation->lost, point_text(result.deviation->lost_at), result.deviation->added,
        point_text(result.deviation->added_at));
  if (!result.changed) text += "nothing had to be repaired\n";
  if (!a.dry_run) {
    json["output"] = a.output;
    if (!result.changed && would_be_written_alike(file, a)) {
      copy_file(a.input, a.output);
    } else {
      json["notes"] = write_mesh(a.output, soup, {.ascii = a.ascii}, context).notes;
    }
    text += fmt::format("{}: {} vertices, {} triangles\n", a.output, with_commas(soup.points.size()),
                        with_commas(soup.triangles.size()));
  }
  if (!a.report.empty()) write_json(a.report, json);
  if (a.json)
    print_result(json);
  else
    print_result(text);
  if (result.left > 0) print_note(fmt::format("{} defects could not be repaired", with_commas(result.left)));
  return result.left > 0 ? exit_failed : exit_done;
}

}  // namespace

void add_repair_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("repair", "Make a clean mesh of any triangles, and say what was done");
  const auto a = std::make_shared<RepairArguments>();
  command->add_option("in", a->input, "Mesh to read: PLY, STL, OBJ, OFF, 3MF or glTF")->required();
  command->add_option("-o,--output", a->output,
                      "Mesh to write; its ending (.ply, .stl, .obj, .off, .3mf, .glb, .gltf, .vtp) gives the format");
  command
      ->add_option("--goal", a->goal,
                   "solid: closed, no crossings; surface: open where it was open; auto: by the boundary")
      ->check(CLI::IsMember({"auto", "solid", "surface"}))
      ->capture_default_str();
  command
      ->add_option(
          "--max-deviation", a->max_deviation,
          "How far the surface may move, as a share of its diagonal: no place of it ends farther from the result, nor a place of the result farther from it, but for what closes holes. A step that would go beyond is undone and named, with exit code 1")
      ->check(CLI::Range(0.0, 0.1))
      ->capture_default_str();
  command->add_option("--report", a->report, "Write every step to this file as JSON");
  command->add_flag("--json", a->json, "The report as JSON on standard output");
  command->add_flag("--dry-run", a->dry_run, "Say what would be done and write no mesh");
  command->add_flag("--ascii", a->ascii, "Text instead of binary, for PLY and STL");
  add_common_options(*command, program);
  command->footer(
      "Exit code 1 if something is left that could not be repaired; the mesh is written all the same. No component is\n"
      "removed, a mesh without defects is written as it was read.\n\n"
      "Examples:\n"
      "  tri repair broken.stl -o clean.ply\n"
      "  tri repair scan.ply -o solid.off --goal solid --report repair.json\n"
      "  tri repair part.stl --dry-run");
  command->callback([a, &program] {
    if (!a->dry_run) {
      if (a->output.empty()) throw UsageError("say where to write: tri repair IN -o OUT, or --dry-run");
      require_extension(a->output, mesh_extensions, "the mesh to write");
    }
    program.action = [a, &program] { return run(*a, program); };
  });
}

}  // namespace tri::cli

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "cli/plugins_input.hpp"
#include "cli/points_input.hpp"
#include "cli/report_text.hpp"
#include "io/input_file.hpp"
#include "io/json_file.hpp"
#include "io/mesh_file.hpp"
#include "meshops/pipeline.hpp"
#include "meshops/points/point_soup.hpp"
#include "meshops/to_soup.hpp"

namespace tri::cli {
namespace {

struct RunArguments {
  std::string input, output, recipe, save;
  std::vector<std::string> plugins;
  PointUnits units;
  bool ascii = false, json = false;
};

/// The steps, and the operators they name, which must live as long.
struct Steps {
  Registry registry;
  Pipeline pipeline;
};

Pipeline pipeline_of(const RunArguments& a, const Registry& registry, const Program& program) {
  if (a.recipe.empty()) return usage([&] { return Pipeline::from_tokens(program.steps, registry); });
  if (!program.steps.empty()) throw UsageError("--recipe and steps on the command line exclude each other");
  const InputFile file(a.recipe);
  try {
    return Pipeline::from_json(file.bytes(), registry);
  } catch (const InvalidInput& e) {
    throw UsageError(fmt::format("{}: {}", a.recipe, e.what()));
  }
}

// What the input is read as. A PLY may hold either: the first step tells, or, without steps, the output's format.
Domain input_domain(const RunArguments& a, const Pipeline& pipeline) {
  if (kind_of(a.input) == "points") return Domain::points;
  if (!pipeline.empty()) return pipeline.steps().front().op->domain() == Domain::points ? Domain::points : Domain::soup;
  return kind_of(a.output) == "points" ? Domain::points : Domain::soup;
}

Geometry read_input(const RunArguments& a, const Pipeline& pipeline, nlohmann::ordered_json& json, Program& program) {
  if (input_domain(a, pipeline) != Domain::points) return read_mesh(a.input, program.context);
  PointsFileInfo file;
  PointSet points = read_points_in_mm(a.input, a.units, program, &file);
  json.update(to_json(a.units, file));
  return points;
}

// Writes what came out; counts into `json` and, as a sentence, into the result.
std::string write_output(const RunArguments& a, Geometry& geometry, nlohmann::ordered_json& json, Program& program) {
  MeshWriteReport written;
  std::string text;
  if (auto* mesh = std::get_if<Mesh>(&geometry)) geometry = to_soup(view_of(*mesh));
  if (auto* points = std::get_if<PointSet>(&geometry)) {
    json["points"] = points->size();
    text = fmt::format("{}: {} points\n", a.output, with_commas(points->size()));
    if (a.ascii && file_extension(a.output) == "ply")
      written = write_mesh(a.output, to_soup(std::move(*points)), {.ascii = true}, program.context);
    else
      write_points(a.output, *points, program.context);
  } else {
    const Soup& soup = std::get<Soup>(geometry);
    json["vertices"] = soup.points.size();
    json["triangles"] = soup.triangles.size();
    text = fmt::format("{}: {} vertices, {} triangles\n", a.output, with_commas(soup.points.size()),
                       with_commas(soup.triangles.size()));
    written = write_mesh(a.output, soup, {.ascii = a.ascii}, program.context);
  }
  json["notes"] = written.notes;
  return text;
}

int run(const RunArguments& a, const Pipeline& pipeline, Program& program) {
  check_output(a.output);
  if (!a.save.empty()) check_output(a.save);
  nlohmann::ordered_json json{{"input", a.input}, {"output", a.output}};
  Geometry geometry = read_input(a, pipeline, json, program);
  const std::vector<Report> reports = pipeline.run(geometry, program.context);
  std::string text;
  for (const Report& report : reports) text += to_text(report);
  text += write_output(a, geometry, json, program);
  if (a.json) {
    json["steps"] = nlohmann::ordered_json::array();
    for (const Report& report : reports) json["steps"].push_back(to_json(report));
    print_result(json);
  } else {
    print_result(text);
  }
  return exit_done;
}

void check_formats(const RunArguments& a, const Pipeline& pipeline) {
  const Domain input = input_domain(a, pipeline);
  Domain result = input;
  usage([&] { return pipeline.plan(input, &result); });
  if (result != Domain::points) {
    if (a.units.given != "auto") throw UsageError("--units is for points; a mesh has no unit");
    require_extension(a.output, mesh_extensions, "the mesh to write");
    return;
  }
  const std::string extension = file_extension(a.output);
  if (kind_of(a.output) == "mesh" && extension != "ply")
    throw UsageError(
        fmt::format("\"{}\" is a mesh, and these are points: connecting them needs a model (tri triangulate "
                    "--cad)",
                    a.output));
  require_extension(a.output, points_extensions, "the points to write");
}

// A dry run: what would be done, without opening a mesh.
int save_only(const RunArguments& a, const Pipeline& pipeline) {
  write_json(a.save, pipeline.to_json());
  print_result(fmt::format("{}: {} steps\n", a.save, pipeline.steps().size()));
  return exit_done;
}

}  // namespace

void add_run_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("run", "Run operators on a mesh or on points, one after another");
  const auto a = std::make_shared<RunArguments>();
  auto* input = command->add_option(
      "in", a->input,
      "Mesh (PLY, STL, OBJ, OFF, 3MF, glTF) or points (XYZ, ASC, CSV, TXT, PTS, PLY, PCD, PTX, E57) to read");
  command
      ->add_option(
          "out", a->output,
          "File to write; its ending gives the format: mesh .ply, .stl, .obj, .off, .3mf, .glb, .gltf, .vtp; points .xyz, .txt, .asc, .csv, .ply, .pcd")
      ->needs(input);
  command->add_option("--recipe", a->recipe, "Take the steps from this file, as --save writes it");
  command->add_option("--save", a->save, "Write the steps to this file; without IN and OUT nothing else is done");
  command->add_flag("--ascii", a->ascii, "Text instead of binary, for PLY and STL");
  add_units_option(*command, a->units);
  add_plugins_option(*command, a->plugins);
  command->add_flag("--json", a->json, "The report of every step as JSON on standard output");
  add_common_options(*command, program);
  command->footer(
      "  tri run [OPTIONS] IN ! OPERATOR [--option value] ! ... ! OUT\n"
      "  tri run [OPTIONS] --recipe FILE IN OUT\n\n"
      "`tri ops` lists the operators, `tri ops NAME` explains the options of one. Steps are checked before any mesh is\n"
      "opened. A conversion that is needed and left out (build-mesh) is inserted, and shows in the report. Without steps,\n"
      "the file is read and written: a change of format. Points stay points: connecting them needs a model.\n\n"
      "Examples:\n"
      "  tri run part.stl ! fill-holes --max-edges 50 ! part.ply\n"
      "  tri run part.stl ! fill-holes ! flip-diagonals ! part.ply --save repair.json\n"
      "  tri run --recipe repair.json other.stl other.ply\n"
      "  tri run scan.e57 ! remove-outliers ! thin --voxel 0.5 ! scan.ply\n"
      "  tri run part.stl part.obj");
  command->callback([a, &program] {
    const auto steps = std::make_shared<Steps>(Steps{registry_with_plugins(a->plugins), Pipeline()});
    steps->pipeline = pipeline_of(*a, steps->registry, program);
    if (a->output.empty()) {
      if (a->save.empty() || !a->input.empty())
        throw UsageError("say what to read and where to write: tri run IN ! OPERATOR ! OUT (tri run --help)");
      program.action = [a, steps] { return save_only(*a, steps->pipeline); };
      return;
    }
    check_formats(*a, steps->pipeline);
    program.action = [a, steps, &program] {
      const int code = run(*a, steps->pipeline, program);
      if (!a->save.empty()) write_json(a->save, steps->pipeline.to_json());
      return code;
    };
  });
}

}  // namespace tri::cli

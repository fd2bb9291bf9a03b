#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands.hpp"
#include "io/input_file.hpp"
#include "io/json_file.hpp"
#include "io/mesh_file.hpp"
#include "meshops/pipeline.hpp"
#include "meshops/to_soup.hpp"

namespace tri::cli {
namespace {

struct Arguments {
  std::string input, output, recipe, save;
  bool ascii = false, json = false;
};

std::string to_text(const Report& r) {
  std::string changes;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) changes += fmt::format("{}{} {}", changes.empty() ? "" : ", ", with_commas(count), what);
  };
  add(r.vertices_added, "vertices added");
  add(r.vertices_removed, "vertices removed");
  add(r.vertices_moved, "vertices moved");
  add(r.faces_added, "faces added");
  add(r.faces_removed, "faces removed");
  add(r.faces_reversed, "faces reversed");
  add(r.edges_flipped, "edges flipped");
  std::string text = fmt::format("{:<20} {} ({:.3f} s)\n", r.operation, changes.empty() ? "nothing changed" : changes, r.seconds);
  for (const auto& [name, value] : r.figures) text += fmt::format("  {}: {:.6g}\n", name, value);
  for (const auto& [reason, count] : r.skipped) text += fmt::format("  left alone, {}: {}\n", reason, with_commas(count));
  for (const std::string& note : r.notes) text += fmt::format("  {}\n", note);
  return text;
}

Pipeline pipeline_of(const Arguments& a, const Program& program) {
  if (a.recipe.empty()) return usage([&] { return Pipeline::from_tokens(program.steps); });
  if (!program.steps.empty()) throw UsageError("--recipe and steps on the command line exclude each other");
  const InputFile file(a.recipe);
  try {
    return Pipeline::from_json(file.bytes());
  } catch (const InvalidInput& e) {
    throw UsageError(fmt::format("{}: {}", a.recipe, e.what()));
  }
}

int run(const Arguments& a, const Pipeline& pipeline, Program& program) {
  Context& context = program.context;
  check_output(a.output);
  if (!a.save.empty()) check_output(a.save);
  Geometry geometry = read_mesh(a.input, context);
  const std::vector<Report> reports = pipeline.run(geometry, context);
  if (auto* mesh = std::get_if<Mesh>(&geometry)) geometry = to_soup(view_of(*mesh));
  const Soup& soup = std::get<Soup>(geometry);
  const MeshWriteReport written = write_mesh(a.output, soup, {.ascii = a.ascii}, context);
  for (const std::string& note : written.notes)
    if (!program.quiet) print_note(a.output + ": " + note);
  if (a.json) {
    nlohmann::ordered_json json{{"input", a.input},
                                {"output", a.output},
                                {"vertices", soup.points.size()},
                                {"triangles", soup.triangles.size()},
                                {"steps", nlohmann::ordered_json::array()},
                                {"notes", written.notes}};
    for (const Report& report : reports) json["steps"].push_back(to_json(report));
    print_result(json);
  } else {
    std::string text;
    for (const Report& report : reports) text += to_text(report);
    print_result(text + fmt::format("{}: {} vertices, {} triangles\n", a.output, with_commas(soup.points.size()),
                                    with_commas(soup.triangles.size())));
  }
  return exit_done;
}

// A dry run: what would be done, without opening a mesh.
int save_only(const Arguments& a, const Pipeline& pipeline) {
  write_json(a.save, pipeline.to_json());
  print_result(fmt::format("{}: {} steps\n", a.save, pipeline.steps().size()));
  return exit_done;
}

}  // namespace

void add_run_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("run", "Run operators on a mesh, one after another");
  const auto a = std::make_shared<Arguments>();
  auto* input = command->add_option("in", a->input, "Mesh to read: PLY, STL, OBJ or OFF");
  command->add_option("out", a->output, "Mesh to write; its ending (.ply, .stl, .obj, .off) gives the format")->needs(input);
  command->add_option("--recipe", a->recipe, "Take the steps from this file, as --save writes it");
  command->add_option("--save", a->save, "Write the steps to this file; without IN and OUT nothing else is done");
  command->add_flag("--ascii", a->ascii, "Text instead of binary, for PLY and STL");
  command->add_flag("--json", a->json, "The report of every step as JSON on standard output");
  add_common_options(*command, program);
  command->footer(
      "  tri run [OPTIONS] IN ! OPERATOR [--option value] ! ... ! OUT\n"
      "  tri run [OPTIONS] --recipe FILE IN OUT\n\n"
      "`tri ops` lists the operators, `tri ops NAME` explains the options of one. Steps are checked before any mesh is\n"
      "opened. A conversion that is needed and left out (build-mesh) is inserted, and shows in the report. Without steps,\n"
      "the mesh is read and written: a change of format.\n\n"
      "Examples:\n"
      "  tri run part.stl ! fill-holes --max-edges 50 ! part.ply\n"
      "  tri run part.stl ! fill-holes ! flip-diagonals ! part.ply --save repair.json\n"
      "  tri run --recipe repair.json other.stl other.ply\n"
      "  tri run part.stl part.obj");
  command->callback([a, &program] {
    const auto pipeline = std::make_shared<const Pipeline>(pipeline_of(*a, program));
    if (a->output.empty()) {
      if (a->save.empty() || !a->input.empty())
        throw UsageError("say what to read and where to write: tri run IN ! OPERATOR ! OUT (tri run --help)");
      program.action = [a, pipeline] { return save_only(*a, *pipeline); };
      return;
    }
    require_extension(a->output, mesh_extensions, "the mesh to write");
    usage([&] { return pipeline->plan(Domain::soup); });
    program.action = [a, pipeline, &program] {
      const int code = run(*a, *pipeline, program);
      if (!a->save.empty()) write_json(a->save, pipeline->to_json());
      return code;
    };
  });
}

}  // namespace tri::cli

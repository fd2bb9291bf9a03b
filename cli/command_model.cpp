#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "io/cad/cad_file.hpp"
#include "libtri/example_parts.hpp"

namespace tri::cli {
namespace {

struct ModelArguments {
  std::string name, output;
  bool json = false;
};

int list(bool json) {
  if (json) {
    auto parts = nlohmann::ordered_json::array();
    for (const ExamplePart& part : example_parts())
      parts.push_back({{"name", part.name},
                       {"description", part.description},
                       {"faces", part.faces},
                       {"components", part.components},
                       {"loops", part.loops},
                       {"euler", part.euler}});
    print_result(parts);
    return exit_done;
  }
  std::string text = fmt::format("{:<13} {:>5} {:>5} {:>5}\n", "", "faces", "loops", "Euler");
  for (const ExamplePart& part : example_parts())
    text +=
        fmt::format("{:<13} {:>5} {:>5} {:>5}  {}\n", part.name, part.faces, part.loops, part.euler, part.description);
  print_result(text);
  return exit_done;
}

int write(const ModelArguments& a, Program& program) {
  check_output(a.output);
  const Shape shape = example_part(a.name);
  program.context.checkpoint();
  write_cad(a.output, shape);
  for (const ExamplePart& part : example_parts()) {
    if (part.name != a.name) continue;
    if (a.json)
      print_result(nlohmann::ordered_json{{"file", a.output},
                                          {"name", part.name},
                                          {"faces", part.faces},
                                          {"components", part.components},
                                          {"loops", part.loops},
                                          {"euler", part.euler}});
    else
      print_result(fmt::format("{}: {} faces, {}\n", a.output, part.faces, part.description));
  }
  return exit_done;
}

}  // namespace

void add_model_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("model", "Write an example part as a CAD file; without a name, list them");
  const auto a = std::make_shared<ModelArguments>();
  auto* name = command->add_option("name", a->name, "Part to build");
  auto* output = command->add_option("-o,--output", a->output, "File to write: .igs, .step or .brep, in millimetres");
  output->needs(name);
  command->add_flag("--json", a->json, "Say what was written, or the list, as JSON");
  command->footer(
      "Loops are those of the free edges, 0 for a closed solid; Euler is the Euler characteristic of the surface.\n\n"
      "Examples:\n"
      "  tri model\n"
      "  tri model boot-lid -o lid.igs\n"
      "  tri model bracket -o bracket.step");
  command->callback([a, &program] {
    if (a->name.empty()) {
      program.action = [a] { return list(a->json); };
      return;
    }
    if (a->output.empty())
      throw UsageError(fmt::format("say where to write: tri model {} -o {}.step", a->name, a->name));
    require_extension(a->output, {"igs", "iges", "stp", "step", "brep"}, "the CAD file");
    std::string names;
    bool known = false;
    for (const ExamplePart& part : example_parts()) {
      known = known || part.name == a->name;
      names += (names.empty() ? "" : ", ") + part.name;
    }
    if (!known) throw UsageError(fmt::format("no example part is named \"{}\"; there are {}", a->name, names));
    program.action = [a, &program] { return write(*a, program); };
  });
}

}  // namespace tri::cli

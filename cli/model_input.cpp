#include "cli/model_input.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/interrupt.hpp"

namespace tri::cli {

void add_model_options(CLI::App& command, ModelInput& input, bool required) {
  command.add_option("--cad", input.path, "CAD model: IGES, STEP or BREP")->required(required)->type_name("FILE");
  command.add_option("--sew", input.sew, "Distance in mm at which loose CAD faces are joined")
      ->check(CLI::Range(1e-9, 1e9))
      ->capture_default_str();
}

CadFile read_cad_or_end(const std::string& path, Context& context) {
  const EndOnInterrupt watch(context);
  return read_cad(path, context);
}

CadModel read_model(const ModelInput& input, Program& program) {
  const CadFile file = read_cad_or_end(input.path, program.context);
  CadModel model = make_cad_model(file.shape, input.sew, program.context);
  const auto note = [&](const std::string& text) {
    if (!program.quiet) print_note(input.path + ": " + text);
  };
  for (const FailedEntity& entity : file.failed) note(fmt::format("{} was not read: {}", entity.entity, entity.reason));
  for (const std::string& warning : model.warnings) note(warning);
  return model;
}

}  // namespace tri::cli

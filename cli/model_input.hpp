#pragma once

#include <string>

#include "cli/program.hpp"
#include "io/cad/cad_file.hpp"
#include "libtri/model/cad_model.hpp"

namespace tri::cli {

/// The `--cad` and `--sew` of every command that works on a CAD model.
struct ModelInput {
  std::string path;
  double sew = 0.01;  ///< mm
};

/// Adds --cad and --sew to a command.
void add_model_options(CLI::App& command, ModelInput& input, bool required = true);

/// `read_cad`, which cannot be interrupted while a file is parsed; the program can.
CadFile read_cad_or_end(const std::string& path, Context& context);

/// The model of the file; what the reader could not use or had to repair is said on standard error at once.
/// @throws as `read_cad` and `make_cad_model`
CadModel read_model(const ModelInput& input, Program& program);

}  // namespace tri::cli

#pragma once

#include <string>
#include <vector>

#include "cli/program.hpp"
#include "meshops/registry.hpp"

namespace tri::cli {

/// Adds --plugins to a command that names operators.
void add_plugins_option(CLI::App& command, std::vector<std::string>& folders);

/// The standard operators and those of the plug-ins in these folders, and in the folders that the environment variable
/// TRI_PLUGINS names. @throws IoError, InvalidInput as `load_plugins`
Registry registry_with_plugins(const std::vector<std::string>& folders);

}  // namespace tri::cli

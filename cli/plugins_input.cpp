#include "cli/plugins_input.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "io/plugins.hpp"

namespace tri::cli {

void add_plugins_option(CLI::App& command, std::vector<std::string>& folders) {
  command
      .add_option("--plugins", folders,
                  "Folder of plug-ins (*.so) whose operators are to be there; may be given more than once. The "
                  "environment variable TRI_PLUGINS names further ones, separated by colons")
      ->type_name("DIR")
      ->allow_extra_args(false);
}

Registry registry_with_plugins(const std::vector<std::string>& folders) {
  Registry registry = Registry::standard();
  load_plugins(registry, folders);
  if (const char* list = std::getenv("TRI_PLUGINS")) load_plugins(registry, plugin_folders(list));
  return registry;
}

}  // namespace tri::cli

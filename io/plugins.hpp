#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "meshops/registry.hpp"

namespace tri {

/// A plug-in that was loaded.
struct Plugin {
  std::string path;                    ///< of the shared object
  std::string name;                    ///< as it says of itself
  std::string version;                 ///< its own, as it says
  std::vector<std::string> operators;  ///< names of those it registered, in its order
};

/// Loads a shared object that was made with meshops/plugin.hpp, and registers its operators.
///
/// What it was built with (the versions of tri and OpenMesh, the compiler, the standard library) is read from the file
/// and compared with this library before any code of the plug-in runs. Its code stays in memory as long as `registry`
/// or a copy of it lives; pipelines, options and reports made with its operators must be gone by then, as those of any
/// registry.
///
/// @throws IoError naming the file: it is missing, no plug-in of tri, built with something else (the message names
/// both), or
///   the system cannot load it. InvalidInput naming it: an operator's name is taken, or what the plug-in itself throws.
///   `registry` is then as it was.
Plugin load_plugin(Registry& registry, const std::string& path);

/// Loads every plug-in of these folders: the files whose name ends in .so, sorted by name, folder after folder.
/// @throws as `load_plugin`; IoError if a folder cannot be read. `registry` is then as it was.
std::vector<Plugin> load_plugins(Registry& registry, std::span<const std::string> folders);

/// The folders of a list that is separated by colons, as in the environment variable TRI_PLUGINS; empty ones are left
/// out.
std::vector<std::string> plugin_folders(std::string_view list);

}  // namespace tri

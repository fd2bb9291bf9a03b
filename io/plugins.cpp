#include "io/plugins.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "io/input_file.hpp"
#include "meshops/error.hpp"
#include "meshops/plugin.hpp"

namespace tri {
namespace {

constexpr std::string_view mark = "tri plug-in {";

/// The interfaces that a file says it was built with. More than one if it holds this library as well.
std::vector<std::string_view> interfaces_in(std::string_view bytes) {
  std::vector<std::string_view> found;
  for (std::size_t at = bytes.find(mark); at != std::string_view::npos; at = bytes.find(mark, at)) {
    at += mark.size();
    const std::string_view text = bytes.substr(at, 400);
    const std::size_t end = text.find_first_of(std::string_view("}\0", 2));
    if (end != std::string_view::npos && end > 0 && text[end] == '}') found.push_back(text.substr(0, end));
  }
  return found;
}

[[noreturn]] void refuse(const std::string& path, std::string_view other) {
  throw IoError(path, fmt::format("this plug-in was built with {}; here is {}", other, TRI_PLUGIN_INTERFACE));
}

void check_interface(const std::string& path) {
  const InputFile file(path);
  const std::vector<std::string_view> interfaces = interfaces_in(file.bytes());
  if (interfaces.empty()) throw IoError(path, "is no plug-in of tri");
  if (std::ranges::find(interfaces, TRI_PLUGIN_INTERFACE) == interfaces.end()) refuse(path, interfaces.front());
}

std::shared_ptr<void> open_library(const std::string& path) {
  // A name without a slash would be searched in the system's folders.
  const std::string place = std::filesystem::absolute(path).string();
  void* handle = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) throw IoError(path, fmt::format("cannot be loaded: {}", dlerror()));
  return {handle, [](void* h) { dlclose(h); }};
}

Plugin register_from(Registry& registry, const std::string& path) {
  check_interface(path);
  const std::shared_ptr<void> library = open_library(path);
  using Entry = const PluginInfo* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(library.get(), "tri_plugin"));
  if (!entry) throw IoError(path, "is no plug-in of tri: it has no function tri_plugin");
  const PluginInfo& info = *entry();
  const std::vector<std::string_view> said = interfaces_in(info.interface_text);
  if (said.empty() || said.front() != TRI_PLUGIN_INTERFACE)
    refuse(path, said.empty() ? "something else" : said.front());

  // Holds the code in any case while operators of it are there, also half of them after an exception.
  Registry with_plugin = registry;
  with_plugin.keep(library);
  Plugin plugin{path, info.name, info.version, {}};
  const std::size_t before = with_plugin.operators().size();
  std::optional<std::string> failure;
  try {
    info.register_operators(with_plugin);
  } catch (const std::exception& error) {  // its type may be code of the plug-in, which will be gone
    failure = error.what();
  } catch (...) {
    failure = "an exception of unknown type";
  }
  if (failure) throw InvalidInput(fmt::format("{}: plug-in {} {}: {}", path, plugin.name, plugin.version, *failure));
  for (std::size_t i = before; i < with_plugin.operators().size(); ++i)
    plugin.operators.push_back(with_plugin.operators()[i]->name());
  registry = std::move(with_plugin);
  return plugin;
}

std::vector<std::string> plugin_files(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    if (entry->path().extension() == ".so") files.push_back(entry->path().string());
  if (error) throw IoError(folder, fmt::format("the folder of plug-ins cannot be read: {}", error.message()));
  std::ranges::sort(files);
  return files;
}

}  // namespace

Plugin load_plugin(Registry& registry, const std::string& path) {
  return register_from(registry, path);
}

std::vector<Plugin> load_plugins(Registry& registry, std::span<const std::string> folders) {
  Registry with_plugins = registry;
  std::vector<Plugin> plugins;
  for (const std::string& folder : folders)
    for (const std::string& file : plugin_files(folder)) plugins.push_back(register_from(with_plugins, file));
  registry = std::move(with_plugins);
  return plugins;
}

std::vector<std::string> plugin_folders(std::string_view list) {
  std::vector<std::string> folders;
  while (!list.empty()) {
    const std::size_t colon = std::min(list.find(':'), list.size());
    if (colon > 0) folders.emplace_back(list.substr(0, colon));
    list.remove_prefix(std::min(colon + 1, list.size()));
  }
  return folders;
}

}  // namespace tri

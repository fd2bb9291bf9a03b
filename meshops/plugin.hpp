#pragma once

#include <OpenMesh/Core/System/config.h>

#include <nlohmann/json.hpp>

#include "meshops/registry.hpp"
#include "meshops/version.hpp"

/// The text of a macro's value.
#define TRI_PLUGIN_TEXT_OF(x) #x
#define TRI_PLUGIN_TEXT(x) TRI_PLUGIN_TEXT_OF(x)

/// @cond  Parts of TRI_PLUGIN_INTERFACE.
#if defined(__clang__)
#define TRI_PLUGIN_COMPILER "Clang " TRI_PLUGIN_TEXT(__clang_major__)
#elif defined(__GNUC__)
#define TRI_PLUGIN_COMPILER "GCC " TRI_PLUGIN_TEXT(__GNUC__)
#else
#define TRI_PLUGIN_COMPILER "an unknown compiler"
#endif

#if defined(_LIBCPP_VERSION)
#define TRI_PLUGIN_LIBRARY "libc++"
#elif defined(_GLIBCXX_DEBUG)
#define TRI_PLUGIN_LIBRARY "libstdc++ in debug mode"
#elif defined(_GLIBCXX_USE_CXX11_ABI) && !_GLIBCXX_USE_CXX11_ABI
#define TRI_PLUGIN_LIBRARY "libstdc++ with old strings"
#else
#define TRI_PLUGIN_LIBRARY "libstdc++"
#endif
/// @endcond

/// What a plug-in and the program that loads it must have in common, as one line of text: the versions of tri, OpenMesh
/// and nlohmann-json, the compiler and its standard library. Two that say the same may be put together.
#define TRI_PLUGIN_INTERFACE                                                    \
  "tri " TRI_VERSION_INTERFACE ", " TRI_PLUGIN_COMPILER ", " TRI_PLUGIN_LIBRARY \
  ", OpenMesh " TRI_PLUGIN_TEXT(OM_VERSION) ", nlohmann-json " TRI_PLUGIN_TEXT( \
      NLOHMANN_JSON_VERSION_MAJOR) "." TRI_PLUGIN_TEXT(NLOHMANN_JSON_VERSION_MINOR)

namespace tri {

/// What a plug-in says of itself; `TRI_PLUGIN` makes it.
struct PluginInfo {
  const char* interface_text;                      ///< "tri plug-in {…}" around the plug-in's TRI_PLUGIN_INTERFACE
  const char* name;                                ///< for messages
  const char* version;                             ///< the plug-in's own, for messages
  void (*register_operators)(Registry& registry);  ///< adds its operators; may throw
};

}  // namespace tri

/// Makes a shared object a plug-in; stands once, outside of any namespace:
///
///     TRI_PLUGIN("rounding", "1.2", [](tri::Registry& registry) {
///       registry.add("round-corners", round_corners, "Rounds convex corners");
///     })
///
/// @param name      text, for messages
/// @param version   text, the plug-in's own
/// @param ...       anything that converts to void (*)(tri::Registry&); adds the operators. What it throws is an error
/// of
///   the plug-in, and nothing of it stays registered.
#define TRI_PLUGIN(name, version, ...)                                                                       \
  extern "C" __attribute__((visibility("default"))) const tri::PluginInfo* tri_plugin() {                    \
    static const tri::PluginInfo info{"tri plug-in {" TRI_PLUGIN_INTERFACE "}", name, version, __VA_ARGS__}; \
    return &info;                                                                                            \
  }

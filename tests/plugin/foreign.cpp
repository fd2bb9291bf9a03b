// A plug-in that says it was built with something else. None of its code may run.
#include <cstdlib>

#include "meshops/plugin.hpp"

namespace {
const int never = (std::abort(), 0);
}

extern "C" const tri::PluginInfo* tri_plugin() {
  static const tri::PluginInfo info{"tri plug-in {tri 0.0, GCC 4, libstdc++, OpenMesh 0x80100, nlohmann-json 2.0}",
                                    never ? "" : "foreign", "1.0", [](tri::Registry&) {}};
  return &info;
}

// A plug-in whose second operator has a name that is taken.
#include "meshops/plugin.hpp"

namespace {

struct NoOptions {
  static const tri::OptionSchema& schema() {
    static const tri::OptionSchema schema = tri::Schema<NoOptions>();
    return schema;
  }
};

tri::Report nothing(tri::MeshView, const NoOptions&, tri::Context&) {
  return {};
}

}  // namespace

TRI_PLUGIN("clashing", "2.1", [](tri::Registry& registry) {
  registry.add("first-of-two", nothing, "Does nothing");
  registry.add("compact", nothing, "Does nothing");
})

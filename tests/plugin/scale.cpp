// A plug-in with one operator.
#include <tri/meshops/editing/mesh_edit.hpp>
#include <tri/meshops/plugin.hpp>

namespace {

struct ScaleOptions {
  double factor = 1;  ///< of all coordinates, above 0

  static const tri::OptionSchema& schema() {
    static const tri::OptionSchema schema = tri::Schema<ScaleOptions>().number(
        "factor", &ScaleOptions::factor, {.min = 0, .min_open = true, .help = "what coordinates are multiplied by"});
    return schema;
  }
};

// Scales a mesh about the origin. On cancel no vertex has moved.
tri::Report scale(tri::MeshView mesh, const ScaleOptions& options, tri::Context& context) {
  tri::validate(options);
  context.checkpoint();
  tri::Report report;
  if (options.factor == 1) return report;
  for (const tri::VertexHandle v : mesh.mesh.vertices()) {
    tri::set_point(mesh, v, mesh.point(v) * options.factor);
    ++report.vertices_moved;
  }
  return report;
}

}  // namespace

TRI_PLUGIN("scaling", "1.0", [](tri::Registry& registry) {
  registry.add("scale", scale, "Scales a mesh about the origin", {.idempotent = false});
})

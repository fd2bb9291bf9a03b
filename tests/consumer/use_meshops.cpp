// A mesh editor of its own: a float kernel with its own properties, on which operators run in place.

#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <tri/meshops/error.hpp>
#include <tri/meshops/mesh_view.hpp>
#include <tri/meshops/operators/compact.hpp>
#include <tri/meshops/operators/fill_holes.hpp>
#include <tri/meshops/operators/flip_diagonals.hpp>
#include <tri/meshops/pipeline.hpp>
#include <tri/meshops/version.hpp>

#include "require.hpp"

namespace {

struct EditorTraits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  FaceTraits { int layer = 7; };
};
using EditorMesh = OpenMesh::TriMesh_ArrayKernelT<EditorTraits>;

constexpr int side = 6;

// A flat square with a hole in the middle, each vertex with its number.
EditorMesh square_with_hole(OpenMesh::VPropHandleT<std::string>& label) {
  EditorMesh mesh;
  mesh.add_property(label, "label");
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) {
      const auto v = mesh.add_vertex({static_cast<float>(x), static_cast<float>(y), 0.1f});
      mesh.property(label, v) = std::to_string(v.idx());
    }
  const auto at = [](int x, int y) { return OpenMesh::VertexHandle(y * (side + 1) + x); };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      if (x == 2 && y == 3) continue;
      mesh.add_face(at(x, y), at(x + 1, y), at(x + 1, y + 1));
      mesh.add_face(at(x, y), at(x + 1, y + 1), at(x, y + 1));
    }
  return mesh;
}

struct LiftOptions {
  double height = 1;  ///< model units, above 0

  static const tri::OptionSchema& schema() {
    static const tri::OptionSchema schema = tri::Schema<LiftOptions>().number(
        "height", &LiftOptions::height, {.unit = "mm", .min = 0, .min_open = true, .help = "how far up"});
    return schema;
  }
};

// An operator of the editor's own.
tri::Report lift(tri::MeshView view, const LiftOptions& options, tri::Context& context) {
  tri::validate(options);
  context.checkpoint();
  tri::Report report;
  for (const auto v : view.mesh.vertices()) {
    view.point(v)[2] += options.height;
    ++report.vertices_moved;
  }
  return report;
}

}  // namespace

int main() {
  OpenMesh::VPropHandleT<std::string> label;
  EditorMesh mesh = square_with_hole(label);
  const std::size_t faces = mesh.n_faces();
  tri::Context context;

  {
    tri::MeshLease lease(mesh);
    const tri::Report report = tri::fill_holes(lease, {.max_edges = 8}, context);
    REQUIRE(report.faces_added == 2);
  }
  REQUIRE(mesh.n_faces() == faces + 2);
  REQUIRE(mesh.point(OpenMesh::VertexHandle(0))[2] == 0.1f);
  REQUIRE(mesh.property(label, OpenMesh::VertexHandle(11)) == "11");

  tri::Registry registry;
  tri::register_operators(registry);
  registry.add("lift", lift, "Lifts every vertex");
  REQUIRE(registry.find("lift") != nullptr);
  REQUIRE(tri::Registry::standard().find("lift") == nullptr);
  REQUIRE(registry.describe().size() == tri::Registry::standard().describe().size() + 1);

  tri::Pipeline pipeline(registry);
  pipeline.add(lift, {.height = 2}).add(tri::flip_diagonals).add(tri::compact);
  const tri::Pipeline same = tri::Pipeline::from_json(pipeline.to_json().dump(), registry);
  {
    tri::MeshLease lease(mesh);
    REQUIRE(same.run(lease.view(), context).size() == 3);
  }
  REQUIRE(mesh.point(OpenMesh::VertexHandle(0))[2] == static_cast<float>(static_cast<double>(0.1f) + 2));

  bool refused = false;
  try {
    pipeline.add("lift", {{"height", -1}});
  } catch (const tri::InvalidInput& error) {
    refused = std::string(error.what()).find("height = -1") != std::string::npos;
  }
  REQUIRE(refused);
  std::cout << "meshops " << tri::version << ": " << mesh.n_faces() << " faces\n";
  return 0;
}

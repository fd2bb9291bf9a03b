// How soon a cancel from another thread is heeded: for every registered operator, on a mesh of two million faces that
// gives it work, as a plain run and recorded (where an undo follows), and for `repair`. The table is explained in
// cancel_watch.hpp.
//
//     bench_cancel [NAME...]        TRI_BENCH_FACES=200000 for smaller meshes
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../tests/mesh_check.hpp"
#include "cancel_watch.hpp"
#include "damaged_torus.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/editing/change_set.hpp"
#include "meshops/registry.hpp"
#include "meshops/repair.hpp"

namespace {

using namespace tri;
using namespace tri::cancel_watch;

/// What an operator is given to have work on a mesh of two million faces.
struct Work {
  const char* name;
  const char* options = "{}";
  const char* variant = "";
};
constexpr Work works[] = {
    {"decimate"},
    {"decimate", R"({"ratio": 0.02})", "to 2%"},
    {"fair", R"({"region": "region"})"},
    {"fill-holes"},
    {"fill-holes", R"({"refine": true, "fair": "tangent"})", "fair"},
    {"flip-diagonals"},
    {"flip-diagonals", R"({"criterion": "delaunay"})", "delaunay"},
    {"flip-diagonals", R"({"criterion": "curvature"})", "curvature"},
    {"remesh"},
    {"remesh", R"({"adaptive": true, "max-error": 0.01, "length": 0.5})", "adaptive"},
    {"remove-components", R"({"min-triangles": 10})"},
    {"remove-redundant", R"({"max-length": 0.3})"},
    {"resolve-t-junctions"},
    {"smooth"},
    {"smooth", R"({"method": "cotangent"})", "cotangent"},
    {"stitch-boundaries", R"({"tolerance": 0.01})"},
    {"subdivide", R"({"scheme": "butterfly"})", "butterfly"},
    {"thin", R"({"voxel": 0.3})"},
    {"weld", R"({"tolerance": 0.001})", "tolerance"},
};

std::uint32_t cells() {
  return static_cast<std::uint32_t>(
      std::lround(std::sqrt(static_cast<double>(environment("TRI_BENCH_FACES", 2'000'000)) / 2)));
}

const Soup& damaged() {
  static const Soup soup = damaged_torus(cells());
  return soup;
}

/// With holes, gaps, some elements marked as deleted, and a region of vertices; `from` the damaged soup for soup
/// operators.
const Mesh& with_holes() {
  static const std::unique_ptr<BuiltMesh> built = [] {
    Context context;
    auto made = std::make_unique<BuiltMesh>(build_mesh(torus_with_holes(cells()), context));
    Mesh& mesh = made->mesh;
    mesh.request_face_status();
    mesh.request_edge_status();
    mesh.request_halfedge_status();
    mesh.request_vertex_status();
    const auto inner = [&](FaceHandle f) {
      for (auto v = mesh.cfv_iter(f); v.is_valid(); ++v)
        if (mesh.is_boundary(*v)) return false;
      return true;
    };
    for (int f = 5; f < static_cast<int>(mesh.n_faces()); f += 1000)
      if (inner(FaceHandle(f))) mesh.delete_face(FaceHandle(f), true);
    OpenMesh::VPropHandleT<int> region;
    mesh.add_property(region, "region");
    for (int v = 0; v < static_cast<int>(mesh.n_vertices()); ++v)  // a fifth of the torus, in eight patches
      mesh.property(region, VertexHandle(v)) =
          v % (static_cast<int>(mesh.n_vertices()) / 8) < static_cast<int>(mesh.n_vertices()) / 40;
    return made;
  }();
  return built->mesh;
}

const Mesh& from_damaged() {
  static const std::unique_ptr<BuiltMesh> built = [] {
    Context context;
    auto made = std::make_unique<BuiltMesh>(build_mesh(damaged(), context));
    made->mesh.request_face_status();
    made->mesh.request_edge_status();
    made->mesh.request_halfedge_status();
    made->mesh.request_vertex_status();
    return made;
  }();
  return built->mesh;
}

std::string state_of(const OpenMesh::TriConnectivity& mesh) {
  const auto problems = tri::test::mesh_problems(mesh);
  return problems.empty() ? "valid" : "BROKEN: " + problems.front();
}

bool same(const Soup& a, const Soup& b) {
  return a.points == b.points && a.triangles == b.triangles && a.vertex_scalars == b.vertex_scalars &&
         a.face_scalars == b.face_scalars;
}

using Options = std::shared_ptr<void>;

Case on_soup(const std::string& name, const std::function<void(Soup&, Context&)>& run) {
  return {name, [run] {
            auto soup = std::make_shared<Soup>(damaged());
            return Case::Job{[soup, run](Context& c) { run(*soup, c); },
                             [soup] { return same(*soup, damaged()) ? "as it was" : "CHANGED"; }};
          }};
}

Case on_mesh(const std::string& name, const Mesh& (*input)(), const Operator& op, const Options& options,
             bool recorded) {
  return {
      name, [input, &op, options, recorded] {
        auto mesh = std::make_shared<Mesh>(input());
        const auto run = [mesh, &op, options, recorded](Context& c) {
          if (recorded)
            record(
                view_of(*mesh), [&](MeshView view) { return op.run(view, options.get(), c); }, Recording::undoable, &c);
          else
            op.run(view_of(*mesh), options.get(), c);
        };
        const auto check = [mesh, input, recorded]() -> std::string {
          if (!recorded) return state_of(*mesh);
          Mesh before = input();
          return tri::test::snapshot(view_of(*mesh)) == tri::test::snapshot(view_of(before)) ? "as it was" : "CHANGED";
        };
        return Case::Job{run, check};
      }};
}

Case conversion(const Operator& op, const Options& options) {
  const bool from_soup = op.domain() == Domain::soup;
  return {op.name(), [&op, options, from_soup] {
            auto geometry = std::make_shared<Geometry>();
            if (from_soup)
              *geometry = damaged();
            else
              geometry->emplace<Mesh>(with_holes());
            return Case::Job{[geometry, &op, options](Context& c) { op.run(*geometry, options.get(), c); },
                             [geometry, from_soup]() -> std::string {
                               if (!from_soup) return state_of(std::get<Mesh>(*geometry));
                               return same(std::get<Soup>(*geometry), damaged()) ? "as it was" : "CHANGED";
                             }};
          }};
}

Case on_points(const std::string& name, const Operator& op, const Options& options) {
  return {name, [&op, options] {
            auto points = std::make_shared<PointSet>();
            points->points = damaged().points;
            return Case::Job{[points, &op, options](Context& c) { op.run(*points, options.get(), c); },
                             [points] { return points->points == damaged().points ? "as it was" : "CHANGED"; }};
          }};
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const auto& op : Registry::standard().operators()) {
    std::vector<Work> variants;
    for (const Work& w : works)
      if (op->name() == w.name) variants.push_back(w);
    if (variants.empty()) variants.push_back({op->name().c_str()});
    for (const Work& w : variants) {
      const Options options = op->schema().make();
      const Json wanted = Json::parse(w.options);
      for (const auto& [key, value] : wanted.items()) op->schema().set_json(options.get(), key, value);
      const std::string name = *w.variant ? op->name() + " " + w.variant : op->name();
      if (op->domain() != op->result()) {
        cases.push_back(conversion(*op, options));
      } else if (op->domain() == Domain::points) {
        cases.push_back(on_points(name, *op, options));
      } else {
        if (op->domain() == Domain::soup)
          cases.push_back(on_soup(name, [op, options](Soup& s, Context& c) { op->run(s, options.get(), c); }));
        const auto input = op->domain() == Domain::soup ? from_damaged : with_holes;
        cases.push_back(on_mesh(name + (op->domain() == Domain::soup ? " (mesh)" : ""), input, *op, options, false));
        cases.push_back(on_mesh(name + " (recorded)", input, *op, options, true));
      }
    }
  }
  for (const auto& [name, goal] :
       {std::pair{"repair solid", RepairGoal::solid}, {"repair surface", RepairGoal::surface}})
    cases.push_back(on_soup(name, [goal](Soup& s, Context& c) { repair(s, {.goal = goal}, c); }));
  return cases;
}

}  // namespace

int main(int argc, char** argv) {
  measure_chosen(all_cases(), argc, argv);
}

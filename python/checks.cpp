#include <pybind11/stl.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "io/measure_json.hpp"
#include "meshops/checks/mesh_check.hpp"
#include "meshops/checks/mesh_distance.hpp"
#include "meshops/repair.hpp"
#include "meshops/to_soup.hpp"
#include "python/call.hpp"
#include "python/choices.hpp"
#include "python/convert.hpp"
#include "python/held.hpp"
#include "python/module.hpp"

namespace tri::python {
namespace {

/// The triangles of a mesh or soup, to read.
class Triangles {
 public:
  explicit Triangles(const py::object& object) {
    if (py::isinstance<HeldSoup>(object)) {
      reading_.emplace(object.cast<const HeldSoup&>());
    } else if (py::isinstance<HeldMesh>(object)) {
      const HeldMesh::Reading mesh(object.cast<const HeldMesh&>());
      copy_ = to_soup(view_of(const_cast<Mesh&>(*mesh)));  // reads
    } else {
      throw py::type_error("a Mesh or a Soup is needed");
    }
  }
  const Soup& operator*() const { return reading_ ? **reading_ : copy_; }

 private:
  std::optional<HeldSoup::Reading> reading_;
  Soup copy_;
};

py::object check(const py::object& mesh, std::size_t most, bool self_intersections, const py::object& progress,
                 int threads) {
  const Triangles triangles(mesh);
  Call call(progress, threads);
  MeshCheckOptions options;
  options.self_intersections = self_intersections;
  const MeshCheck result = call.run([&](Context& context) { return check_mesh(*triangles, options, context); });
  return to_python(tri::to_json(result, most));
}

py::object distance(const py::object& first, const py::object& second, std::optional<std::uint64_t> samples,
                    std::uint64_t seed, double relative_error, const py::object& progress, int threads) {
  const Triangles a(first), b(second);
  MeshDistanceOptions options;
  options.samples = samples;
  options.seed = seed;
  options.relative_error = relative_error;
  Call call(progress, threads);
  const MeshDistance result = call.run([&](Context& context) { return mesh_distance(*a, *b, options, context); });
  py::dict dict = to_python(tri::to_json(result));
  dict["forward"]["values"] = copy_of_rows<double>(result.forward.vertices, 0);
  dict["backward"]["values"] = copy_of_rows<double>(result.backward.vertices, 0);
  return dict;
}

py::object repair_soup(HeldSoup& held, const std::string& goal, double max_deviation, const py::object& progress,
                       int threads) {
  RepairOptions options;
  options.goal = choice<RepairGoal>(
      "goal", goal, {{"auto", RepairGoal::automatic}, {"solid", RepairGoal::solid}, {"surface", RepairGoal::surface}});
  options.max_deviation = max_deviation;
  const HeldSoup::Changing soup(held);
  Call call(progress, threads);
  const RepairResult result = call.run([&](Context& context) { return repair(*soup, options, context); });
  Json json{{"goal", result.goal == RepairGoal::solid ? "solid" : "surface"},
            {"changed", result.changed},
            {"left", result.left},
            {"steps", Json::array()}};
  for (const Report& step : result.steps) json["steps"].push_back(tri::to_json(step));
  return to_python(json);
}

}  // namespace

void add_checks(py::module_& module) {
  module.def(
      "check", &check, py::arg("mesh"), py::kw_only(), py::arg("most") = 100, py::arg("self_intersections") = true,
      py::arg("progress") = py::none(), py::arg("threads") = 0,
      "What is wrong with a Mesh or Soup and where, as a dict: verdict, counts, defects, places (at most `most` of each).");
  module.def(
      "mesh_distance", &distance, py::arg("first"), py::arg("second"), py::kw_only(), py::arg("samples") = py::none(),
      py::arg("seed") = 1, py::arg("relative_error") = 0.01, py::arg("progress") = py::none(), py::arg("threads") = 0,
      "How far two surfaces are apart, as a dict: hausdorff and hausdorff_bound, between which the Hausdorff distance lies,\n"
      "mean, rms, and both directions, each with the signed distance of every vertex (values). Model units.");
  module.def(
      "repair", &repair_soup, py::arg("soup"), py::kw_only(), py::arg("goal") = "auto", py::arg("max_deviation") = 5e-4,
      py::arg("progress") = py::none(), py::arg("threads") = 0,
      "Makes a clean mesh of any triangles, in place: goal is solid, surface or auto. Returns what every step did.");
}

}  // namespace tri::python

#include <pybind11/stl.h>

#include <nlohmann/json.hpp>

#include "io/plugins.hpp"
#include "meshops/pipeline.hpp"
#include "meshops/registry.hpp"
#include "python/call.hpp"
#include "python/change.hpp"
#include "python/convert.hpp"
#include "python/held.hpp"
#include "python/module.hpp"
#include "python/report_dict.hpp"
#include "python/selection.hpp"

namespace tri::python {
namespace {

/// A registry, and what plug-ins it has.
struct HeldRegistry {
  Registry registry = Registry::standard();
};

Soup& editable(Soup& soup) {
  return soup;
}
PointSet& editable(PointSet& points) {
  return points;
}

template <class H>
py::object run_on(const Operator& op, const py::object& object, const void* options, Call& call) {
  const typename H::Changing value(object.cast<H&>());
  return report_dict(call.run([&](Context& context) { return op.run(editable(*value), options, context); }));
}

/// On all of a mesh or a selection, recorded if the mesh is.
py::object run_on_mesh_object(const Operator& op, HeldMesh& held, const py::object& selection, const void* options,
                              Call& call) {
  const HeldMesh::Changing value(held);
  const std::optional<Selection> part = selection_of(*value, selection);
  MeshView view = view_of(*value);
  view.selection = part ? &*part : nullptr;
  const std::shared_ptr<Change> recording = held.recording.lock();
  if (!recording) return report_dict(call.run([&](Context& context) { return op.run(view, options, context); }));
  ChangeSet change = call.run([&](Context& context) {
    return record(
        view, [&](MeshView recorded) { return op.run(recorded, options, context); }, context);
  });
  const py::object report = report_dict(change.reports().front());
  recording->add(std::move(change));
  return report;
}

/// In place on an object of the operator's domain; one on soups also on a mesh.
py::object run_operator(const HeldRegistry& held, const std::string& name, const py::object& object,
                        const py::dict& options, const py::object& selection, const py::object& progress, int threads) {
  const Registry registry = held.registry;  // kept while it runs
  const Operator& op = registry.at(name);
  const std::shared_ptr<void> own = op.schema().make();
  for (const auto& [key, value] : options)
    if (!value.is_none()) op.schema().set_json(own.get(), key.cast<std::string>(), to_json(value));
  Call call(progress, threads);
  if (py::isinstance<HeldMesh>(object))
    return run_on_mesh_object(op, object.cast<HeldMesh&>(), selection, own.get(), call);
  if (!selection.is_none()) throw InvalidInput(name + ": a selection is of a Mesh, and this is none");
  if (py::isinstance<HeldSoup>(object)) return run_on<HeldSoup>(op, object, own.get(), call);
  if (py::isinstance<HeldPoints>(object)) return run_on<HeldPoints>(op, object, own.get(), call);
  throw py::type_error(name + " needs a Mesh, a Soup or Points");
}

std::shared_ptr<Geometry> geometry_of(const py::object& object) {
  auto geometry = std::make_shared<Geometry>();
  if (py::isinstance<HeldMesh>(object))
    geometry->emplace<Mesh>(*HeldMesh::Reading(object.cast<const HeldMesh&>()));
  else if (py::isinstance<HeldSoup>(object))
    geometry->emplace<Soup>(*HeldSoup::Reading(object.cast<const HeldSoup&>()));
  else if (py::isinstance<HeldPoints>(object))
    geometry->emplace<PointSet>(*HeldPoints::Reading(object.cast<const HeldPoints&>()));
  else
    throw py::type_error("a Mesh, Soup or Points is needed");
  return geometry;
}

py::object object_of(const std::shared_ptr<Geometry>& geometry) {
  if (auto* mesh = std::get_if<Mesh>(geometry.get()))
    return py::cast(std::make_shared<HeldMesh>(std::shared_ptr<Mesh>(geometry, mesh)));
  if (auto* soup = std::get_if<Soup>(geometry.get()))
    return py::cast(std::make_shared<HeldSoup>(std::shared_ptr<Soup>(geometry, soup)));
  return py::cast(std::make_shared<HeldPoints>(std::shared_ptr<PointSet>(geometry, &std::get<PointSet>(*geometry))));
}

py::tuple run_recipe(const HeldRegistry& held, const py::object& object, const std::string& recipe,
                     const py::object& progress, int threads) {
  const Registry registry = held.registry;
  const Pipeline pipeline = Pipeline::from_json(recipe, registry);
  const std::shared_ptr<Geometry> geometry = geometry_of(object);
  Call call(progress, threads);
  const std::vector<Report> reports = call.run([&](Context& context) { return pipeline.run(*geometry, context); });
  py::list dicts;
  for (const Report& report : reports) dicts.append(report_dict(report));
  return py::make_tuple(object_of(geometry), dicts);
}

}  // namespace

void add_operators(py::module_& module) {
  py::class_<HeldRegistry>(module, "Registry",
                           "The operators by name; those of plug-ins are added to this object only.")
      .def(py::init<>(), "The standard operators.")
      .def(
          "load_plugins",
          [](HeldRegistry& held, const std::vector<std::string>& folders) {
            std::vector<std::string> names;
            for (const Plugin& plugin : load_plugins(held.registry, folders))
              names.insert(names.end(), plugin.operators.begin(), plugin.operators.end());
            return names;
          },
          py::arg("folders"), "Adds the operators of every plug-in (*.so) in these folders; returns their names.")
      .def(
          "describe", [](const HeldRegistry& held) { return to_python(held.registry.describe()); },
          "A list with a dict for each operator: name, domain, result, summary, options.");
  module.def("run_operator", &run_operator, py::arg("registry"), py::arg("name"), py::arg("object"), py::arg("options"),
             py::arg("selection"), py::arg("progress"), py::arg("threads"), "Runs one operator in place.");
  module.def("run_recipe", &run_recipe, py::arg("registry"), py::arg("object"), py::arg("recipe"), py::arg("progress"),
             py::arg("threads"), "Runs a recipe on a copy; returns what came out and the reports.");
}

}  // namespace tri::python

#include <pybind11/stl.h>

#include "io/mesh_file.hpp"
#include "io/points_file.hpp"
#include "meshops/mesh_view.hpp"
#include "python/call.hpp"
#include "python/convert.hpp"
#include "python/held.hpp"
#include "python/module.hpp"

namespace tri::python {
namespace {

/// The bytes of a path, whatever they are: str, bytes or os.PathLike.
std::string path_of(const py::object& object) {
  PyObject* bytes = nullptr;
  if (!PyUnicode_FSConverter(object.ptr(), &bytes)) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(bytes);
}

std::shared_ptr<HeldSoup> read_soup(const py::object& path, const py::object& progress, int threads) {
  Call call(progress, threads);
  return std::make_shared<HeldSoup>(
      call.run([name = path_of(path)](Context& context) { return std::make_shared<Soup>(read_mesh(name, context)); }));
}

std::shared_ptr<HeldPoints> read_points_object(const py::object& path, const py::object& progress, int threads) {
  Call call(progress, threads);
  return std::make_shared<HeldPoints>(call.run(
      [name = path_of(path)](Context& context) { return std::make_shared<PointSet>(read_points(name, context)); }));
}

std::vector<std::string> write(const py::object& path, const py::object& object, bool ascii) {
  Call call(py::none(), 0);
  const std::string name = path_of(path);
  if (py::isinstance<HeldPoints>(object)) {
    const HeldPoints::Reading points(object.cast<const HeldPoints&>());
    call.run([&](Context& context) { write_points(name, *points, context); });
    return {};
  }
  if (py::isinstance<HeldSoup>(object)) {
    const HeldSoup::Reading soup(object.cast<const HeldSoup&>());
    return call.run([&](Context& context) { return write_mesh(name, *soup, {.ascii = ascii}, context).notes; });
  }
  if (!py::isinstance<HeldMesh>(object)) throw py::type_error("a Mesh, Soup or Points is needed");
  const HeldMesh::Reading mesh(object.cast<const HeldMesh&>());
  // The view is not written to: a file is written from it.
  const MeshView view = view_of(const_cast<Mesh&>(*mesh));
  return call.run([&](Context& context) { return write_mesh(name, view, {.ascii = ascii}, context).notes; });
}

}  // namespace

void add_files(py::module_& module) {
  module.def("read_soup", &read_soup, py::arg("path"), py::kw_only(), py::arg("progress") = py::none(),
             py::arg("threads") = 0, "Reads STL, OBJ, PLY or OFF as a Soup: every face as the file has it.");
  module.def("read_points", &read_points_object, py::arg("path"), py::kw_only(), py::arg("progress") = py::none(),
             py::arg("threads") = 0, "Reads Points from text, CSV, PLY, PCD, PTX or E57, in the unit of the file.");
  module.def(
      "write", &write, py::arg("path"), py::arg("object"), py::kw_only(), py::arg("ascii") = false,
      "Writes a Mesh, a Soup or Points; the ending of the name gives the format. The file appears whole or not at all.\n"
      "Returns what the format could not hold, one sentence each.");
}

}  // namespace tri::python

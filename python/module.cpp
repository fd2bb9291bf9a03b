#include "python/module.hpp"

#include "meshops/version.hpp"

PYBIND11_MODULE(_tri, module) {
  module.doc() = "The compiled part of the package tri";
  module.attr("__version__") = tri::version;
  tri::python::add_errors(module);
  tri::python::add_selection(module);
  tri::python::add_changes(module);
  tri::python::add_geometry(module);
  tri::python::add_files(module);
  tri::python::add_operators(module);
  tri::python::add_checks(module);
#ifdef TRI_WITH_CAD
  tri::python::add_cad(module);
#endif
}

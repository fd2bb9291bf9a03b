#pragma once

#include <pybind11/pybind11.h>

namespace tri::python {

/// Each adds a part of the module.
void add_errors(pybind11::module_& module);
void add_selection(pybind11::module_& module);
void add_changes(pybind11::module_& module);
void add_geometry(pybind11::module_& module);
void add_files(pybind11::module_& module);
void add_operators(pybind11::module_& module);
void add_checks(pybind11::module_& module);
void add_cad(pybind11::module_& module);

}  // namespace tri::python

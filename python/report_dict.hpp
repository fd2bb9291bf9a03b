#pragma once

#include <pybind11/pybind11.h>

#include "meshops/report.hpp"

namespace tri::python {

/// A report as its JSON, with the indices of touched elements and the maps of `compact` as arrays.
pybind11::dict report_dict(const Report& report);

}  // namespace tri::python

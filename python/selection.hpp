#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>

#include "meshops/mesh.hpp"
#include "meshops/selection.hpp"

namespace tri::python {

/// The part of a mesh that an operator may change, by indices or as a mask; looked up in the mesh when an operator
/// runs.
struct SelectionObject {
  enum class Kind { faces, vertices, loops };
  Kind kind = Kind::faces;
  pybind11::array array;  ///< of shape (n,), of whole numbers or bools
};

/// @param object  None, a SelectionObject, or an array, which is of faces
/// @throws InvalidInput for an index that is not of the mesh or deleted, a mask of another length, an array of another
/// kind
std::optional<Selection> selection_of(const Mesh& mesh, const pybind11::object& object);

}  // namespace tri::python

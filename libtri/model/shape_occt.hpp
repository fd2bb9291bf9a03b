#pragma once

// Included only by the source files that wrap OpenCASCADE.
#include <TopoDS_Shape.hxx>
#include <string>
#include <utility>
#include <vector>

#include "libtri/model/shape.hpp"

namespace tri {

struct Shape::Impl {
  TopoDS_Shape shape;
  /// Names of the faces in TopExp::MapShapes order (entry i is face i + 1); empty if no face has one.
  std::vector<std::string> face_names;
};

inline Shape make_shape(const TopoDS_Shape& shape, std::vector<std::string> face_names = {}) {
  return Shape(std::make_shared<const Shape::Impl>(Shape::Impl{shape, std::move(face_names)}));
}
inline const TopoDS_Shape& occt(const Shape& shape) {
  return shape.impl().shape;
}

}  // namespace tri

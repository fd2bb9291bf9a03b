#pragma once

// Included only by the source files that wrap OpenCASCADE.
#include <TopoDS_Shape.hxx>

#include "libtri/shape.hpp"

namespace tri {

struct Shape::Impl {
  TopoDS_Shape shape;
};

inline Shape make_shape(const TopoDS_Shape& shape) { return Shape(std::make_shared<const Shape::Impl>(Shape::Impl{shape})); }
inline const TopoDS_Shape& occt(const Shape& shape) { return shape.impl().shape; }

}  // namespace tri

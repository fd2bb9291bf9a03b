#pragma once

#include <OpenMesh/Core/Geometry/VectorT.hh>

namespace tri {

/// A point or direction in space. `a | b` is the dot product, `a % b` the cross product.
using Vec3 = OpenMesh::Vec3d;

/// A point in a parameter plane.
using Vec2 = OpenMesh::Vec2d;

}  // namespace tri

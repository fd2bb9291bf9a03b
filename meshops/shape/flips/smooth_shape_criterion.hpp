#pragma once

#include <memory>

#include "meshops/context.hpp"
#include "meshops/shape/flips/flip_criterion.hpp"

namespace tri {

/// Smoothness where two normals differ by more than `sharp_angle` (radians), else the larger smallest angle; the words
/// are at `FlipDiagonalsOptions`. Judges every triangle and edge once at first: linear time, heeds cancel.
/// @throws Cancelled
std::unique_ptr<FlipCriterion> smooth_shape_criterion(MeshView mesh, double sharp_angle, const Context& context);

}  // namespace tri

#pragma once

#include <memory>

#include "meshops/context.hpp"
#include "meshops/shape/flips/flip_criterion.hpp"

namespace tri {

/// Least total absolute mean curvature: half the sum, over all inner edges, of length times the angle between the two
/// normals [Dyn, Hormann, Kim & Levin 2001, "Optimizing 3D triangulations using discrete curvature analysis"].
///
/// The paper compares it with the total absolute Gaussian curvature and the sum of the absolute principal curvatures
/// and finds none superior; this one depends on five edges of a quadrilateral, the others on four vertices with all
/// that surrounds them. Edges of a triangle without area have an angle of pi, so that none is made. The order that each
/// flip lowers is that sum in whole units of 2^-40 of the diagonal of the mesh. Linear time; heeds cancel.
/// @throws Cancelled
std::unique_ptr<FlipCriterion> curvature_criterion(MeshView mesh, const Context& context);

}  // namespace tri

#pragma once

#include <memory>

#include "meshops/context.hpp"
#include "meshops/shape/flips/flip_criterion.hpp"

namespace tri {

/// Delaunay: the angles opposite to an edge add up to no more than pi, which is to say that its cotangent weight is not
/// negative [Bobenko & Springborn 2007, "A discrete Laplace-Beltrami operator for simplicial surfaces"].
///
/// Only where the surface is smooth: the two normals differ by no more than `sharp_angle` (radians) before the flip and
/// after, and no side becomes sharp or sharper. Triangles without area have no normal; they count as smooth before.
/// The order that each flip lowers is first the number of triangles without area, then the sum over all triangles of
/// (squares of the sides) / area, which in the plane falls with every flip towards Delaunay and is least there
/// [Musin 1997, "Properties of the Delaunay triangulation"]. The two values of a flip are added in double precision,
/// and rounding never turns an order around, so the sum of the values as they are rounded does fall. Angles within
/// 1e-12 of pi are let be, so that squares and circles keep what they have. Linear time; heeds cancel.
/// @throws Cancelled
std::unique_ptr<FlipCriterion> delaunay_criterion(MeshView mesh, double sharp_angle, const Context& context);

}  // namespace tri

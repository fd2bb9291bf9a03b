#pragma once

#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/shape/edge_lines.hpp"

namespace tri {

/// For every vertex the edge length at which a triangle stands off the surface by no more than a tolerance [Dunyach,
/// Vanderhaeghe, Barthe & Botsch 2013, "Adaptive remeshing for real-time mesh deformation"]: sqrt(6 e / k - 3 e^2),
/// with k the greatest normal curvature, by the vertex's neighbours, or the curvature of the line it lies on.
///
/// Lengths are kept between `shortest` and `longest`, and grow by no more than a half of the way to the neighbour.
/// Deleted and isolated vertices have `longest`. Parallel; the same for any number of threads.
/// @param tolerance  model units, above 0
/// @throws Cancelled
std::vector<double> curvature_lengths(MeshView mesh, const EdgeLines& lines, double tolerance, double shortest,
                                      double longest, const Context& context);

}  // namespace tri

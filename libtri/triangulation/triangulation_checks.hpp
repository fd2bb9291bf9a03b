#pragma once

#include <span>

#include "libtri/registration.hpp"
#include "libtri/triangulation/point_mesh.hpp"
#include "libtri/triangulation/triangulate.hpp"

namespace tri {

/// Counts what is wrong with a connected mesh at the measured positions: folds, triangles that face against the model's
/// normals (by more than 120 degrees), registered points that are no vertex. Self-intersections and topologies are left
/// unset.
/// @param context  null: cannot be cancelled @throws Cancelled
TriangulationChecks check_triangulation(std::span<const Vec3> points, std::span<const Foot> feet, const PointMesh& mesh,
                                        const Context* context = nullptr);

}  // namespace tri

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libtri/registration.hpp"
#include "libtri/triangulation/point_mesh.hpp"
#include "libtri/triangulation/triangulate.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Where a connected mesh spans what was not measured.
struct Coverage {
  std::vector<UnmeasuredRegion> regions;      ///< largest disc first
  std::vector<std::uint32_t> open_triangles;  ///< ascending; without them the mesh stays manifold and keeps every
                                              ///< vertex
};

/// The spacing of points around each vertex, mm: on scattered points about the square root of the area per point, on
/// scan lines the distance of the lines. Taken from the radii of the circumcircles, which the dense direction does not
/// shrink, as the median over some forty vertices around, so that those at the rim of a gap know it as well as any.
///
/// @param places  feet of the points on the model, one per point
/// @return one value per point; 0 for points in no triangle
std::vector<float> point_spacing(const PointMesh& mesh, std::span<const Vec3> places);

/// Finds the regions of the model that hold a disc of more than `hole_size` local spacings in radius without a point,
/// and the triangles that span them. The disc lies on the model: it ends at free edges, and points on the other side of
/// a thin wall, whose normals are more than 1.9 rad away, do not count.
/// @throws Cancelled
Coverage find_unmeasured(const CadModel& model, const Registration& registration, const PointMesh& mesh,
                         std::span<const Foot> feet, double hole_size, Context& context);

/// Removes triangles and links the rest anew. @param drop  ascending indices
void drop_triangles(PointMesh& mesh, std::span<const std::uint32_t> drop);

}  // namespace tri

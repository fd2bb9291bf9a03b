#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// The sewn model as one triangle mesh whose faces share the vertices along their common edges.
///
/// Oriented as the model's shells. Triangles are linked along model edges by topology, never by distance; edges where
/// more than two faces meet are left unpaired. A vertex has exactly one fan of triangles, so the mesh is manifold even
/// where the model is not.
struct Tessellation {
  std::vector<Vec3> points;                            ///< mm
  std::vector<Triangle> triangles;                     ///< indices into points
  std::vector<std::array<std::int32_t, 3>> neighbors;  ///< triangle across the edge opposite corner k; -1 on a free
                                                       ///< edge
  std::vector<std::int32_t> faces;                     ///< per triangle: 0-based position in CadModel::faces
  std::vector<std::array<Vec2, 3>> corner_uv;          ///< per triangle corner: (u,v) on that face's surface
  double deflection = 0;                               ///< mm, largest wanted distance to the model
};

/// Tessellates the sewn shape of `model`.
///
/// @param deflection  mm, > 0: chord height of a triangle over the surface
/// @param angle       radians, > 0: largest turn of the normal along one triangle edge on curved faces
/// @throws CadError if no face could be tessellated; Cancelled before the work starts.
Tessellation tessellate(const CadModel& model, double deflection, double angle, const Context& context);

/// Connected components, boundary loops and Euler characteristic V - E + F of a manifold triangle mesh given by
/// neighbours.
struct SurfaceTopology {
  long components = 0;  ///< triangles joined over sides
  long loops = 0;       ///< closed runs of sides without a neighbour
  long euler = 0;       ///< V - E + F over the vertices that triangles use
  /// True if all three are the same.
  bool operator==(const SurfaceTopology&) const = default;
};
/// Counts them in linear time. @param neighbors  of each triangle across the side opposite corner k; -1 for none
/// @param context  null: cannot be cancelled @throws Cancelled
SurfaceTopology topology(const std::vector<Triangle>& triangles,
                         const std::vector<std::array<std::int32_t, 3>>& neighbors, const Context* context = nullptr);

}  // namespace tri

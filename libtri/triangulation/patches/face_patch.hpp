#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libtri/triangulation/patches/edge_chains.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A point inside a face's plane.
struct PlanePoint {
  Vec2 p;
  std::uint32_t vertex = 0;  ///< of the mesh to be
};

/// One triangle edge that lies on an edge of the model.
struct ChainSide {
  std::int32_t triangle = 0;
  int corner = 0;     ///< opposite the edge
  int edge = 0;       ///< position in CadModel::edges
  int segment = 0;    ///< between nodes `segment` and `segment + 1` of its chain
  bool along = true;  ///< the triangle runs the edge in its own direction
};

/// The triangulation of one trimmed face: Delaunay in its plane, with the chains of its edges as sides.
struct FacePatch {
  std::vector<Triangle> triangles;  ///< vertices of the mesh to be, counter-clockwise seen along -(du x dv)
  std::vector<std::array<std::int32_t, 3>> neighbors;
  std::vector<ChainSide> sides;
  std::vector<std::uint32_t> outside;                    ///< vertices that came to lie beyond the chains
  std::vector<std::array<std::uint32_t, 2>> coincident;  ///< (vertex, the one at the same place)
  std::vector<int> failed_edges;  ///< edges whose chains cross or touch another; the patch is then empty
};

/// Triangulates what lies inside the loops.
/// @param chains  per edge of the model
/// @param nodes   chain nodes whose own place in this plane is known, by ascending vertex: the chain passes through it
/// instead of the
///                closest place on the curve, unless it is the other side of a seam that is meant
/// @param reach   mm, per edge of the model: how far from the curve such a place may be
FacePatch triangulate_face(const FaceDomain& domain, const std::vector<EdgeChain>& chains,
                           std::span<const PlanePoint> nodes, std::span<const double> reach,
                           std::span<const PlanePoint> points, const Context& context);

}  // namespace tri

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libtri/triangulation/shell/edit_mesh.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Flips edges until every edge that is no crease and no boundary is locally Delaunay on the surface.
///
/// An edge is flipped if that lowers the harmonic index, the sum of squared edge lengths over area [Musin 1997], which
/// in the plane is the Delaunay criterion; the sum falls with every flip, so it ends. No flip turns a triangle against
/// the model's normals or doubles an edge.
/// @param seeds  triangles whose edges are looked at first; all triangles if empty
/// @return number of flips
/// @throws Cancelled with some flips done; the mesh is valid
std::size_t delaunay_flips(EditMesh& mesh, std::vector<std::int32_t> seeds, const Context& context);

/// Sets `Vertex::area` to a third of the triangles around it.
void measure_vertex_areas(EditMesh& mesh);
/// The same from some triangles only, ascending: right for vertices whose whole star is among them.
void measure_vertex_areas(EditMesh& mesh, std::span<const std::uint32_t> triangles);

/// Flips edges while that lowers the sum of `TriangleCost`, which ends because the sum falls with every flip.
/// @return number of flips
std::size_t cost_flips(EditMesh& mesh, std::vector<std::int32_t> seeds, const Context& context);

/// Splits sharp and free edges of the model until none is encroached: no opposite corner sees an edge under an obtuse
/// angle [Ruppert 1995], or the edge is shorter than `shortest`. New vertices belong to the model, not to the points.
///
/// @param shortest  mm, per vertex: edges whose shorter end value is above their length stay
/// @return number of splits
std::size_t split_encroached_edges(EditMesh& mesh, std::vector<float>& shortest, const Context& context);

}  // namespace tri

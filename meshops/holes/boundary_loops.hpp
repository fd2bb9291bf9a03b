#pragma once

#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// One closed run of boundary half-edges.
struct BoundaryLoop {
  /// Boundary half-edges, each the `next` of the one before; they have no face on their left, so the loop runs
  /// clockwise around the outside of a sheet seen from its front. The first is the one of lowest index.
  std::vector<HalfedgeHandle> halfedges;
  /// Where each half-edge starts; the first position is not repeated.
  std::vector<Vec3> polyline;
  double length = 0;   ///< model units
  int component = 0;   ///< 0-based; components are joined by edges and numbered by their lowest face index
  bool outer = false;  ///< the outer loop of its component; exactly one per component with a boundary
  int parent = -1;     ///< index of the outer loop of the component for a nested loop; -1 for the outer loop itself
  bool simple = true;  ///< visits no vertex twice
};

/// The half-edges of every boundary loop, as `BoundaryLoop::halfedges`, in order of their first half-edge. Linear time.
std::vector<std::vector<HalfedgeHandle>> boundary_cycles(MeshView mesh, const Context* context = nullptr);

/// Every boundary loop with what it is in its component.
///
/// The outer loop is the one that encloses most of the component's sheet: of the loops' vector areas (half the sum of
/// cross products, taken in the direction in which the faces run) it is the one that reaches farthest along the
/// component's own vector area, the sum of its face normals times areas. A nested loop (a hole) reaches against it, or
/// less far. Where the component's vector area is below 1e-6 of its area (a tube, open at both ends) the longest loop
/// is the outer one. Ties go to the first loop. Deleted elements are passed over. Linear time.
std::vector<BoundaryLoop> boundary_loops(MeshView mesh, const Context* context = nullptr);

/// Component of every face, 0-based, joined by edges, numbered by lowest face index; -1 for a deleted face.
std::vector<int> face_components(MeshView mesh, const Context* context = nullptr);

/// Number of faces in the component of every face, by face index; 0 for a deleted face.
std::vector<std::size_t> component_sizes(MeshView mesh, const Context* context = nullptr);

}  // namespace tri

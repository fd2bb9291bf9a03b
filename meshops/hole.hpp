#pragma once

#include <utility>
#include <vector>

#include "meshops/add_faces.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/ring_filling.hpp"

namespace tri {

/// One boundary loop and the ways to close it. Reads the mesh; valid until the mesh changes at the rim.
class Hole {
 public:
  /// @param rim  the loop's boundary half-edges in order (see `BoundaryLoop::halfedges`); new triangles run along them.
  Hole(MeshView view, std::vector<HalfedgeHandle> rim);

  const std::vector<VertexHandle>& vertices() const { return vertices_; }
  int size() const { return static_cast<int>(vertices_.size()); }

  /// Visits no vertex twice.
  bool simple() const;
  /// Has two vertices farther apart than `limit` (model units; infinity: never).
  bool wider_than(double limit) const;
  bool around_single_triangle() const;
  /// Whether the loop's own normal points away from the normals of the faces along it (mean cosine below -0.5): the
  /// outer rim of a sheet, whose triangles would lie on the sheet's back. A loop of at most 6 edges on a component of
  /// more than 24 faces is a hole in any case: the sheet is folded there.
  /// @param component_faces  number of faces of the loop's component.
  bool rim_of_sheet(std::size_t component_faces) const;

  /// The size() - 2 triangles that close the hole without using an edge of the mesh as a chord; empty if there are
  /// none. As `fill_ring`.
  /// @param in_pieces  set to `RingFilling::in_pieces`
  std::vector<VertexTriple> triangulate(HoleStrategy strategy, int max_dynamic_edges, const Context& context,
                                        bool& in_pieces);

 private:
  void find_forbidden();
  Vec3 face_normal(FaceHandle f) const;
  std::vector<Vec3> edge_normals() const;
  std::vector<Vec3> vertex_normals() const;

  MeshView view_;
  std::vector<HalfedgeHandle> rim_;
  std::vector<VertexHandle> vertices_;
  std::vector<Vec3> points_;
  std::vector<std::pair<int, int>>
      forbidden_;  ///< ring positions i < j joined by an edge of the mesh that is not of the rim, sorted
};

}  // namespace tri

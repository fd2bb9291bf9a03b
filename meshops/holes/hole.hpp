#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "meshops/editing/add_faces.hpp"
#include "meshops/holes/filling_obstacles.hpp"
#include "meshops/holes/ring_filling.hpp"
#include "meshops/holes/ring_untangling.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// The triangles of a filling, not yet in the mesh.
struct HoleFilling {
  std::vector<VertexTriple> triangles;  ///< none if there is no triangulation without an existing edge
  bool in_pieces = false;               ///< `RingFilling::in_pieces`
  std::size_t crossings = 0;  ///< pairs of triangles, of the filling or of it and the mesh, that meet where they should
                              ///< not
};

/// One boundary loop and the ways to close it. Reads the mesh; valid until the mesh changes at the rim.
class Hole {
 public:
  /// @param rim  the loop's boundary half-edges in order (see `BoundaryLoop::halfedges`); new triangles run along them.
  /// A loop that meets itself is taken as one outline (an island that touches the rim, say); see `simple_loops` as
  /// well.
  Hole(MeshView view, std::vector<HalfedgeHandle> rim);

  /// Vertices in order, and after `join_island` those at which a bridge ends twice.
  const std::vector<VertexHandle>& vertices() const { return vertices_; }
  /// Where they are, one for each of `vertices()`.
  const std::vector<Vec3>& points() const { return points_; }
  /// Number of vertices, and of edges around the hole.
  int size() const { return static_cast<int>(vertices_.size()); }

  /// Visits no vertex twice.
  bool simple() const;
  /// Has two vertices farther apart than `limit` (model units; infinity: never).
  bool wider_than(double limit) const;
  /// True if the loop is the outside of one triangle that has no neighbour.
  bool around_single_triangle() const;
  /// Whether the loop's own normal points away from the normals of the faces along it (mean cosine below -0.5): the
  /// outer rim of a sheet, whose triangles would lie on the sheet's back. A loop of at most 6 edges on a component of
  /// more than 24 faces is a hole in any case: the sheet is folded there.
  /// @param component_faces  number of faces of the loop's component.
  bool rim_of_sheet(std::size_t component_faces) const;
  /// The face at the rim's first edge.
  FaceHandle face_at_rim() const { return view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(rim_.front())); }
  /// Mean of the normals of the faces along the rim, weighted by the edges' lengths; not of unit length.
  Vec3 mean_normal() const;

  /// Makes another boundary loop an inner contour of the filling, joined by a bridge between the two nearest vertices
  /// that no edge joins yet.
  /// @return false, with nothing changed, if every vertex of one is joined to all of the other.
  bool join_island(const std::vector<HalfedgeHandle>& loop);

  /// The size() - 2 triangles that close the hole without using an edge of the mesh as a chord; empty if there are
  /// none. As `fill_ring`.
  std::vector<VertexTriple> triangulate(HoleStrategy strategy, int max_dynamic_edges, const Context& context) const;

  /// The same, but as little as possible through the mesh: where the filling crosses something it is changed around
  /// the crossings (`untangle_filling`), then the other strategies are tried, and the one with the fewest crossings
  /// counts. Edges of the rim that go through faces of the mesh make crossings that no filling avoids: it ends when
  /// there are no others.
  HoleFilling fill(HoleStrategy strategy, int max_dynamic_edges, const FillingObstacles& obstacles,
                   const Context& context) const;

 private:
  Ring ring() const;
  std::vector<int> unavoidable_crossings(const FillingObstacles& obstacles, std::size_t& total) const;
  std::vector<std::pair<int, int>> forbidden_chords() const;
  std::vector<VertexTriple> named(std::span<const RingTriangle> triangles) const;
  Vec3 face_normal(FaceHandle f) const;
  Vec3 normal_beyond(HalfedgeHandle h) const;
  std::vector<Vec3> vertex_normals() const;

  MeshView view_;
  std::vector<HalfedgeHandle> rim_;  ///< by position; invalid where a bridge starts
  std::vector<VertexHandle> vertices_;
  std::vector<Vec3> points_;
  std::vector<std::pair<VertexHandle, VertexHandle>> bridges_;
};

/// The simple loops of a boundary loop that meets itself: cut apart at each vertex that is met again.
std::vector<std::vector<HalfedgeHandle>> simple_loops(MeshView mesh, const std::vector<HalfedgeHandle>& loop);

}  // namespace tri

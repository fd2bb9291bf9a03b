#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "meshops/editing/add_faces.hpp"
#include "meshops/holes/filling_projection.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/search/overlap_tree.hpp"

namespace tri {

/// The triangles of a mesh that a filling may run into: those in the boxes of the holes, and fillings made before.
/// For one thread.
class FillingObstacles {
 public:
  /// Looks at every face once. @param rims  the vertices of each hole that may be filled, in order; outlive this object
  FillingObstacles(MeshView mesh, std::span<const std::vector<VertexHandle>> rims);

  /// From now on `crossings` and `in_doubt` are asked about the filling of this hole.
  void start(std::size_t hole);

  /// 0 for triangles of a filling of which it is cheap to show that `crossings` is 0 and that they meet no other of the
  /// filling in more than what they share; 1 for those that must be looked at. Shows most of them where the filling of
  /// a long rim can be projected to a plane (`FillingProjection`).
  /// @param filling  a whole one, of all edges of the hole
  std::vector<char> in_doubt(std::span<const VertexTriple> filling) const;

  /// How many faces of the mesh (but none of this hole's own filling) a triangle meets in more than the vertices or the
  /// edge that they share, vertices in one place being one; 0 if it has no area.
  int crossings(const VertexTriple& triangle) const;

  /// The faces of the mesh (but none of this hole's own filling) that an edge goes through, strictly, and of which
  /// neither of its ends is a corner: every triangle at the edge crosses them. Ascending.
  std::vector<FaceHandle> pierced(VertexHandle from, VertexHandle to) const;

  /// The hole was filled by these faces, which are final.
  void add(std::size_t hole, std::span<const FaceHandle> faces);

 private:
  /// Faces in a tree that is built when it is first asked. Long ones are in it in several pieces, whose boxes together
  /// are far smaller.
  struct Faces {
    std::vector<FaceHandle> faces;
    mutable std::optional<OverlapTree> tree;
    mutable std::vector<std::uint32_t> face_of;  ///< of the boxes in the tree: which of `faces`; empty if none was cut
    mutable std::vector<std::uint32_t> asked;    ///< by face: the last question in which it came up
    mutable std::uint32_t question = 0;
  };
  /// Calls `visit(face)` for those whose boxes `find` hands over, each once.
  template <class Find, class Visit>
  void each_face(const Faces& faces, const Find& find, const Visit& visit) const;
  const OverlapTree& tree_of(const Faces& faces) const;
  OverlapTree::Box box_of(FaceHandle f) const;
  int crossings_with(const Faces& faces, const std::array<Vec3, 3>& at) const;
  void project(std::size_t hole);

  MeshView view_;
  std::span<const std::vector<VertexHandle>> rings_;
  OverlapTree rims_;
  Faces mesh_;
  std::vector<std::unique_ptr<Faces>> fillings_;  ///< by hole
  std::vector<const Faces*> near_;
  std::unique_ptr<FillingProjection> projection_;
  Faces others_;  ///< that may be near this hole and are not covered by the projection
};

}  // namespace tri

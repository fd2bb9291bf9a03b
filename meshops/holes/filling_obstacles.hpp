#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "meshops/editing/add_faces.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/search/overlap_tree.hpp"

namespace tri {

/// The triangles of a mesh that a filling may run into: those in the boxes of the holes, and fillings made before.
class FillingObstacles {
 public:
  /// Looks at every face once. @param rims  the vertices of each hole that may be filled
  FillingObstacles(MeshView mesh, std::span<const std::vector<VertexHandle>> rims);

  /// From now on `crossings` is asked about the filling of this hole.
  void start(std::size_t hole);

  /// How many faces of the mesh (but none of this hole's own filling) a triangle meets in more than the vertices or the
  /// edge that they share, vertices in one place being one; 0 if it has no area.
  int crossings(const VertexTriple& triangle) const;

  /// The hole was filled by these faces, which are final.
  void add(std::size_t hole, std::span<const FaceHandle> faces);

 private:
  struct Faces {
    std::vector<FaceHandle> faces;
    OverlapTree tree;
  };
  Faces tree_of(std::vector<FaceHandle> faces) const;
  OverlapTree::Box box_of(FaceHandle f) const;
  int crossings_with(const Faces& faces, const std::array<Vec3, 3>& at) const;

  MeshView view_;
  OverlapTree rims_;
  std::unique_ptr<Faces> mesh_;
  std::vector<std::unique_ptr<Faces>> fillings_;  ///< by hole
  std::vector<const Faces*> near_;
};

}  // namespace tri

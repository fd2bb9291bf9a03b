#pragma once

#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// The triangles of a mesh before it is changed, so that what became of it can be told from what it was.
///
/// For operators that add and delete on the way what is not there in the end, and never collect.
class MeshBefore {
 public:
  /// @param context  null: cannot be cancelled @throws Cancelled
  explicit MeshBefore(MeshView mesh, const Context* context = nullptr);

  const std::vector<Vec3>& points() const { return points_; }  ///< one per vertex, deleted ones too
  /// Of the faces that were not deleted, in their order. Corner k is where half-edge k of the face ends, which begin
  /// with `halfedge_handle(face)`.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<FaceHandle>& faces() const { return faces_; }  ///< one per triangle

  bool was_there(VertexHandle v) const { return static_cast<std::size_t>(v.idx()) < points_.size(); }

  /// Fills the counts of vertices and faces, and what was touched: vertices that moved or are new, faces that have
  /// other corners or are new.
  void compare(MeshView now, Report& report, const Context* context = nullptr) const;

 private:
  std::vector<Vec3> points_;
  std::vector<char> alive_;  // per vertex
  std::vector<Triangle> triangles_;
  std::vector<FaceHandle> faces_;
  std::size_t face_count_ = 0;  // deleted ones too
};

}  // namespace tri

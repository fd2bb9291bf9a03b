#pragma once

#include <type_traits>

#include "meshops/mesh.hpp"

namespace tri {

/// How every operator takes a mesh: the connectivity that every OpenMesh triangle kernel derives from, and its positions
/// as doubles. Cheap to copy; valid while the mesh (and, for other than `Vec3` kernels, the `MeshLease`) lives.
///
/// Operators may add elements and mark elements as deleted; they never collect garbage.
struct MeshView {
  OpenMesh::TriConnectivity& mesh;
  OpenMesh::VPropHandleT<Vec3> position_property;

  Vec3& point(VertexHandle v) const { return mesh.property(position_property, v); }
};

/// Opens any OpenMesh triangle kernel as a `MeshView` for as long as the lease lives.
///
/// A kernel whose points are `Vec3` is viewed in place. Any other (float, Eigen) gets a temporary double property, whose
/// changed positions are written back when the lease ends, so untouched vertices keep their exact bits. Status
/// attributes are requested if missing and, if so, released again at the end unless elements are marked deleted (releasing
/// them then would resurrect the deleted elements).
template <class Kernel>
class MeshLease {
 public:
  explicit MeshLease(Kernel& kernel) : kernel_(kernel), had_status_(kernel.has_vertex_status() && kernel.has_edge_status() &&
                                                                    kernel.has_halfedge_status() && kernel.has_face_status()) {
    kernel_.request_vertex_status();
    kernel_.request_edge_status();
    kernel_.request_halfedge_status();
    kernel_.request_face_status();
    if constexpr (in_place) {
      position_ = kernel_.points_property_handle();
    } else {
      kernel_.add_property(position_);
      for (std::size_t i = 0; i < kernel_.n_vertices(); ++i) {
        const VertexHandle v(static_cast<int>(i));
        kernel_.property(position_, v) = widened(kernel_.point(v));
      }
    }
  }
  MeshLease(const MeshLease&) = delete;
  MeshLease& operator=(const MeshLease&) = delete;

  ~MeshLease() {
    if constexpr (!in_place) {
      for (std::size_t i = 0; i < kernel_.n_vertices(); ++i) {
        const VertexHandle v(static_cast<int>(i));
        const Vec3& p = kernel_.property(position_, v);
        if (widened(kernel_.point(v)) != p) {
          for (int k = 0; k < 3; ++k) kernel_.point(v)[k] = static_cast<Scalar>(p[k]);
        }
      }
      kernel_.remove_property(position_);
    }
    if (had_status_ || !has_deleted()) {
      kernel_.release_vertex_status();
      kernel_.release_edge_status();
      kernel_.release_halfedge_status();
      kernel_.release_face_status();
    }
  }

  MeshView view() { return {kernel_, position_}; }
  operator MeshView() { return view(); }

 private:
  using Point = typename Kernel::Point;
  using Scalar = std::remove_cvref_t<decltype(std::declval<Point&>()[0])>;
  static constexpr bool in_place = std::is_same_v<Point, Vec3>;

  static Vec3 widened(const Point& p) {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }
  bool has_deleted() const {
    for (std::size_t i = 0; i < kernel_.n_vertices(); ++i)
      if (kernel_.status(VertexHandle(static_cast<int>(i))).deleted()) return true;
    for (std::size_t i = 0; i < kernel_.n_faces(); ++i)
      if (kernel_.status(FaceHandle(static_cast<int>(i))).deleted()) return true;
    return false;
  }

  Kernel& kernel_;
  bool had_status_;
  OpenMesh::VPropHandleT<Vec3> position_;
};

/// The view of the default kernel, which needs no lease.
inline MeshView view_of(Mesh& mesh) { return {mesh, mesh.points_property_handle()}; }

}  // namespace tri

#pragma once

#include <span>
#include <type_traits>

#include "meshops/editing/property_policy.hpp"
#include "meshops/mesh.hpp"
#include "meshops/selection.hpp"

namespace tri {

class ChangeRecorder;

/// How every operator takes a mesh: the connectivity that every OpenMesh triangle kernel derives from, and its
/// positions as doubles. Cheap to copy; valid while the mesh (and, for other than `Vec3` kernels, the `MeshLease`)
/// lives.
///
/// Operators may add elements and mark elements as deleted; they never collect garbage.
struct MeshView {
  OpenMesh::TriConnectivity& mesh;                 ///< links, status and properties; outlives the view
  OpenMesh::VPropHandleT<Vec3> position_property;  ///< where the positions are
  /// What may be changed; null: everything. Outlives the view.
  const Selection* selection = nullptr;
  /// Is told of changes; null: nobody is.
  ChangeRecorder* recorder = nullptr;
  /// What new elements inherit; never null.
  const PropertyPolicy* policy = &PropertyPolicy::standard();

  /// The position of a vertex. An operator writes to it through `set_point`, so that the change is recorded.
  Vec3& point(VertexHandle v) const { return mesh.property(position_property, v); }

  /// What the selection allows (see there): a face that may be deleted, replaced or turned over.
  bool may_replace(FaceHandle f) const { return !selection || selection->may_replace(f); }
  /// A vertex that may get another position.
  bool may_move(VertexHandle v) const { return !selection || selection->may_move(v); }
  /// Flipped, split or collapsed: true if the one or two faces of the edge may be replaced.
  bool may_change(EdgeHandle e) const {
    if (!selection) return true;
    for (const unsigned side : {0u, 1u}) {
      const FaceHandle f = mesh.face_handle(mesh.halfedge_handle(e, side));
      if (f.is_valid() && !selection->may_replace(f)) return false;
    }
    return true;
  }
  /// True if the vertex may be moved and every face around it replaced.
  bool may_remove(VertexHandle v) const {
    if (!selection) return true;
    if (!selection->may_move(v)) return false;
    for (auto f = mesh.cvf_iter(v); f.is_valid(); ++f)
      if (!selection->may_replace(*f)) return false;
    return true;
  }
  /// A boundary loop, by its half-edges, that may be filled.
  bool may_fill(std::span<const HalfedgeHandle> loop) const { return !selection || selection->may_fill(mesh, loop); }

  /// The same mesh, for operators that are to keep to a selection.
  MeshView with(const Selection& part) const {
    MeshView view = *this;
    view.selection = &part;
    return view;
  }
};

/// True for every instance of OpenMesh::TriMesh_ArrayKernelT, whatever its traits.
template <class Kernel>
inline constexpr bool is_triangle_kernel = std::is_base_of_v<OpenMesh::TriConnectivity, Kernel>;

/// Adds the types of properties that only this kernel has: its traits and its points.
template <class Kernel>
void add_types_of(PropertyTypes& types) {
  types.add<typename Kernel::VertexData>();
  types.add<typename Kernel::EdgeData>();
  types.add<typename Kernel::HalfedgeData>();
  types.add<typename Kernel::FaceData>();
  types.add<typename Kernel::Point>();
  types.add<typename Kernel::Normal>();
  types.add<typename Kernel::Color>();
  types.add<typename Kernel::TexCoord2D>();
}

/// Opens any OpenMesh triangle kernel as a `MeshView` for as long as the lease lives.
///
/// A kernel whose points are `Vec3` is viewed in place. Any other (float, Eigen) gets a temporary double property,
/// whose changed positions are written back when the lease ends, so untouched vertices keep their exact bits. Status
/// attributes are requested if missing and, if so, released again at the end unless elements are marked deleted
/// (releasing them then would resurrect the deleted elements).
///
/// The kernel's own traits and its type of points are made known to the policy's types, so that they travel and can be
/// recorded like any other property.
template <class Kernel>
class MeshLease {
  static_assert(
      is_triangle_kernel<Kernel>,
      "tri works on triangle meshes: use an OpenMesh::TriMesh_ArrayKernelT, or copy your polygon mesh into one and "
      "triangulate it (a TriMesh can be made from a PolyMesh by its constructor)");

 public:
  /// @param policy  what new elements inherit; must outlive the lease
  explicit MeshLease(Kernel& kernel, const PropertyPolicy& policy = PropertyPolicy::standard())
      : kernel_(kernel), policy_(policy), had_status_(kernel.has_vertex_status() && kernel.has_edge_status() &&
                                                      kernel.has_halfedge_status() && kernel.has_face_status()) {
    policy_.types() = PropertyTypes(&policy.types());
    add_types_of<Kernel>(policy_.types());
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

  /// With the position property of the kernel itself, or a temporary one that ends with the lease.
  MeshView view() { return {kernel_, position_, nullptr, nullptr, &policy_}; }
  /// So that a lease can be handed to an operator.
  operator MeshView() { return view(); }

  /// The type of the kernel's positions.
  using Point = typename Kernel::Point;
  /// True if the view is on the kernel's own positions, without a copy.
  static constexpr bool in_place = std::is_same_v<Point, Vec3>;

 private:
  using Scalar = std::remove_cvref_t<decltype(std::declval<Point&>()[0])>;

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
  PropertyPolicy policy_;
  bool had_status_;
  OpenMesh::VPropHandleT<Vec3> position_;
};

/// The view of the default kernel, which needs no lease.
inline MeshView view_of(Mesh& mesh) {
  return {mesh, mesh.points_property_handle()};
}

}  // namespace tri

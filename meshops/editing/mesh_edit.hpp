#pragma once

#include <array>
#include <span>
#include <string>

#include "meshops/editing/add_faces.hpp"
#include "meshops/editing/change_recorder.hpp"
#include "meshops/mesh_view.hpp"

/// The one place where an operator changes a mesh.
///
/// Operators change links, positions and existence of elements only through the functions below and `add_faces`, so
/// that properties travel along in one way and changes can be recorded (`record`). What they write themselves, to
/// properties or to status, they announce first: `about_to_set`, `property_to_fill`. All handles of elements that stay,
/// keep; elements that go are marked as deleted and never collected; new elements come at the end. What a new element
/// inherits:
///
/// * a vertex: the weighted mean of its sources' values where the type of the property is a floating-point number, a
///   vector of them or a colour, else the value of the source with the greatest weight;
/// * a face: all values of the face it is a piece of, or of a face beside it (`add_faces`);
/// * a half-edge: its corner values (properties "h:NAME", such as texture coordinates), which belong to the corner that
/// it
///   ends in, come from the corner at the same vertex in the face it is a piece of; at a new vertex they are the mean
///   of that face's corners;
/// * the two halves of a split edge: all values of the edge. Edges inside a face that is split have initial values.
///
/// The view's `PropertyPolicy` may say otherwise of any property. (The standard one does of `v:point_index`, which
/// becomes -1 at a new vertex, since it was not measured.)
///
/// The status of new elements is cleared, but pieces of an edge or a face keep its bits `selected`, `locked` and
/// `feature`. The functions check nothing: what they require is the caller's job. They allocate memory, and throw only
/// if there is none. One mesh is changed by one thread at a time; different meshes by different threads.
namespace tri {

/// A vertex from which a new one inherits, and its share; the shares sum to 1.
struct VertexSource {
  VertexHandle vertex;  ///< of the same mesh
  double weight = 1;    ///< in [0,1]
};

/// Gives a vertex another position.
void set_point(MeshView mesh, VertexHandle v, const Vec3& point);

/// Turns the edge of two triangles (a, b, c), (b, a, d) into the edge (c, d). The two corners that get new vertices
/// take over what corners there had in the triangle beyond.
/// @param edge  for which `is_flip_ok` is true: two triangles, whose other diagonal is no edge yet
void flip_edge(MeshView mesh, EdgeHandle edge);

/// Puts a new vertex onto an edge and joins it to the far corners of its one or two triangles.
///
/// The edge keeps its handle for the half at the end of its first half-edge; the other half, and the pieces beside it,
/// are new. (With a -> b the first half-edge, the edge becomes m -> b, and its triangles keep their handle at b.)
/// @param share  of the end of the first half-edge in the new vertex's values, 0 to 1: 0.5 in the middle
/// @return the new vertex
VertexHandle split_edge(MeshView mesh, EdgeHandle edge, const Vec3& point, double share);

/// Puts a new vertex into a triangle and joins it to its three corners. The face keeps its handle for the piece at its
/// first half-edge.
/// @param weights  of the corners, in the order of `fv_iter` (where the first half-edge ends, then its next), that sum
/// to 1
/// @return the new vertex
VertexHandle split_face(MeshView mesh, FaceHandle face, const Vec3& point, const std::array<double, 3>& weights);

/// Whether `collapse` leaves a manifold with the same topology: as OpenMesh's, but it writes nothing (OpenMesh's leaves
/// bits `tagged` behind), so it may be called while others read. A deleted half-edge is not.
bool is_collapse_ok(const OpenMesh::TriConnectivity& mesh, HalfedgeHandle h);

/// Pulls the vertex in which a half-edge begins into the one in which it ends: the vertex, the edge and its one or two
/// triangles are deleted, and of the two pairs of edges that fall together those of the end stay (and are a feature if
/// one of the two was). The end keeps its position and values (see `blend_vertex` and `blend_corners`). Corners of the
/// vertex that goes take over the values of the end's corners, on both sides of a seam; corners between two seams keep
/// their own.
/// @param h  for which `is_collapse_ok` is true
void collapse(MeshView mesh, HalfedgeHandle h);

/// Deletes a triangle and its edges that have no other. Vertices that are left without an edge stay, isolated.
void delete_face(MeshView mesh, FaceHandle face);

/// Deletes a vertex, and the faces around it if there are any; their other vertices stay.
void delete_vertex(MeshView mesh, VertexHandle v);

/// Adds an isolated vertex. @param sources  none: all values are initial ones
VertexHandle add_vertex(MeshView mesh, const Vec3& point, std::span<const VertexSource> sources = {});

/// Sets the values of a vertex, but for its position and status, from others (it may be one of them): before a collapse
/// to a place between two vertices, say.
void blend_vertex(MeshView mesh, VertexHandle v, std::span<const VertexSource> sources);

/// The same for the values of the corners at the end of a half-edge, before a collapse to a place along it: on either
/// side of it, as far as there is no seam, they become the mean of what the corners at its two ends have there.
/// @param share  of the end, 0 to 1
void blend_corners(MeshView mesh, HalfedgeHandle h, double share);

/// The property of this name and type, for an operator that writes to all of its values: added if there is none, kept
/// as a whole by a recording if there is. @tparam PropertyHandle  say OpenMesh::VPropHandleT<int>
template <class PropertyHandle>
PropertyHandle property_to_fill(MeshView mesh, const std::string& name) {
  PropertyHandle handle;
  if (!mesh.mesh.get_property_handle(handle, name))
    mesh.mesh.add_property(handle, name);
  else if (mesh.recorder)
    mesh.recorder->property(kind_of(handle), handle.idx());
  return handle;
}

/// Removes a property; the handle is invalid afterwards.
template <class PropertyHandle>
void remove_property(MeshView mesh, PropertyHandle& handle) {
  if (!handle.is_valid()) return;
  const ElementKind kind = kind_of(handle);
  if (mesh.recorder) mesh.recorder->remove_property(kind, handle.idx());
  if (property_slots(mesh.mesh, kind)[static_cast<std::size_t>(handle.idx())])
    mesh.mesh.remove_property(handle);
  else
    handle.reset();
}

/// Announces that values of a vertex's properties, or its status, are going to be written to.
void about_to_set(MeshView mesh, VertexHandle v);
/// The same of an edge.
void about_to_set(MeshView mesh, EdgeHandle e);
/// The same of the corner in which a half-edge ends.
void about_to_set(MeshView mesh, HalfedgeHandle h);
/// The same of a face.
void about_to_set(MeshView mesh, FaceHandle f);

/// Turns triangles over; corner values stay at their corners. All handles keep; half-edges change direction.
/// @param faces  each once, and with each all that are joined to it by edges
void reverse_faces(MeshView mesh, std::span<const FaceHandle> faces);

/// Runs a function that changes everything by other means (`compact`); a recording keeps the whole mesh.
template <class Function>
void change_all(MeshView mesh, const Function& function) {
  struct Scope {
    ChangeRecorder* recorder;
    explicit Scope(ChangeRecorder* r) : recorder(r) {
      if (recorder) recorder->begin_whole();
    }
    ~Scope() {
      if (recorder) recorder->end_whole();
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
  } scope(mesh.recorder);
  function();
}

}  // namespace tri

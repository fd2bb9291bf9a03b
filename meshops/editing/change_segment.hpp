#pragma once

#include <array>
#include <span>
#include <string>

#include "meshops/editing/change_notes.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// The kinds of elements that have properties; the mesh itself has one value of each.
enum class ElementKind { vertex, edge, halfedge, face, mesh };
/// All of them, to loop over.
inline constexpr std::array element_kinds{ElementKind::vertex, ElementKind::edge, ElementKind::halfedge,
                                          ElementKind::face, ElementKind::mesh};

/// The kind that a handle to a property of vertices is of.
template <class T>
ElementKind kind_of(OpenMesh::VPropHandleT<T>) {
  return ElementKind::vertex;
}
/// The kind that a handle to a property of edges is of.
template <class T>
ElementKind kind_of(OpenMesh::EPropHandleT<T>) {
  return ElementKind::edge;
}
/// The kind that a handle to a property of half-edges is of.
template <class T>
ElementKind kind_of(OpenMesh::HPropHandleT<T>) {
  return ElementKind::halfedge;
}
/// The kind that a handle to a property of faces is of.
template <class T>
ElementKind kind_of(OpenMesh::FPropHandleT<T>) {
  return ElementKind::face;
}
/// The kind that a handle to a property of the mesh itself is of.
template <class T>
ElementKind kind_of(OpenMesh::MPropHandleT<T>) {
  return ElementKind::mesh;
}

/// The properties of a kind by slot, the index in their handles; null where there is none.
std::span<OpenMesh::BaseProperty*> property_slots(OpenMesh::TriConnectivity& mesh, ElementKind kind);

/// A stretch of what was done to a mesh, that can be taken back and done again.
class ChangeSegment {
 public:
  virtual ~ChangeSegment() = default;

  /// Takes the change back. The mesh must be as the change left it.
  virtual void undo(OpenMesh::TriConnectivity& mesh) = 0;
  /// Does it again. The mesh must be as `undo` left it.
  virtual void redo(OpenMesh::TriConnectivity& mesh) = 0;
  /// Why the mesh is not as this left it the last time; empty if it is.
  virtual std::string mismatch(OpenMesh::TriConnectivity& mesh) const = 0;
  /// True if nothing was changed in this stretch.
  virtual bool empty() const = 0;
  /// Takes the change back for good, faster than `undo`; whether it is finished or not. Afterwards this is of no use.
  /// @throws InvalidInput if a property was removed without notice; the mesh is then untouched
  virtual void roll_back() = 0;
};

}  // namespace tri

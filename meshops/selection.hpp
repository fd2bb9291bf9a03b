#pragma once

#include <span>
#include <vector>

#include "meshops/mesh.hpp"

namespace tri {

/// The part of a mesh that an operator may change; a `MeshView` carries it (`view.selection`), and every mesh operator
/// keeps to it.
///
/// Faces of the selection may be deleted, replaced and flipped, its vertices moved; what is outside keeps handles,
/// corners, positions and values. A vertex is removed only if all faces around it may be replaced. An edge is changed
/// only if its one or two faces may be. Elements that an operator adds belong to the selection. Operators may look
/// beyond it (a vertex at its rim has neighbours outside), but the rim itself stays: to smooth or remesh up to a line,
/// select one ring of faces more.
///
/// Made for one mesh in one state: after elements were collected (`compact`) it has to be made anew.
class Selection {
 public:
  /// These faces, and the vertices all of whose faces are among them. A loop can be filled if each of its vertices is a
  /// corner of one of the faces.
  /// @param faces  in any order; twice is once
  /// @throws InvalidInput naming a handle that is not of this mesh, or deleted (this holds for all four).
  static Selection of_faces(const OpenMesh::TriConnectivity& mesh, std::span<const FaceHandle> faces);

  /// These vertices, and the faces all of whose corners are among them. A loop can be filled if all its vertices are.
  /// Note that faces outside change their shape where a vertex of theirs is moved.
  static Selection of_vertices(const OpenMesh::TriConnectivity& mesh, std::span<const VertexHandle> vertices);

  /// No face and no vertex, but the boundary loops through these half-edges.
  /// @throws InvalidInput also for a half-edge that has a face.
  static Selection of_loops(const OpenMesh::TriConnectivity& mesh, std::span<const HalfedgeHandle> halfedges);

  /// What the status bit `selected` of the mesh says: its faces, or where no face has it its vertices, or where no
  /// vertex has it the loops of its boundary edges. All empty: an empty selection.
  /// @throws InvalidInput if the mesh has no status attributes.
  static Selection of_status(const OpenMesh::TriConnectivity& mesh);

  /// A face that may be deleted, replaced or turned over; every face added since the selection was made.
  bool may_replace(FaceHandle f) const { return contains(faces_, f); }
  /// A vertex that may get another position; every vertex added since.
  bool may_move(VertexHandle v) const { return contains(vertices_, v); }
  /// @param loop  half-edges of a boundary loop
  /// A boundary loop that may be closed by new faces.
  bool may_fill(const OpenMesh::TriConnectivity& mesh, std::span<const HalfedgeHandle> loop) const;

 private:
  explicit Selection(const OpenMesh::TriConnectivity& mesh);

  /// What comes after the elements the selection was made for was added under it, and belongs to it.
  static bool contains(const std::vector<char>& chosen, OpenMesh::BaseHandle handle) {
    const auto i = static_cast<std::size_t>(handle.idx());
    return i >= chosen.size() || chosen[i];
  }

  std::vector<char> faces_;       ///< that may be replaced
  std::vector<char> vertices_;    ///< that may be moved
  std::vector<char> rim_;         ///< vertices between which loops may be filled
  std::vector<char> loop_edges_;  ///< edges of chosen loops; empty if the rim decides
};

}  // namespace tri

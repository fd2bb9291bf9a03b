#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// Corners of a triangle of a mesh, counter-clockwise seen from its front.
using VertexTriple = std::array<VertexHandle, 3>;

/// Whether a batch of triangles fits into a mesh.
enum class FitResult {
  fits,
  degenerate,           ///< a triangle with a repeated, invalid or deleted corner
  edge_in_use,          ///< a directed edge that has a face already, in the mesh or in the batch
  vertex_not_manifold,  ///< a vertex would get more fans of faces than it had (or than one)
};

/// The result in words, for reports: "edge in use".
std::string_view to_string(FitResult result);

/// Checks a batch without changing the mesh; what a vertex looks like is judged after the whole batch.
/// @param context  null: cannot be cancelled
/// @throws Cancelled
FitResult check_faces(MeshView mesh, std::span<const VertexTriple> triangles, const Context* context = nullptr);

/// Adds all triangles of the batch, or none if they do not fit.
///
/// Unlike OpenMesh's `add_face`, which looks at one face at a time, the order of the triangles does not matter, an edge
/// between two new faces is no obstacle, and a vertex may be a bow-tie in between. Existing handles keep. A new face
/// gets the properties of a face beside it (of the mesh; else of a new one that has such) with its status cleared, its
/// corners the values of the nearest corner at the same vertex, counted in faces around it. What no face of the mesh is
/// joined to, and new edges, get initial values. The view's policy may say otherwise of any property of faces.
/// @param added  the new faces are appended in the order of the batch; may be null.
/// @param context  null: cannot be cancelled; else only for a mesh that is recorded and rolled back, for a large batch
/// @throws Cancelled; the faces are then half linked
FitResult add_faces(MeshView mesh, std::span<const VertexTriple> triangles, std::vector<FaceHandle>* added = nullptr,
                    const Context* context = nullptr);

}  // namespace tri

#pragma once

#include <cstddef>
#include <span>

#include "editor_mesh.hpp"

namespace editor {

/// The selection is the status bit of the faces; deleted faces are never in it.

std::size_t count_selected(const EditorMesh& mesh);

enum class SelectMode { replace, add, remove };
void select_faces(EditorMesh& mesh, std::span<const OpenMesh::FaceHandle> faces, SelectMode mode);

void select_all(EditorMesh& mesh);
void select_none(EditorMesh& mesh);
void invert_selection(EditorMesh& mesh);
/// Adds the faces that share a vertex with a selected one.
void grow_selection(EditorMesh& mesh);
/// Adds all faces that are joined to a selected one by edges.
void select_components(EditorMesh& mesh);

}  // namespace editor

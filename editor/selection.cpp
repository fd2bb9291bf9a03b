#include "selection.hpp"

#include <vector>

namespace editor {
namespace {

template <class Action>
void for_each_face(const EditorMesh& mesh, const Action& action) {
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) {
    const OpenMesh::FaceHandle f(static_cast<int>(i));
    if (!mesh.status(f).deleted()) action(f);
  }
}

}  // namespace

std::size_t count_selected(const EditorMesh& mesh) {
  std::size_t count = 0;
  for_each_face(mesh, [&](OpenMesh::FaceHandle f) { count += mesh.status(f).selected(); });
  return count;
}

void select_faces(EditorMesh& mesh, std::span<const OpenMesh::FaceHandle> faces, SelectMode mode) {
  if (mode == SelectMode::replace) select_none(mesh);
  for (const OpenMesh::FaceHandle f : faces)
    if (!mesh.status(f).deleted()) mesh.status(f).set_selected(mode != SelectMode::remove);
}

void select_all(EditorMesh& mesh) {
  for_each_face(mesh, [&](OpenMesh::FaceHandle f) { mesh.status(f).set_selected(true); });
}

void select_none(EditorMesh& mesh) {
  for_each_face(mesh, [&](OpenMesh::FaceHandle f) { mesh.status(f).set_selected(false); });
}

void invert_selection(EditorMesh& mesh) {
  for_each_face(mesh, [&](OpenMesh::FaceHandle f) { mesh.status(f).set_selected(!mesh.status(f).selected()); });
}

void grow_selection(EditorMesh& mesh) {
  std::vector<char> near(mesh.n_vertices(), 0);
  for_each_face(mesh, [&](OpenMesh::FaceHandle f) {
    if (!mesh.status(f).selected()) return;
    for (auto v = mesh.cfv_iter(f); v.is_valid(); ++v) near[static_cast<std::size_t>(v->idx())] = 1;
  });
  for_each_face(mesh, [&](OpenMesh::FaceHandle f) {
    for (auto v = mesh.cfv_iter(f); v.is_valid(); ++v)
      if (near[static_cast<std::size_t>(v->idx())]) mesh.status(f).set_selected(true);
  });
}

void select_components(EditorMesh& mesh) {
  std::vector<OpenMesh::FaceHandle> front;
  for_each_face(mesh, [&](OpenMesh::FaceHandle f) {
    if (mesh.status(f).selected()) front.push_back(f);
  });
  while (!front.empty()) {
    const OpenMesh::FaceHandle f = front.back();
    front.pop_back();
    for (auto beside = mesh.cff_iter(f); beside.is_valid(); ++beside) {
      if (mesh.status(*beside).selected()) continue;
      mesh.status(*beside).set_selected(true);
      front.push_back(*beside);
    }
  }
}

}  // namespace editor

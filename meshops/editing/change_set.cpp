#include "meshops/editing/change_set.hpp"

#include <fmt/format.h>

#include "meshops/error.hpp"

namespace tri {

bool ChangeNotes::empty() const {
  return vertices.empty() && edges.empty() && faces.empty() && vertices_moved.empty() && !renumbered &&
         properties_added.empty() && properties_removed.empty() && properties_rewritten.empty();
}

ChangeNotes ChangeNotes::inverse() const {
  ChangeNotes result = *this;
  for (ElementNotes* n : {&result.vertices, &result.edges, &result.faces}) n->added.swap(n->removed);
  result.properties_added.swap(result.properties_removed);
  return result;
}

ChangeSet::ChangeSet(OpenMesh::TriConnectivity& mesh, std::vector<std::unique_ptr<ChangeSegment>> segments,
                     ChangeNotes notes)
    : mesh_(&mesh), segments_(std::move(segments)), notes_(std::move(notes)) {}

void ChangeSet::check(OpenMesh::TriConnectivity& mesh, bool undo) const {
  const char* const verb = undo ? "undo" : "redo";
  if (undone_ == undo)
    throw InvalidInput(fmt::format("cannot {}: the change is {}undone", verb, undo ? "already " : "not "));
  if (mesh_ && &mesh != mesh_)
    throw InvalidInput(fmt::format("cannot {}: the change was recorded on another mesh", verb));
  if (segments_.empty()) return;
  const std::string why = (undo ? segments_.back() : segments_.front())->mismatch(mesh);
  if (!why.empty()) throw InvalidInput(fmt::format("cannot {}: {}", verb, why));
}

void ChangeSet::undo(OpenMesh::TriConnectivity& mesh) {
  check(mesh, true);
  for (auto it = segments_.rbegin(); it != segments_.rend(); ++it) (*it)->undo(mesh);
  undone_ = true;
}

void ChangeSet::redo(OpenMesh::TriConnectivity& mesh) {
  check(mesh, false);
  for (const auto& segment : segments_) segment->redo(mesh);
  undone_ = false;
}

}  // namespace tri

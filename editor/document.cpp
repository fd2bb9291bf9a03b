#include "document.hpp"

#include <tri/io/mesh_file.hpp>
#include <tri/meshops/build_mesh.hpp>
#include <tri/meshops/selection.hpp>
#include <tri/meshops/to_kernel.hpp>
#include <utility>

namespace editor {

Document::Document() {
  mesh_.request_face_status();
  OpenMesh::FPropHandleT<int> brush;
  mesh_.add_property(brush, brush_property);
}

std::vector<std::string> Document::open(const std::string& path, tri::Context& context) {
  tri::MeshFileInfo info;
  const tri::Soup soup = tri::read_mesh(path, context, &info);
  const tri::BuiltMesh built = tri::build_mesh(soup, context);
  context.checkpoint();
  // From here on nothing fails: the library's kernel becomes the editor's.
  tri::to_kernel(built.mesh, mesh_);
  path_ = path;
  history_.clear();
  done_ = saved_at_ = 0;
  all_stale_ = true;
  std::vector<std::string> notes = std::move(info.notes);
  notes.insert(notes.end(), built.report.notes.begin(), built.report.notes.end());
  return notes;
}

std::vector<std::string> Document::save(const std::string& path, tri::Context& context) {
  tri::MeshLease lease(mesh_);
  const tri::MeshWriteReport written = tri::write_mesh(path, lease.view(), {}, context);
  path_ = path;
  saved_at_ = done_;
  return written.notes;
}

tri::Report Document::run(const OperatorRequest& request, tri::Context& context) {
  std::optional<tri::Selection> selection;
  if (request.selection_only) selection = tri::Selection::of_status(mesh_);
  const auto work = [&](tri::MeshView view) {
    return request.op->run(selection ? view.with(*selection) : view, request.options.get(), context);
  };
  if (request.dry_run) {
    const tri::ChangeSet would = tri::dry_run(mesh_, work, context);
    return would.reports().front();
  }
  tri::ChangeSet change = tri::record(mesh_, work, context);
  const tri::Report report = change.reports().front();
  if (change.empty()) return report;
  mark_stale(change);
  history_.erase(history_.begin() + static_cast<std::ptrdiff_t>(done_), history_.end());
  if (saved_at_ > done_) saved_at_ = static_cast<std::size_t>(-1);  // what was saved cannot be reached any more
  history_.push_back({request.op->name() + (selection ? " (selection)" : ""), std::move(change)});
  ++done_;
  return report;
}

void Document::undo() {
  tri::ChangeSet& change = history_[done_ - 1].change;
  change.undo(mesh_);
  --done_;
  mark_stale(change);
}

void Document::redo() {
  tri::ChangeSet& change = history_[done_].change;
  change.redo(mesh_);
  ++done_;
  mark_stale(change);
}

void Document::mark_stale(const tri::ChangeSet& change) {
  const tri::ChangeNotes& notes = change.notes();
  if (notes.renumbered) all_stale_ = true;
  if (all_stale_) return;
  const auto add = [&](const std::vector<std::uint32_t>& faces) {
    for (const std::uint32_t f : faces) stale_.emplace_back(static_cast<int>(f));
  };
  add(notes.faces.added);
  add(notes.faces.removed);
  add(notes.faces.relinked);
  for (const std::uint32_t i : notes.vertices_moved) {
    const OpenMesh::VertexHandle v(static_cast<int>(i));
    for (auto f = mesh_.cvf_iter(v); f.is_valid(); ++f) stale_.push_back(*f);
  }
}

std::optional<std::vector<OpenMesh::FaceHandle>> Document::take_stale_faces() {
  std::vector<OpenMesh::FaceHandle> stale = std::exchange(stale_, {});
  if (std::exchange(all_stale_, false)) return std::nullopt;
  return stale;
}

}  // namespace editor

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <tri/meshops/context.hpp>
#include <tri/meshops/editing/change_set.hpp>
#include <tri/meshops/report.hpp>
#include <vector>

#include "editor_mesh.hpp"
#include "operator_panel.hpp"

namespace editor {

/// The mesh, its file, and what was done to it.
///
/// Everything here may run on the thread of a job, but only one thing at a time.
class Document {
 public:
  Document();

  EditorMesh& mesh() { return mesh_; }
  const EditorMesh& mesh() const { return mesh_; }
  const std::string& path() const { return path_; }
  bool modified() const { return saved_at_ != done_; }

  /// Replaces mesh and history. @return what had to be changed to hold the file in half-edges
  /// @throws what `read_mesh` and `build_mesh` throw; the document is then as it was.
  std::vector<std::string> open(const std::string& path, tri::Context& context);
  /// @return what the format could not hold. @throws what `write_mesh` throws.
  std::vector<std::string> save(const std::string& path, tri::Context& context);

  /// Runs an operator, and keeps what it takes to undo it, unless this is a dry run.
  /// @throws what the operator throws, and Cancelled: the mesh is then as it was.
  tri::Report run(const OperatorRequest& request, tri::Context& context);

  bool can_undo() const { return done_ > 0; }
  bool can_redo() const { return done_ < history_.size(); }
  void undo();
  void redo();

  /// One line for each step, the oldest first; the first `steps_done()` are in effect.
  struct Step {
    std::string title;
    tri::ChangeSet change;
  };
  const std::vector<Step>& history() const { return history_; }
  std::size_t steps_done() const { return done_; }

  /// The faces that are to be drawn anew since the last call; nullopt for all of them.
  std::optional<std::vector<OpenMesh::FaceHandle>> take_stale_faces();

 private:
  void mark_stale(const tri::ChangeSet& change);

  EditorMesh mesh_;
  std::string path_;
  std::vector<Step> history_;
  std::size_t done_ = 0, saved_at_ = 0;
  bool all_stale_ = true;
  std::vector<OpenMesh::FaceHandle> stale_;
};

}  // namespace editor

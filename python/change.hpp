#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <vector>

#include "meshops/editing/change_set.hpp"
#include "python/held.hpp"

namespace tri::python {

/// What operators did to a mesh while it was recorded: one change set each, to be taken back and done again together.
class Change {
 public:
  explicit Change(std::shared_ptr<HeldMesh> mesh) : mesh_(std::move(mesh)) {}

  void add(ChangeSet done) { done_.push_back(std::move(done)); }
  /// Takes all of it back, last first. @throws InvalidInput if it is undone, or the mesh was changed since; the mesh is
  /// then as it was before the call
  void undo();
  void redo();
  bool undone() const { return undone_; }
  bool empty() const;
  /// Of all operators together: an element that one added and a later one removed is in no list.
  ChangeNotes notes() const;
  const std::vector<ChangeSet>& parts() const { return done_; }
  HeldMesh& mesh() const { return *mesh_; }

 private:
  std::shared_ptr<HeldMesh> mesh_;
  std::vector<ChangeSet> done_;
  bool undone_ = false;
};

/// The method `record` of a mesh.
void add_recording(pybind11::class_<HeldMesh, std::shared_ptr<HeldMesh>>& type);

}  // namespace tri::python

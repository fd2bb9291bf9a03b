#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/editing/change_recorder.hpp"
#include "meshops/report.hpp"

namespace tri {

/// What operators did to a mesh, to be undone and done again: links, positions, status and all properties, bit for bit,
/// with the same handles in the same order. An undo takes elements that were added away from the end; a redo brings
/// them back.
///
///     ChangeSet change = record(mesh, fill_holes, {.max_edges = 50}, context);
///     upload(change.notes());
///     change.undo(mesh);
///     change.redo(mesh);
///
/// Several on a stack are undone last first. Undo and redo cost what changed, not what the mesh has; only `compact` and
/// properties of unknown types (see ChangeRecorder) cost the whole mesh. It belongs to one mesh, at one address, which
/// must outlive every call; otherwise nothing is shared, so change sets of different meshes may be used on different
/// threads.
///
/// Between the operators and an undo (or an undo and a redo), an editor may change values of properties, select, and
/// add properties; the undo gives touched elements the values and the selection that they had. It must not move, delete
/// or link touched elements, add or remove elements, or remove properties that hold kept values: undo and redo refuse
/// that.
///
/// A property that was added by an operator is taken out by an undo, so handles to it are invalid until a redo. A
/// property that was rewritten as a whole, or is of unknown type, may be another object afterwards, with the same
/// handle.
class ChangeSet {
 public:
  /// Of no mesh; it changed nothing.
  ChangeSet() = default;
  /// Made by ChangeRecorder::finish. @param segments  in the order in which they were done @param notes  what they
  /// changed
  ChangeSet(OpenMesh::TriConnectivity& mesh, std::vector<std::unique_ptr<ChangeSegment>> segments, ChangeNotes notes);
  /// Leaves the other one of no use: it changed nothing.
  ChangeSet(ChangeSet&&) = default;
  /// What it kept before is forgotten, and can no longer be undone.
  ChangeSet& operator=(ChangeSet&&) = default;

  /// Takes the change back. @throws InvalidInput if it is undone already, or the mesh is another one or was changed
  /// since (naming what); the
  ///   mesh is then untouched
  void undo(OpenMesh::TriConnectivity& mesh);
  /// The same on the mesh of a view.
  void undo(MeshView mesh) { undo(mesh.mesh); }
  /// Does it again. @throws InvalidInput if it is not undone, and as above
  void redo(OpenMesh::TriConnectivity& mesh);
  /// The same on the mesh of a view.
  void redo(MeshView mesh) { redo(mesh.mesh); }

  /// True if the operators wrote nothing at all: the mesh is bit for bit as it was. (It may be as well if this is
  /// false.)
  bool empty() const { return segments_.empty(); }
  /// True after an undo, false after a redo.
  bool undone() const { return undone_; }

  /// What the operators changed (and a redo changes; an undo changes `notes().inverse()`).
  const ChangeNotes& notes() const { return notes_; }

  /// What the operators reported, in their order.
  const std::vector<Report>& reports() const { return reports_; }
  /// Appends what an operator reported, for `reports`.
  void add_report(Report report) { reports_.push_back(std::move(report)); }

 private:
  void check(OpenMesh::TriConnectivity& mesh, bool undo) const;

  OpenMesh::TriConnectivity* mesh_ = nullptr;
  std::vector<std::unique_ptr<ChangeSegment>> segments_;
  ChangeNotes notes_;
  std::vector<Report> reports_;
  bool undone_ = false;
};

/// Requests the status attributes that a recording needs. They stay.
template <class Kernel>
void request_status(Kernel& mesh) {
  if (!mesh.has_vertex_status()) mesh.request_vertex_status();
  if (!mesh.has_edge_status()) mesh.request_edge_status();
  if (!mesh.has_halfedge_status()) mesh.request_halfedge_status();
  if (!mesh.has_face_status()) mesh.request_face_status();
}

/// Runs a function on a mesh and records what it changes.
/// @param function  is called with the MeshView to work on; may return a Report or several, which the change set keeps
/// @throws what the function throws, Cancelled among it; the mesh is then as it was, bit for bit (with `notes_only`: as
/// the
///   function left it). InvalidInput if the mesh of a view has no status attributes.
///
/// After a function that changed much, sorting out what it changed takes a while as well (a quarter of a second for two
/// million faces); with a context that can be cancelled too.
/// @param context  that the function is run with; null: only the function itself can be cancelled
template <std::invocable<MeshView> Function>
ChangeSet record(MeshView mesh, const Function& function, Recording recording = Recording::undoable,
                 const Context* context = nullptr);

/// The same on any OpenMesh triangle kernel, for which it opens a view. Status attributes that the kernel does not have
/// are requested and stay. Positions other than Vec3 are compared with those of the view, which costs the whole mesh.
/// @param policy  what new elements inherit
template <class Kernel, std::invocable<MeshView> Function>
requires(!std::same_as<Kernel, MeshView>) ChangeSet
    record(Kernel& mesh, const Function& function, Recording recording = Recording::undoable,
           const PropertyPolicy& policy = PropertyPolicy::standard(), const Context* context = nullptr);

/// The same with a context, the function's own, so that a cancel is heeded after the function, too:
/// `record(mesh, [&](MeshView view) { return smooth(view, {}, context); }, context)`.
template <class Mesh, std::invocable<MeshView> Function>
ChangeSet record(Mesh&& mesh, const Function& function, const Context& context) {
  if constexpr (requires { mesh.mesh; })
    return record(mesh, function, Recording::undoable, &context);
  else
    return record(mesh, function, Recording::undoable, PropertyPolicy::standard(), &context);
}

/// Runs an operator and records what it changes: `record(mesh, fill_holes, {.max_edges = 50}, context)`.
template <class Mesh, class Options>
ChangeSet record(Mesh&& mesh, Report (*op)(MeshView, const Options&, Context&),
                 const std::type_identity_t<Options>& options, Context& context) {
  return record(
      mesh, [&](MeshView view) { return op(view, options, context); }, context);
}

/// Runs a function that works on a mesh and takes it back: what it would report and touch. Costs the function's own
/// time and memory for what it changes, twice over for what is undone; the mesh is changed in between, so nobody may
/// read it meanwhile. Works for every operator, and for a whole pipeline.
/// @param context  the function's own, so that a cancel is heeded after the function, too
/// @return the change, already undone: `reports()` and `notes()` are what one is after, `redo` does it without
/// computing
///   it again
template <class Mesh, std::invocable<MeshView> Function>
ChangeSet dry_run(Mesh&& mesh, const Function& function, const Context& context) {
  ChangeSet change = record(mesh, function, context);
  if constexpr (requires { mesh.mesh; })
    change.undo(mesh.mesh);
  else
    change.undo(mesh);
  return change;
}
/// The same, where nobody cancels.
template <class Mesh, std::invocable<MeshView> Function>
ChangeSet dry_run(Mesh&& mesh, const Function& function) {
  const Context nobody_cancels;
  return dry_run(mesh, function, nobody_cancels);
}
/// The same for an operator: `dry_run(mesh, fill_holes, {.max_edges = 50}, context)`.
template <class Mesh, class Options>
ChangeSet dry_run(Mesh&& mesh, Report (*op)(MeshView, const Options&, Context&),
                  const std::type_identity_t<Options>& options, Context& context) {
  return dry_run(
      mesh, [&](MeshView view) { return op(view, options, context); }, context);
}

namespace change_set_detail {

using Reports = std::vector<Report>;

template <class Function>
Reports run(const Function& function, MeshView view) {
  using Result = std::invoke_result_t<const Function&, MeshView>;
  Reports reports;
  if constexpr (std::is_same_v<Result, Reports>)
    reports = function(view);
  else if constexpr (std::is_same_v<Result, Report>)
    reports.push_back(function(view));
  else
    function(view);
  return reports;
}

inline ChangeSet finished(ChangeRecorder& recorder, Reports reports, const Context* context) {
  ChangeSet change = recorder.finish(context);
  for (Report& r : reports) change.add_report(std::move(r));
  return change;
}

}  // namespace change_set_detail

template <std::invocable<MeshView> Function>
ChangeSet record(MeshView mesh, const Function& function, Recording recording, const Context* context) {
  ChangeRecorder recorder(mesh, recording);
  try {
    auto reports = change_set_detail::run(function, recorder.view());
    return change_set_detail::finished(recorder, std::move(reports), context);
  } catch (...) {
    if (recording == Recording::undoable) recorder.roll_back();
    throw;
  }
}

template <class Kernel, std::invocable<MeshView> Function>
requires(!std::same_as<Kernel, MeshView>) ChangeSet record(Kernel& mesh, const Function& function, Recording recording,
                                                           const PropertyPolicy& policy, const Context* context) {
  static_assert(is_triangle_kernel<Kernel>, "tri records changes of OpenMesh triangle meshes (TriMesh_ArrayKernelT)");
  request_status(mesh);
  std::unique_ptr<ChangeRecorder> recorder;
  try {
    change_set_detail::Reports reports;
    {
      MeshLease<Kernel> lease(mesh, policy);
      // Made while the lease is open, finished when the lease has written the positions back.
      recorder = std::make_unique<ChangeRecorder>(lease.view(), recording, !MeshLease<Kernel>::in_place);
      reports = change_set_detail::run(function, recorder->view());
    }
    return change_set_detail::finished(*recorder, std::move(reports), context);
  } catch (...) {
    if (recorder && recording == Recording::undoable) recorder->roll_back();
    throw;
  }
}

}  // namespace tri

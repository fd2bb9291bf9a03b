#pragma once

#include <memory>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/editing/change_segment.hpp"

namespace tri {

class ChangeSet;
class DeltaSegment;
class WholeSegment;

/// What a recording keeps.
enum class Recording {
  undoable,    ///< what is needed to undo: of each touched element its links, position, status and properties, once
  notes_only,  ///< what changed, without the values of properties
};

/// Keeps what the functions of mesh_edit are about to change, from the time it is made until `finish`, for whoever
/// works through its `view`. Costs nothing where nothing changes, and memory in proportion to what does.
///
/// Properties whose type is known to the view's policy are kept value by value. A property of any other type is copied
/// as a whole when the first of its values is about to change, and when an undo takes elements away: O(elements) each.
///
/// A recording inside another is told to both.
class ChangeRecorder {
 public:
  /// @param mesh  must have status attributes (see `record`); if it is recorded already, the recording goes on
  /// @param temporary_positions  the position property is not part of the mesh: it belongs to a lease that ends before
  ///   `finish`, and whose mesh has positions of its own
  explicit ChangeRecorder(MeshView mesh, Recording recording = Recording::undoable, bool temporary_positions = false);
  ~ChangeRecorder();
  ChangeRecorder(const ChangeRecorder&) = delete;
  ChangeRecorder& operator=(const ChangeRecorder&) = delete;

  /// The mesh, for operators whose changes are to be recorded.
  MeshView view() const { return view_; }

  /// The change since the recording began; then it is over. The mesh must be as the operators left it.
  /// @param context  null: cannot be cancelled
  /// @throws Cancelled; `roll_back` is still possible
  ChangeSet finish(const Context* context = nullptr);
  /// Takes everything back since the recording began; then it is over. Costs less than `finish` and an undo.
  /// @throws InvalidInput if a property was removed other than by `remove_property` of mesh_edit
  void roll_back();

  // What mesh_edit announces. Whoever writes to a mesh by other means must announce it too, before it happens; elements
  // that are new since the recording began need not be, but may.
  void links(VertexHandle v);                        ///< its outgoing half-edge
  void links(EdgeHandle e);                          ///< any link of its half-edges
  void links(FaceHandle f);                          ///< its half-edge, or which corners it has
  void point(VertexHandle v);                        ///< its position
  void status(VertexHandle v);                       ///< its status bits
  void status(EdgeHandle e);                         ///< and of its half-edges
  void status(FaceHandle f);                         ///< its status bits
  void values(ElementKind kind, int index);          ///< its properties, but for position and status
  void corner(HalfedgeHandle h);                     ///< its corner values
  void property(ElementKind kind, int slot);         ///< a property as a whole
  void remove_property(ElementKind kind, int slot);  ///< takes it out of the mesh
  void begin_whole();                                ///< everything, until `end_whole`
  void end_whole();                                  ///< the change of everything is complete

 private:
  DeltaSegment& delta() { return *delta_; }
  void begin_delta();

  MeshView view_;
  ChangeRecorder* const parent_;
  const bool keep_values_;
  const int temporary_;
  std::vector<std::unique_ptr<ChangeSegment>> segments_;
  std::unique_ptr<DeltaSegment> delta_;
  std::unique_ptr<WholeSegment> whole_;
};

}  // namespace tri

#include "meshops/editing/change_recorder.hpp"

#include "meshops/editing/change_set.hpp"
#include "meshops/editing/recorded_segments.hpp"
#include "meshops/error.hpp"

namespace tri {

ChangeRecorder::ChangeRecorder(MeshView mesh, Recording recording, bool temporary_positions)
    : view_(mesh), parent_(mesh.recorder), keep_values_(recording == Recording::undoable),
      temporary_(temporary_positions ? mesh.position_property.idx() : -1) {
  const auto& m = mesh.mesh;
  if (!m.has_vertex_status() || !m.has_edge_status() || !m.has_halfedge_status() || !m.has_face_status())
    throw InvalidInput("a mesh is recorded only with the status attributes of all elements; request them first");
  view_.recorder = this;
  begin_delta();
}

ChangeRecorder::~ChangeRecorder() = default;

void ChangeRecorder::begin_delta() {
  delta_ = std::make_unique<DeltaSegment>(view_.mesh, view_.policy->types(), view_.position_property.idx(), temporary_,
                                          keep_values_);
}

ChangeSet ChangeRecorder::finish(const Context* context) {
  delta_->finish(context);
  ChangeNotes notes;
  notes.renumbered = !segments_.empty();  // only a change of everything divides a recording
  if (segments_.empty() && !delta_->empty()) delta_->describe(notes, context);
  if (!delta_->empty()) segments_.push_back(std::move(delta_));
  delta_.reset();
  return ChangeSet(view_.mesh, std::move(segments_), std::move(notes));
}

void ChangeRecorder::roll_back() {
  if (whole_) {
    whole_->roll_back();
  } else if (delta_) {
    delta_->roll_back();
  }
  for (auto it = segments_.rbegin(); it != segments_.rend(); ++it) (*it)->roll_back();
  whole_.reset();
  delta_.reset();
  segments_.clear();
}

void ChangeRecorder::links(VertexHandle v) {
  if (parent_) parent_->links(v);
  if (delta_) delta_->links(v);
}
void ChangeRecorder::links(EdgeHandle e) {
  if (parent_) parent_->links(e);
  if (delta_) delta_->links(e);
}
void ChangeRecorder::links(FaceHandle f) {
  if (parent_) parent_->links(f);
  if (delta_) delta_->links(f);
}
void ChangeRecorder::point(VertexHandle v) {
  if (parent_) parent_->point(v);
  if (delta_) delta_->point(v);
}
void ChangeRecorder::status(VertexHandle v) {
  if (parent_) parent_->status(v);
  if (delta_) delta_->status(ElementKind::vertex, v.idx());
}
void ChangeRecorder::status(EdgeHandle e) {
  if (parent_) parent_->status(e);
  if (!delta_) return;
  delta_->status(ElementKind::edge, e.idx());
  delta_->status(ElementKind::halfedge, 2 * e.idx());
  delta_->status(ElementKind::halfedge, 2 * e.idx() + 1);
}
void ChangeRecorder::status(FaceHandle f) {
  if (parent_) parent_->status(f);
  if (delta_) delta_->status(ElementKind::face, f.idx());
}
void ChangeRecorder::values(ElementKind kind, int index) {
  if (parent_) parent_->values(kind, index);
  if (delta_) delta_->values(kind, index);
}
void ChangeRecorder::corner(HalfedgeHandle h) {
  if (parent_) parent_->corner(h);
  if (delta_) delta_->corner(h);
}
void ChangeRecorder::property(ElementKind kind, int slot) {
  if (parent_) parent_->property(kind, slot);
  if (delta_) delta_->property(kind, slot);
}

void ChangeRecorder::remove_property(ElementKind kind, int slot) {
  // The outermost keeps the property itself, the others a copy of it.
  if (delta_) {
    if (parent_) {
      auto& place = property_slots(view_.mesh, kind)[static_cast<std::size_t>(slot)];
      OpenMesh::BaseProperty* const original = place;
      place = original->clone();
      delta_->remove_property(kind, slot);
      delete std::exchange(place, original);
    } else {
      delta_->remove_property(kind, slot);
    }
  }
  if (parent_) parent_->remove_property(kind, slot);
}

void ChangeRecorder::begin_whole() {
  if (parent_) parent_->begin_whole();
  delta_->finish(nullptr);
  if (!delta_->empty()) segments_.push_back(std::move(delta_));
  delta_.reset();
  whole_ = std::make_unique<WholeSegment>(view_.mesh, temporary_, keep_values_);
}

void ChangeRecorder::end_whole() {
  if (parent_) parent_->end_whole();
  whole_->finish();
  segments_.push_back(std::move(whole_));
  begin_delta();
}

}  // namespace tri

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "meshops/editing/recorded_segments.hpp"
#include "meshops/editing/segment_records.hpp"

namespace tri {

using namespace segment_records;

namespace {

using Connectivity = OpenMesh::TriConnectivity;

/// All records of a kind, which OpenMesh keeps in one array.
template <class Record>
void copy_records(Connectivity& mesh, std::size_t count, std::vector<Record>& records) {
  if (count == 0) return;
  const Record* const first = &record_at<Record>(mesh, 0);
  records.assign(first, first + count);
}
template <class Record>
void put_records(Connectivity& mesh, const std::vector<Record>& records) {
  if (!records.empty()) std::copy(records.begin(), records.end(), &record_at<Record>(mesh, 0));
}

}  // namespace

WholeSegment::WholeSegment(Connectivity& mesh, int temporary, bool keep)
    : mesh_(mesh), temporary_(temporary), keep_(keep), other_(ElementCounts::of(mesh)) {
  if (!keep) return;
  std::vector<std::function<void()>> tasks{[&] { copy_records(mesh, other_.vertices, vertices_); },
                                           [&] { copy_records(mesh, other_.edges, edges_); },
                                           [&] { copy_records(mesh, other_.faces, faces_); }};
  for (const ElementKind kind : element_kinds) {
    const auto slots = property_slots(mesh, kind);
    for (int slot = 0; slot < static_cast<int>(slots.size()); ++slot) {
      const OpenMesh::BaseProperty* property = slots[static_cast<std::size_t>(slot)];
      if (!property || (kind == ElementKind::vertex && slot == temporary_)) continue;
      properties_.push_back({kind, slot, property->name(), nullptr});
    }
  }
  for (Property& p : properties_)
    tasks.push_back(
        [&p, &mesh] { p.object.reset(property_slots(mesh, p.kind)[static_cast<std::size_t>(p.slot)]->clone()); });
  run_all(tasks, nullptr);
}

void WholeSegment::finish() {
  left_ = fingerprint();
}

void WholeSegment::undo(Connectivity&) {
  exchange();
}

void WholeSegment::redo(Connectivity&) {
  exchange();
}

void WholeSegment::exchange() {
  const ElementCounts now = ElementCounts::of(mesh_);
  decltype(vertices_) vertices;
  decltype(edges_) edges;
  decltype(faces_) faces;
  copy_records(mesh_, now.vertices, vertices);
  copy_records(mesh_, now.edges, edges);
  copy_records(mesh_, now.faces, faces);
  for (Property& p : properties_) {
    auto& place = property_slots(mesh_, p.kind)[static_cast<std::size_t>(p.slot)];
    p.object.reset(std::exchange(place, p.object.release()));
  }
  mesh_.resize(other_.vertices, other_.edges, other_.faces);
  put_records(mesh_, vertices_);
  put_records(mesh_, edges_);
  put_records(mesh_, faces_);
  vertices_.swap(vertices);
  edges_.swap(edges);
  faces_.swap(faces);
  other_ = now;
  left_ = fingerprint();
}

std::uint64_t WholeSegment::fingerprint() const {
  const ElementCounts now = ElementCounts::of(mesh_);
  std::uint64_t sum = 0;
  mix_range(sum, 0, now.vertices, nullptr, [&](std::uint64_t& part, std::size_t i) {
    mix_record(part, record_at<OpenMesh::ArrayItems::Vertex>(mesh_, i));
  });
  mix_range(sum, 0, now.edges, nullptr, [&](std::uint64_t& part, std::size_t i) {
    mix_record(part, record_at<OpenMesh::ArrayItems::Edge>(mesh_, i));
  });
  mix_range(sum, 0, now.faces, nullptr, [&](std::uint64_t& part, std::size_t i) {
    mix_record(part, record_at<OpenMesh::ArrayItems::Face>(mesh_, i));
  });
  return sum;
}

std::string WholeSegment::mismatch(Connectivity& mesh) const {
  if (&mesh != &mesh_) return "it was recorded on another mesh";
  if (!keep_) return "it was recorded for its notes only, without values";
  for (const Property& p : properties_) {
    const auto slots = property_slots(mesh_, p.kind);
    const auto slot = static_cast<std::size_t>(p.slot);
    if (slot >= slots.size() || !slots[slot] || slots[slot]->name() != p.name)
      return fmt::format("property '{}' was removed since", p.name);
  }
  return fingerprint() == left_ ? std::string() : "the mesh was changed since";
}

}  // namespace tri

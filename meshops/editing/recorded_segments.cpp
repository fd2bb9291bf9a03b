#include "meshops/editing/recorded_segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "meshops/editing/segment_records.hpp"
#include "meshops/error.hpp"

namespace tri {

using namespace segment_records;

namespace {

using Connectivity = OpenMesh::TriConnectivity;

std::size_t number(ElementKind kind) {
  return static_cast<std::size_t>(kind);
}

Connectivity::StatusInfo status_of(const OpenMesh::BaseProperty& property, std::size_t index) {
  return static_cast<const OpenMesh::PropertyT<Connectivity::StatusInfo>&>(property)[static_cast<int>(index)];
}

constexpr std::size_t block_pages = 32;  // of a touched set

template <class Visit>
void mix_touched(std::uint64_t& sum, const TouchedSet& touched, const Context* context, const Visit& visit) {
  mix_blocks(
      sum, (touched.pages() + block_pages - 1) / block_pages, context, [&](std::size_t block, std::uint64_t& part) {
        touched.for_pages(block * block_pages, (block + 1) * block_pages, [&](std::size_t i) { visit(part, i); });
      });
}

void append(std::vector<std::uint32_t>& list, const TouchedSet& set) {
  set.for_each([&](std::size_t i) { list.push_back(static_cast<std::uint32_t>(i)); });
}

}  // namespace

std::size_t ElementCounts::of(ElementKind kind) const {
  switch (kind) {
    case ElementKind::vertex:
      return vertices;
    case ElementKind::edge:
      return edges;
    case ElementKind::halfedge:
      return 2 * edges;
    case ElementKind::face:
      return faces;
    case ElementKind::mesh:
      return 1;
  }
  return 0;
}

DeltaSegment::DeltaSegment(Connectivity& mesh, const PropertyTypes& types, int position_slot, int temporary,
                           bool keep_values)
    : mesh_(mesh), keep_values_(keep_values), temporary_(temporary), before_(ElementCounts::of(mesh)) {
  vertices_.limit = before_.vertices;
  edges_.limit = before_.edges;
  faces_.limit = before_.faces;
  for (const ElementKind kind : element_kinds) {
    const auto slots = property_slots(mesh_, kind);
    auto& columns = columns_[number(kind)];
    columns.reserve(slots.size());
    for (int slot = 0; slot < static_cast<int>(slots.size()); ++slot) {
      const OpenMesh::BaseProperty* property = slots[static_cast<std::size_t>(slot)];
      if (!property || (kind == ElementKind::vertex && slot == temporary_)) continue;
      Column column;
      column.kind = kind;
      column.slot = slot;
      column.name = property->name();
      column.type_id = typeid(*property);
      column.type = types.share(*property);
      column.status = dynamic_cast<const OpenMesh::PropertyT<Connectivity::StatusInfo>*>(property) &&
                      column.name.ends_with(":status");
      column.point = kind == ElementKind::vertex && (slot == position_slot || column.name == "v:points");
      column.corner = kind == ElementKind::halfedge && !column.status && column.name.starts_with("h:");
      columns.push_back(std::move(column));
    }
  }
}

OpenMesh::BaseProperty& DeltaSegment::object(const Column& column) const {
  return *property_slots(mesh_, column.kind)[static_cast<std::size_t>(column.slot)];
}

void DeltaSegment::save(Column& column, int index) {
  if (static_cast<std::size_t>(index) >= before_.of(column.kind) || column.removed || column.rewritten) return;
  if (!column.touched.insert(static_cast<std::size_t>(index))) return;
  const bool keep = keep_values_ || column.status || column.point;
  if (!column.type && keep) {
    property(column.kind, column.slot);
    return;
  }
  column.indices.push_back(static_cast<std::uint32_t>(index));
  if (!keep) return;
  if (!column.kept) column.kept = column.type->make();
  column.type->keep(object(column), static_cast<std::size_t>(index), *column.kept);
}

void DeltaSegment::point(VertexHandle v) {
  for (Column& c : columns_[number(ElementKind::vertex)])
    if (c.point) save(c, v.idx());
}

void DeltaSegment::status(ElementKind kind, int index) {
  for (Column& c : columns_[number(kind)])
    if (c.status) save(c, index);
}

void DeltaSegment::values(ElementKind kind, int index) {
  for (Column& c : columns_[number(kind)])
    if (!c.status && !c.point) save(c, index);
}

void DeltaSegment::corner(HalfedgeHandle h) {
  for (Column& c : columns_[number(ElementKind::halfedge)])
    if (c.corner) save(c, h.idx());
}

void DeltaSegment::property(ElementKind kind, int slot) {
  for (Column& c : columns_[number(kind)]) {
    if (c.slot != slot || c.removed || c.rewritten) continue;
    c.rewritten = true;
    if (!keep_values_) continue;
    c.whole.reset(object(c).clone());
    c.whole->resize(before_.of(kind));
  }
}

void DeltaSegment::remove_property(ElementKind kind, int slot) {
  for (Column& c : columns_[number(kind)]) {
    if (c.slot != slot || c.removed) continue;
    auto& place = property_slots(mesh_, kind)[static_cast<std::size_t>(slot)];
    std::unique_ptr<OpenMesh::BaseProperty> object(std::exchange(place, nullptr));
    if (c.whole) object = std::move(c.whole);
    removed_.push_back({kind, slot, c.name, c.type_id, std::move(object)});
    c.removed = true;
  }
}

void DeltaSegment::look_at_properties() {
  after_ = ElementCounts::of(mesh_);
  added_.clear();
  lost_.clear();
  for (const ElementKind kind : element_kinds) {
    const auto slots = property_slots(mesh_, kind);
    for (int slot = 0; slot < static_cast<int>(slots.size()); ++slot) {
      if (kind == ElementKind::vertex && slot == temporary_) continue;
      const auto& columns = columns_[number(kind)];
      const auto column =
          std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.slot == slot && !c.removed; });
      const OpenMesh::BaseProperty* property = slots[static_cast<std::size_t>(slot)];
      if (column == columns.end()) {
        if (property) added_.push_back({kind, slot, property->name(), typeid(*property), nullptr});
      } else if (!property || property->name() != column->name || typeid(*property) != column->type_id) {
        lost_ = column->name;
      }
    }
  }
}

void DeltaSegment::finish(const Context* context) {
  look_at_properties();
  left_ = fingerprint(context);
}

std::string DeltaSegment::loss() const {
  if (lost_.empty()) return {};
  return fmt::format("property '{}' was removed while it was recorded, other than by remove_property of mesh_edit",
                     lost_);
}

template <class Each>
void DeltaSegment::for_each_links(const Each& each) {
  each(vertices_, before_.vertices, after_.vertices);
  each(edges_, before_.edges, after_.edges);
  each(faces_, before_.faces, after_.faces);
}

/// Side by side if there is much to do.
void DeltaSegment::run_for_touched(const std::vector<std::function<void()>>& tasks) const {
  std::size_t most = std::max({vertices_.indices.size(), edges_.indices.size(), faces_.indices.size()});
  for (const auto& columns : columns_)
    for (const Column& c : columns)
      if (c.kept) most = std::max(most, c.indices.size());
  if (most > 10000) {
    run_all(tasks, nullptr);
  } else {
    for (const auto& task : tasks) task();
  }
}

/// Links and values of the touched elements that were there at the begin, for those that are kept.
void DeltaSegment::exchange_touched() {
  std::vector<std::function<void()>> tasks;
  for_each_links([&]<class Record>(Links<Record>& table, std::size_t, std::size_t) {
    if (!table.indices.empty())
      tasks.push_back([this, &table] {
        for (std::size_t i = 0; i < table.indices.size(); ++i)
          std::swap(record_at<Record>(mesh_, table.indices[i]), table.records[i]);
      });
  });
  for (auto& columns : columns_)
    for (Column& c : columns)
      if (c.kept) tasks.push_back([this, &c] { c.type->swap_each(object(c), c.indices, *c.kept); });
  run_for_touched(tasks);
}

/// The same for good: what is kept is gone afterwards, since a cancel waits for this, and for its memory to be given
/// back.
void DeltaSegment::restore_touched() {
  std::vector<std::function<void()>> tasks;
  for_each_links([&]<class Record>(Links<Record>& table, std::size_t, std::size_t) {
    if (table.indices.empty()) return;
    tasks.push_back([this, &table] {
      const Record* const records = table.records.data();
      Record* const all = &record_at<Record>(mesh_, 0);
      for (std::size_t i = 0; i < table.indices.size(); ++i) all[table.indices[i]] = records[i];
      table = {};
    });
  });
  for (auto& columns : columns_)
    for (Column& c : columns)
      if (c.kept)
        tasks.push_back([this, &c] {
          c.type->set_each(object(c), c.indices, *c.kept);
          c.kept.reset();
          c.indices = {};
          c.touched = {};
        });
  run_for_touched(tasks);
}

/// Properties as a whole, for those that are kept.
void DeltaSegment::exchange_wholes() {
  for (auto& columns : columns_)
    for (Column& c : columns)
      if (c.whole && !c.removed) {
        auto& place = property_slots(mesh_, c.kind)[static_cast<std::size_t>(c.slot)];
        c.whole.reset(std::exchange(place, c.whole.release()));
      }
}

void DeltaSegment::take_tails() {
  for_each_links([&]<class Record>(Links<Record>& table, std::size_t begin, std::size_t end) {
    table.tail.clear();
    for (std::size_t i = begin; i < end; ++i) table.tail.push_back(record_at<Record>(mesh_, i));
  });
  for (auto& columns : columns_)
    for (Column& c : columns) {
      const std::size_t begin = before_.of(c.kind), end = after_.of(c.kind);
      if (c.removed || c.whole || begin == end) continue;
      OpenMesh::BaseProperty& property = object(c);
      if (!c.type) {
        c.tail.reset(property.clone());
        continue;
      }
      c.tail = c.type->make();
      for (std::size_t i = begin; i < end; ++i) c.type->keep(property, i, *c.tail);
    }
}

void DeltaSegment::put_tails() {
  for_each_links([&]<class Record>(Links<Record>& table, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) record_at<Record>(mesh_, i) = table.tail[i - begin];
    table.tail.clear();
  });
  for (auto& columns : columns_)
    for (Column& c : columns) {
      if (!c.tail) continue;
      auto& place = property_slots(mesh_, c.kind)[static_cast<std::size_t>(c.slot)];
      const std::size_t begin = before_.of(c.kind), end = after_.of(c.kind);
      if (!c.type)
        delete std::exchange(place, c.tail.release());
      else
        for (std::size_t i = begin; i < end; ++i) c.type->swap(*place, i, *c.tail, i - begin);
      c.tail.reset();
    }
}

void DeltaSegment::undo(Connectivity& mesh) {
  (void)mesh;
  take_tails();
  for (Detached& d : added_) {
    auto& place = property_slots(mesh_, d.kind)[static_cast<std::size_t>(d.slot)];
    d.object.reset(std::exchange(place, nullptr));
  }
  exchange_wholes();
  mesh_.resize(before_.vertices, before_.edges, before_.faces);
  for (Detached& d : removed_) {
    d.object->resize(before_.of(d.kind));
    property_slots(mesh_, d.kind)[static_cast<std::size_t>(d.slot)] = d.object.release();
  }
  exchange_touched();
  undone_ = true;
  left_ = fingerprint(nullptr);
}

void DeltaSegment::roll_back() {
  look_at_properties();
  if (!lost_.empty()) throw InvalidInput("cannot undo: " + loss());
  for (const Detached& d : added_)
    delete std::exchange(property_slots(mesh_, d.kind)[static_cast<std::size_t>(d.slot)], nullptr);
  exchange_wholes();
  mesh_.resize(before_.vertices, before_.edges, before_.faces);
  for (Detached& d : removed_) {
    d.object->resize(before_.of(d.kind));
    property_slots(mesh_, d.kind)[static_cast<std::size_t>(d.slot)] = d.object.release();
  }
  restore_touched();
}

void DeltaSegment::redo(Connectivity& mesh) {
  (void)mesh;
  exchange_touched();
  for (Detached& d : removed_) {
    auto& place = property_slots(mesh_, d.kind)[static_cast<std::size_t>(d.slot)];
    d.object.reset(std::exchange(place, nullptr));
  }
  mesh_.resize(after_.vertices, after_.edges, after_.faces);
  for (auto& columns : columns_)
    for (Column& c : columns)
      if (c.whole && !c.removed) {
        auto& place = property_slots(mesh_, c.kind)[static_cast<std::size_t>(c.slot)];
        c.whole.reset(std::exchange(place, c.whole.release()));
        c.whole->resize(before_.of(c.kind));
      }
  put_tails();
  for (Detached& d : added_) property_slots(mesh_, d.kind)[static_cast<std::size_t>(d.slot)] = d.object.release();
  undone_ = false;
  left_ = fingerprint(nullptr);
}

/// Of counts, and of the links, positions and deletions of what was touched or added. Values and selection are left
/// out: an editor may colour, select and update normals in between.
std::uint64_t DeltaSegment::fingerprint(const Context* context) const {
  const ElementCounts now = ElementCounts::of(mesh_);
  std::uint64_t sum = 0;
  for (const std::size_t n : {now.vertices, now.edges, now.faces}) mix(sum, n);
  const auto links = [&]<class Record>(const Links<Record>& table, std::size_t count) {
    const auto visit = [&](std::uint64_t& part, std::size_t i) { mix_record(part, record_at<Record>(mesh_, i)); };
    mix_touched(sum, table.touched, context, visit);
    mix_range(sum, table.limit, count, context, visit);
  };
  links(vertices_, now.vertices);
  links(edges_, now.edges);
  links(faces_, now.faces);
  for (const auto& columns : columns_)
    for (const Column& c : columns) {
      if (c.removed || !c.kept || !(c.status || c.point)) continue;
      const auto slots = property_slots(mesh_, c.kind);
      if (static_cast<std::size_t>(c.slot) >= slots.size() || !slots[static_cast<std::size_t>(c.slot)]) continue;
      const OpenMesh::BaseProperty& property = *slots[static_cast<std::size_t>(c.slot)];
      if (typeid(property) != c.type_id) continue;
      mix_touched(sum, c.touched, context, [&](std::uint64_t& part, std::size_t i) {
        mix(part, c.status ? static_cast<std::uint64_t>(status_of(property, i).deleted()) : c.type->hash(property, i));
      });
    }
  return sum;
}

std::string DeltaSegment::missing_property() const {
  const auto is_there = [&](ElementKind kind, int slot, const std::string& name, std::type_index type) {
    const auto slots = property_slots(mesh_, kind);
    if (static_cast<std::size_t>(slot) >= slots.size()) return false;
    const OpenMesh::BaseProperty* property = slots[static_cast<std::size_t>(slot)];
    return property && property->name() == name && typeid(*property) == type;
  };
  for (const auto& columns : columns_)
    for (const Column& c : columns) {
      const bool needed = c.kept || c.whole || c.tail || (before_.of(c.kind) != after_.of(c.kind));
      if (needed && !c.removed && !is_there(c.kind, c.slot, c.name, c.type_id)) return c.name;
    }
  for (const Detached& d : undone_ ? removed_ : added_)
    if (!is_there(d.kind, d.slot, d.name, d.type_id)) return d.name;
  return {};
}

std::string DeltaSegment::mismatch(Connectivity& mesh) const {
  if (&mesh != &mesh_) return "it was recorded on another mesh";
  if (!keep_values_) return "it was recorded for its notes only, without values";
  if (!lost_.empty()) return loss();
  const ElementCounts now = ElementCounts::of(mesh), expected = undone_ ? before_ : after_;
  if (now != expected)
    return fmt::format(
        "the mesh has {} vertices, {} edges and {} faces (deleted ones included), and was left with {}, {} and {}",
        now.vertices, now.edges, now.faces, expected.vertices, expected.edges, expected.faces);
  if (const std::string name = missing_property(); !name.empty())
    return fmt::format("property '{}' was removed since", name);
  const std::vector<Detached>&there = undone_ ? removed_ : added_, &gone = undone_ ? added_ : removed_;
  for (const Detached& d : gone) {
    const auto same_slot = [&](const Detached& o) { return o.kind == d.kind && o.slot == d.slot; };
    if (std::any_of(there.begin(), there.end(), same_slot)) continue;
    const auto slots = property_slots(mesh_, d.kind);
    const auto slot = static_cast<std::size_t>(d.slot);
    if (slot < slots.size() && slots[slot])
      return fmt::format("property '{}' was added since, where '{}' belongs", slots[slot]->name(), d.name);
  }
  if (fingerprint(nullptr) != left_) return "elements that it touched were changed since";
  return {};
}

bool DeltaSegment::empty() const {
  if (before_ != after_ || !added_.empty() || !removed_.empty() || !lost_.empty()) return false;
  if (!vertices_.indices.empty() || !edges_.indices.empty() || !faces_.indices.empty()) return false;
  for (const auto& columns : columns_)
    for (const Column& c : columns)
      if (!c.indices.empty() || c.rewritten) return false;
  return true;
}

void DeltaSegment::describe(ChangeNotes& notes, const Context* context) const {
  Connectivity& mesh = mesh_;
  // What has values, beside the elements whose own values were set: edges and faces by their half-edges.
  TouchedSet valued_edges, valued_faces, other_ends, moved;
  const auto list = [&](ElementKind kind, const TouchedSet& relinked, TouchedSet& revalued, ElementNotes& out,
                        auto handle) {
    using Handle = decltype(handle);
    const auto alive = [&](std::size_t i) { return !mesh.status(Handle(static_cast<int>(i))).deleted(); };
    TouchedSet came, went;
    for (const Column& c : columns_[number(kind)]) {
      if (c.status && c.kept)
        for (std::size_t k = 0; k < c.indices.size(); ++k) {
          const bool was = !status_of(*c.kept, k).deleted(), is = alive(c.indices[k]);
          if (was != is) (is ? came : went).insert(c.indices[k]);
        }
    }
    append(out.removed, went);
    append(out.added, came);
    for (std::size_t i = before_.of(kind); i < after_.of(kind); ++i)
      if (alive(i)) out.added.push_back(static_cast<std::uint32_t>(i));
    const auto append_stayed = [&](std::vector<std::uint32_t>& to, const TouchedSet& set) {
      if (context) context->checkpoint();
      set.for_each([&](std::size_t i) {
        if (alive(i) && !came.contains(i)) to.push_back(static_cast<std::uint32_t>(i));
      });
    };
    append_stayed(out.relinked, relinked);
    for (const Column& c : columns_[number(kind)])
      if (!c.point)
        c.touched.for_each([&](std::size_t i) {
          if (!came.contains(i)) revalued.insert(i);
        });
    if (context) context->checkpoint();
    revalued.for_each([&](std::size_t i) {
      if (alive(i)) out.revalued.push_back(static_cast<std::uint32_t>(i));
    });
  };
  const auto look_at_corners = [&] {
    for (const Column& c : columns_[number(ElementKind::halfedge)]) {
      if (c.status) continue;
      if (context) context->checkpoint();
      c.touched.for_each([&](std::size_t i) {
        const HalfedgeHandle h(static_cast<int>(i));
        const FaceHandle f = mesh.face_handle(h);
        const EdgeHandle e = mesh.edge_handle(h);
        if (mesh.status(e).deleted()) return;
        if (!f.is_valid())
          valued_edges.insert(static_cast<std::size_t>(e.idx()));
        else if (static_cast<std::size_t>(f.idx()) < before_.faces)
          valued_faces.insert(static_cast<std::size_t>(f.idx()));
      });
    }
  };
  const auto look_at_ends = [&] {
    for (std::size_t k = 0; k < edges_.indices.size(); ++k) {
      if (context && k % block_size == 0) context->checkpoint();
      const auto was = raw(edges_.records[k]), is = raw(record_at<Edge>(mesh, edges_.indices[k]));
      constexpr std::size_t to = 1, half = 4;  // face, vertex, next and previous of two half-edges
      if (was[to] != is[to] || was[half + to] != is[half + to]) other_ends.insert(edges_.indices[k]);
    }
  };
  const auto look_at_points = [&] {
    for (const Column& c : columns_[number(ElementKind::vertex)]) {
      if (!c.point || !c.kept) continue;
      const OpenMesh::BaseProperty& property = object(c);
      for (std::size_t k = 0; k < c.indices.size(); ++k) {
        if (context && k % block_size == 0) context->checkpoint();
        if (!mesh.status(VertexHandle(static_cast<int>(c.indices[k]))).deleted() &&
            c.type->hash(property, c.indices[k]) != c.type->hash(*c.kept, k))
          moved.insert(c.indices[k]);
      }
    }
    append(notes.vertices_moved, moved);
  };
  look_at_corners();
  TouchedSet valued_vertices;
  const std::vector<std::function<void()>> tasks{
      [&] { look_at_points(); },
      [&] { list(ElementKind::vertex, vertices_.touched, valued_vertices, notes.vertices, VertexHandle()); },
      [&] {
        look_at_ends();
        list(ElementKind::edge, other_ends, valued_edges, notes.edges, EdgeHandle());
      },
      [&] { list(ElementKind::face, faces_.touched, valued_faces, notes.faces, FaceHandle()); }};
  if (std::max({vertices_.indices.size(), edges_.indices.size(), faces_.indices.size()}) > 10000) {
    run_all(tasks, context);
  } else {
    for (const auto& task : tasks) task();
  }
  for (const Detached& d : added_) notes.properties_added.push_back(d.name);
  for (const Detached& d : removed_) notes.properties_removed.push_back(d.name);
  for (const auto& columns : columns_)
    for (const Column& c : columns)
      if (c.rewritten && !c.removed) notes.properties_rewritten.push_back(c.name);
}

}  // namespace tri

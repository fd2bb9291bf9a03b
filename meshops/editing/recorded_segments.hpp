#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <typeindex>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/editing/change_segment.hpp"
#include "meshops/editing/touched_set.hpp"

namespace tri {

/// Numbers of vertices, edges and faces.
struct ElementCounts {
  std::size_t vertices = 0, edges = 0, faces = 0;

  static ElementCounts of(const OpenMesh::TriConnectivity& mesh) {
    return {mesh.n_vertices(), mesh.n_edges(), mesh.n_faces()};
  }
  std::size_t of(ElementKind kind) const;
  bool operator==(const ElementCounts&) const = default;
};

/// A change of single elements: keeps for each that is touched what it was, once.
class DeltaSegment final : public ChangeSegment {
 public:
  /// @param temporary  the slot of a vertex property that is not part of the mesh; -1 for none
  /// @param keep_values  false: what changed can be told, but not undone
  DeltaSegment(OpenMesh::TriConnectivity& mesh, const PropertyTypes& types, int position_slot, int temporary,
               bool keep_values);

  // Announcements of what is about to change, of elements that exist; those that are new since the begin are passed
  // over.
  void links(VertexHandle v) { save(vertices_, mesh_.vertex(v), v.idx()); }
  void links(EdgeHandle e) { save(edges_, mesh_.edge(e), e.idx()); }
  void links(FaceHandle f) { save(faces_, mesh_.face(f), f.idx()); }
  void point(VertexHandle v);
  void status(ElementKind kind, int index);
  void values(ElementKind kind, int index);
  void corner(HalfedgeHandle h);
  void property(ElementKind kind, int slot);
  /// Takes the property out of the mesh and keeps it, if it was there at the begin.
  void remove_property(ElementKind kind, int slot);

  /// The change is complete. @param context  null: cannot be cancelled @throws Cancelled
  void finish(const Context* context);
  /// Appends what changed; before any undo. @param context  as above @throws Cancelled
  void describe(ChangeNotes& notes, const Context* context) const;

  void undo(OpenMesh::TriConnectivity& mesh) override;
  void redo(OpenMesh::TriConnectivity& mesh) override;
  std::string mismatch(OpenMesh::TriConnectivity& mesh) const override;
  bool empty() const override;
  void roll_back() override;

 private:
  template <class Record>
  struct Links {
    TouchedSet touched;
    std::vector<std::uint32_t> indices;
    std::vector<Record> records;  ///< of these; after an undo, what they are to be again
    std::vector<Record> tail;     ///< of the elements that an undo has taken away
    std::size_t limit = 0;        ///< the number of elements at the begin
  };
  using Vertex = OpenMesh::ArrayItems::Vertex;
  using Edge = OpenMesh::ArrayItems::Edge;
  using Face = OpenMesh::ArrayItems::Face;

  /// What is kept of one property that was there at the begin.
  struct Column {
    ElementKind kind = ElementKind::vertex;
    int slot = 0;
    std::string name;
    std::type_index type_id = typeid(void);
    std::shared_ptr<const PropertyType> type;  ///< null if nothing is known of the type
    bool corner = false, point = false, status = false;
    TouchedSet touched;
    std::vector<std::uint32_t> indices;
    std::unique_ptr<OpenMesh::BaseProperty> kept;   ///< the values of these
    std::unique_ptr<OpenMesh::BaseProperty> tail;   ///< the values of the elements that an undo has taken away
    std::unique_ptr<OpenMesh::BaseProperty> whole;  ///< the other state of the property as a whole
    bool rewritten = false, removed = false;
  };
  /// A property that was added, or one that was removed, where it is not in the mesh.
  struct Detached {
    ElementKind kind;
    int slot;
    std::string name;
    std::type_index type_id;
    std::unique_ptr<OpenMesh::BaseProperty> object;
  };

  template <class Record>
  void save(Links<Record>& table, const Record& record, int index) {
    if (static_cast<std::size_t>(index) >= table.limit || !table.touched.insert(static_cast<std::size_t>(index)))
      return;
    table.indices.push_back(static_cast<std::uint32_t>(index));
    table.records.push_back(record);
  }
  void save(Column& column, int index);
  OpenMesh::BaseProperty& object(const Column& column) const;
  template <class Each>
  void for_each_links(const Each& each);
  void exchange_touched();
  void restore_touched();
  void run_for_touched(const std::vector<std::function<void()>>& tasks) const;
  void exchange_wholes();
  void take_tails();
  void put_tails();
  void look_at_properties();
  std::string loss() const;
  std::uint64_t fingerprint(const Context* context) const;
  std::string missing_property() const;

  OpenMesh::TriConnectivity& mesh_;
  const bool keep_values_;
  const int temporary_;
  ElementCounts before_, after_;
  Links<Vertex> vertices_;
  Links<Edge> edges_;
  Links<Face> faces_;
  std::array<std::vector<Column>, 5> columns_;  ///< by kind
  std::vector<Detached> added_, removed_;
  std::string lost_;  ///< a property that went without notice
  bool undone_ = false;
  std::uint64_t left_ = 0;  ///< fingerprint of what this left the last time
};

/// A change of everything: keeps the whole mesh as it was.
class WholeSegment final : public ChangeSegment {
 public:
  /// @param keep  false: nothing is kept, and it cannot be undone
  WholeSegment(OpenMesh::TriConnectivity& mesh, int temporary, bool keep);
  void finish();

  void undo(OpenMesh::TriConnectivity& mesh) override;
  void redo(OpenMesh::TriConnectivity& mesh) override;
  std::string mismatch(OpenMesh::TriConnectivity& mesh) const override;
  bool empty() const override { return false; }
  void roll_back() override { exchange(); }

 private:
  struct Property {
    ElementKind kind;
    int slot;
    std::string name;
    std::unique_ptr<OpenMesh::BaseProperty> object;
  };

  void exchange();
  std::uint64_t fingerprint() const;

  OpenMesh::TriConnectivity& mesh_;
  const int temporary_;
  const bool keep_;
  ElementCounts other_;  ///< of the state that is kept
  std::vector<OpenMesh::ArrayItems::Vertex> vertices_;
  std::vector<OpenMesh::ArrayItems::Edge> edges_;
  std::vector<OpenMesh::ArrayItems::Face> faces_;
  std::vector<Property> properties_;
  std::uint64_t left_ = 0;
};

}  // namespace tri

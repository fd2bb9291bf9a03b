#pragma once

#include <OpenMesh/Core/Utils/Property.hh>
#include <memory>
#include <span>
#include <vector>

#include "meshops/editing/property_types.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// The values of vertices and corners before a mesh is changed, so that elements that were moved or made can take
/// theirs from where they lie now, and not from what happened on the way.
///
/// Values that can be averaged are (`PropertyType::blends`); `v:uv` and `v:cad_face` come from the source with the
/// greatest weight, `v:point_index` becomes -1. Other properties are left alone. Not to be shared between threads.
/// It writes without a word: who uses it announces the values (`about_to_set`).
class AttributeSnapshot {
 public:
  explicit AttributeSnapshot(MeshView mesh);

  bool has_vertex_values() const { return !vertices_.empty(); }
  bool has_corner_values() const { return !corners_.empty(); }

  /// Sets the values of a vertex of the mesh as it is now. @param sources  vertices of the mesh as it was, at least one
  void set_vertex(VertexHandle v, std::span<const WeightedIndex> sources);

  /// Sets the values of the corner in which a half-edge ends. @param sources  half-edges of the mesh as it was, at
  /// least one
  void set_corner(HalfedgeHandle h, std::span<const WeightedIndex> sources);

 private:
  struct Kept {
    OpenMesh::BaseProperty* property = nullptr;
    const PropertyType* type = nullptr;
    std::unique_ptr<OpenMesh::BaseProperty> values;  ///< as they were, and one more to work with
    std::size_t spare = 0;
    bool averaged = false;
  };
  static void keep(OpenMesh::BaseProperty& property, bool averaged, std::vector<Kept>& kept);
  static void set(Kept& kept, std::span<const WeightedIndex> sources, std::size_t to);

  std::vector<Kept> vertices_, corners_;
  OpenMesh::PropertyT<int>* point_index_ = nullptr;
};

}  // namespace tri

#include "meshops/editing/attribute_snapshot.hpp"

#include "meshops/editing/new_values.hpp"

namespace tri {

AttributeSnapshot::AttributeSnapshot(MeshView view) {
  OpenMesh::TriConnectivity& mesh = view.mesh;
  const PropertyTypes& types = PropertyTypes::standard();
  const OpenMesh::BaseProperty* const position = &mesh.property(view.position_property);
  for (auto it = mesh.vprops_begin(); it != mesh.vprops_end(); ++it) {
    OpenMesh::BaseProperty* const property = *it;
    if (!property || property == position || property->name() == "v:status") continue;
    const PropertyType* type = types.find(*property);
    if (property->name() == property::point_index) point_index_ = dynamic_cast<OpenMesh::PropertyT<int>*>(property);
    const bool of_model = property->name() == property::uv || property->name() == property::cad_face;
    if (type && (type->blends() || of_model)) keep(*property, !of_model, vertices_);
  }
  for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
    const PropertyType* type = types.find(property);
    if (type && type->blends()) keep(property, true, corners_);
  });
}

void AttributeSnapshot::keep(OpenMesh::BaseProperty& property, bool averaged, std::vector<Kept>& kept) {
  Kept k{&property, PropertyTypes::standard().find(property), std::unique_ptr<OpenMesh::BaseProperty>(property.clone()),
         property.n_elements(), averaged};
  k.values->resize(k.spare + 1);
  kept.push_back(std::move(k));
}

void AttributeSnapshot::set(Kept& kept, std::span<const WeightedIndex> sources, std::size_t to) {
  if (kept.averaged)
    kept.type->blend(*kept.values, sources, kept.spare);
  else
    kept.values->copy(greatest(sources), kept.spare);
  kept.type->swap(*kept.property, to, *kept.values, kept.spare);
}

void AttributeSnapshot::set_vertex(VertexHandle v, std::span<const WeightedIndex> sources) {
  for (Kept& kept : vertices_) set(kept, sources, static_cast<std::size_t>(v.idx()));
  if (point_index_) (*point_index_)[v.idx()] = -1;
}

void AttributeSnapshot::set_corner(HalfedgeHandle h, std::span<const WeightedIndex> sources) {
  for (Kept& kept : corners_) set(kept, sources, static_cast<std::size_t>(h.idx()));
}

}  // namespace tri

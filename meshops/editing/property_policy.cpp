#include "meshops/editing/property_policy.hpp"

#include "meshops/mesh.hpp"

namespace tri {
namespace {

PropertyPolicy make_standard_policy() {
  PropertyPolicy policy;
  policy.set_initial(property::point_index, -1);
  policy.set(property::uv, NewValue::copy);
  policy.set(property::cad_face, NewValue::copy);
  return policy;
}

}  // namespace

const PropertyPolicy& PropertyPolicy::standard() {
  static const PropertyPolicy policy = make_standard_policy();
  return policy;
}

void PropertyPolicy::inherit(OpenMesh::BaseProperty& property, std::span<const WeightedIndex> sources,
                             std::size_t to) const {
  NewValue value = general_;
  const OpenMesh::BaseProperty* initial = nullptr;
  if (const auto named = by_name_.find(property.name()); named != by_name_.end()) {
    value = named->second.value;
    initial = named->second.initial.get();
  } else if (!by_type_.empty()) {
    if (const auto typed = by_type_.find(typeid(property)); typed != by_type_.end()) value = typed->second;
  }
  if (value == NewValue::initial || sources.empty()) {
    const PropertyType* type = types_.find(property);
    if (!type) return;  // default-constructed if the element is new
    if (initial && typeid(*initial) == typeid(property))
      type->set(property, to, *initial, 0);
    else
      type->reset(property, to);
    return;
  }
  const PropertyType* type = value == NewValue::blend && sources.size() > 1 ? types_.find(property) : nullptr;
  if (type)
    type->blend(property, sources, to);
  else
    property.copy(greatest(sources), to);
}

}  // namespace tri

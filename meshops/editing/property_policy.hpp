#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "meshops/editing/property_types.hpp"

namespace tri {

/// Where the value of a new element comes from.
enum class NewValue {
  blend,    ///< the weighted mean of its sources' values where the type has one, else as `copy`
  copy,     ///< the value of the source with the greatest weight
  initial,  ///< zero, or a default-constructed value, or the one given to `set_initial`
};

/// What new elements inherit, property by property: a rule for its name, else one for its type, else the general one.
/// An editor makes its own, starting from a copy of the standard one, and hands it to `MeshLease` or puts it into a
/// `MeshView`.
class PropertyPolicy {
 public:
  /// Blends, but for what a triangulation knows of its points: `v:point_index` is -1 at a new vertex, which was not
  /// measured, and `v:uv` and `v:cad_face`, which belong together, are copied. Immutable; may be read from any thread.
  static const PropertyPolicy& standard();

  /// @param types  what is known of the types; may be added to (`types().add<Weights>()`) before the policy is used
  explicit PropertyPolicy(PropertyTypes types = PropertyTypes()) : types_(std::move(types)) {}

  /// The types it can copy and blend; add types of your own before any mesh is edited with it.
  PropertyTypes& types() { return types_; }
  /// For reading.
  const PropertyTypes& types() const { return types_; }

  /// The rule for what no other names.
  void set_general(NewValue rule) { general_ = rule; }
  /// @param name  of a property of vertices, edges, half-edges or faces
  void set(std::string_view name, NewValue rule) { by_name_[std::string(name)] = {rule, nullptr}; }
  /// The rule for properties of type T that no rule by name names.
  template <class T>
  void set_type(NewValue rule) {
    by_type_[typeid(OpenMesh::PropertyT<T>)] = rule;
  }
  /// The value that new elements get in the properties of this name and of type T.
  template <class T>
  void set_initial(std::string_view name, T value) {
    auto place = std::make_shared<OpenMesh::PropertyT<T>>();
    place->data_vector().push_back(std::move(value));
    by_name_[std::string(name)] = {NewValue::initial, std::move(place)};
  }

  /// Sets an element's value as the rules say. @param sources  none: the initial value
  void inherit(OpenMesh::BaseProperty& property, std::span<const WeightedIndex> sources, std::size_t to) const;

 private:
  struct Rule {
    NewValue value = NewValue::blend;
    std::shared_ptr<const OpenMesh::BaseProperty> initial;  ///< one value; null: the default one
  };

  PropertyTypes types_;
  NewValue general_ = NewValue::blend;
  std::unordered_map<std::string, Rule> by_name_;
  std::unordered_map<std::type_index, NewValue> by_type_;
};

}  // namespace tri

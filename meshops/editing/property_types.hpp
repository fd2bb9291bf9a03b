#pragma once

#include <OpenMesh/Core/Utils/Property.hh>
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <typeindex>
#include <unordered_map>
#include <utility>

namespace tri {

/// An element whose values another one inherits, and its share. The shares of one element sum to 1.
struct WeightedIndex {
  std::size_t index = 0;  ///< of the element, in its property
  double weight = 1;      ///< 0 or more
};

/// The source with the greatest weight, the first of several. @param sources  at least one
inline std::size_t greatest(std::span<const WeightedIndex> sources) {
  return std::max_element(sources.begin(), sources.end(),
                          [](const auto& a, const auto& b) { return a.weight < b.weight; })
      ->index;
}

/// What can be done with the values of one type of OpenMesh property, without knowing the type. Every property passed
/// must be of the type (`PropertyT<T>`); a place for values to be kept in is one that `make` returned, which may hold
/// them in another form, or a property of the type. Stateless: may be called from any thread.
class PropertyType {
 public:
  virtual ~PropertyType() = default;

  /// Whether values of the type are averaged; others are copied.
  virtual bool blends() const = 0;
  /// Sets an element's value to the weighted mean of the sources' values, or, where the type does not blend, to the
  /// value of the source with the greatest weight (the first of several). `to` may be a source.
  virtual void blend(OpenMesh::BaseProperty& property, std::span<const WeightedIndex> sources,
                     std::size_t to) const = 0;
  /// Whether two elements have equal values; false for a type without `operator==`.
  virtual bool equal(const OpenMesh::BaseProperty& property, std::size_t a, std::size_t b) const = 0;
  /// A number that differs, as good as always, where numbers or vectors of numbers differ in a bit; 0 for other types.
  /// @param place  a property of the type, or a place
  virtual std::uint64_t hash(const OpenMesh::BaseProperty& place, std::size_t index) const = 0;

  /// An empty place for values to be kept in, without a name.
  virtual std::unique_ptr<OpenMesh::BaseProperty> make() const = 0;
  /// Appends a copy of an element's value to a place that `make` returned.
  virtual void keep(const OpenMesh::BaseProperty& property, std::size_t index, OpenMesh::BaseProperty& place) const = 0;
  /// Sets an element's value to one in a place. @param kept  which, in the order in which they were kept
  virtual void set(OpenMesh::BaseProperty& property, std::size_t index, const OpenMesh::BaseProperty& place,
                   std::size_t kept) const = 0;
  /// Sets an element's value to zero, for numbers and vectors (whose default constructors, OpenMesh's and Eigen's, leave
  /// them uninitialised), else to a default-constructed one.
  virtual void reset(OpenMesh::BaseProperty& property, std::size_t index) const = 0;
  /// Swaps an element's value with one that was kept.
  virtual void swap(OpenMesh::BaseProperty& property, std::size_t index, OpenMesh::BaseProperty& place,
                    std::size_t kept) const = 0;
  /// Sets many elements' values to those that were kept, in the order in which they were. A type need not have its own.
  virtual void set_each(OpenMesh::BaseProperty& property, std::span<const std::uint32_t> indices,
                        const OpenMesh::BaseProperty& place) const {
    for (std::size_t i = 0; i < indices.size(); ++i) set(property, indices[i], place, i);
  }
  /// Swaps many elements' values with those that were kept. A type need not have its own.
  virtual void swap_each(OpenMesh::BaseProperty& property, std::span<const std::uint32_t> indices,
                         OpenMesh::BaseProperty& place) const {
    for (std::size_t i = 0; i < indices.size(); ++i) swap(property, indices[i], place, i);
  }
};

namespace property_values {

/// A vector of fixed length whose components are T: OpenMesh's VectorT, Eigen's vectors.
template <class T>
concept Sequence = requires(T value) {
  {value[0]};
  {value.size()};
}
&&!requires(T value) {
  value.push_back(value[0]);
}
&&!requires {
  requires !T::IsVectorAtCompileTime;
};

/// The type of the entries of T; void for what is no vector.
template <class T>
struct ComponentOf {
  using Type = void;  ///< no entries
};
/// For vectors of fixed size.
template <Sequence T>
struct ComponentOf<T> {
  using Type = std::remove_cvref_t<decltype(std::declval<T&>()[0])>;  ///< of `operator[]`
};
template <class T>
using Component = typename ComponentOf<T>::Type;

/// Floating-point numbers and vectors of them are averaged, and vectors of three or four bytes, which are colours.
template <class T>
constexpr bool blends() {
  if constexpr (std::is_floating_point_v<T>) {
    return true;
  } else if constexpr (Sequence<T>) {
    if constexpr (std::is_floating_point_v<Component<T>>) return true;
    return std::is_same_v<Component<T>, unsigned char> && (sizeof(T) == 3 || sizeof(T) == 4);
  } else {
    return false;
  }
}

/// A component of a mean; bytes are rounded, and end at 0 and 255.
template <class T>
T component(double mean) {
  if constexpr (std::is_floating_point_v<T>)
    return static_cast<T>(mean);
  else
    return static_cast<T>(
        std::clamp<double>(std::round(mean), std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
}

template <class T>
std::uint64_t mixed(std::uint64_t seed, const T& number) {
  std::uint64_t bits = 0;
  if constexpr (std::is_floating_point_v<T>)
    bits = std::bit_cast<std::uint64_t>(static_cast<double>(number));
  else
    bits = static_cast<std::uint64_t>(number);
  seed = (seed ^ bits) * 0x9e3779b97f4a7c15u;
  return seed ^ (seed >> 29);
}

}  // namespace property_values

/// What PropertyType says, for values of type T.
template <class T>
class PropertyTypeOf final : public PropertyType {
  using Property = OpenMesh::PropertyT<T>;

 public:
  bool blends() const override { return property_values::blends<T>(); }

  void blend(OpenMesh::BaseProperty& base, std::span<const WeightedIndex> sources, std::size_t to) const override {
    if (sources.empty()) return;
    Property& property = static_cast<Property&>(base);
    if constexpr (std::is_floating_point_v<T>) {
      property[static_cast<int>(to)] = mean(sources, [&](std::size_t i) { return property[static_cast<int>(i)]; });
    } else if constexpr (property_values::blends<T>()) {
      T result = property[static_cast<int>(sources.front().index)];
      for (int k = 0; k < static_cast<int>(result.size()); ++k)
        result[k] = property_values::component<property_values::Component<T>>(
            static_cast<double>(mean(sources, [&](std::size_t i) { return property[static_cast<int>(i)][k]; })));
      property[static_cast<int>(to)] = result;
    } else {
      base.copy(greatest(sources), to);
    }
  }

  bool equal(const OpenMesh::BaseProperty& base, std::size_t a, std::size_t b) const override {
    if constexpr (std::equality_comparable<T>) {
      const Property& property = static_cast<const Property&>(base);
      return property[static_cast<int>(a)] == property[static_cast<int>(b)];
    } else {
      return false;
    }
  }

  std::uint64_t hash(const OpenMesh::BaseProperty& base, std::size_t index) const override {
    const Property& property = static_cast<const Property&>(base);
    const auto& value = property[static_cast<int>(index)];
    std::uint64_t result = 0;
    if constexpr (std::is_arithmetic_v<T>) {
      result = property_values::mixed<T>(result, value);
    } else if constexpr (property_values::Sequence<T>) {
      if constexpr (std::is_arithmetic_v<property_values::Component<T>>)
        for (int k = 0; k < static_cast<int>(value.size()); ++k)
          result = property_values::mixed<property_values::Component<T>>(result, value[k]);
    }
    return result;
  }

  std::unique_ptr<OpenMesh::BaseProperty> make() const override { return std::make_unique<Property>(); }
  void keep(const OpenMesh::BaseProperty& base, std::size_t index, OpenMesh::BaseProperty& place) const override {
    static_cast<Property&>(place).data_vector().push_back(static_cast<const Property&>(base)[static_cast<int>(index)]);
  }
  void set(OpenMesh::BaseProperty& base, std::size_t index, const OpenMesh::BaseProperty& place,
           std::size_t kept) const override {
    static_cast<Property&>(base)[static_cast<int>(index)] = static_cast<const Property&>(place)[static_cast<int>(kept)];
  }
  /// See PropertyType.
  void reset(OpenMesh::BaseProperty& base, std::size_t index) const override {
    auto&& value = static_cast<Property&>(base)[static_cast<int>(index)];
    if constexpr (requires { T::Zero(); })
      value = T::Zero();
    else if constexpr (property_values::Sequence<T>)
      for (int k = 0; k < static_cast<int>(value.size()); ++k) value[k] = property_values::Component<T>();
    else
      value = T();
  }
  void swap(OpenMesh::BaseProperty& base, std::size_t index, OpenMesh::BaseProperty& place,
            std::size_t kept) const override {
    auto&& value = static_cast<Property&>(base)[static_cast<int>(index)];
    auto&& other = static_cast<Property&>(place)[static_cast<int>(kept)];
    T moved = std::move(value);
    value = std::move(other);
    other = std::move(moved);
  }
  // One call for all: of millions, calls would take longer than what they do.
  /// See PropertyType.
  void set_each(OpenMesh::BaseProperty& base, std::span<const std::uint32_t> indices,
                const OpenMesh::BaseProperty& place) const override {
    Property& property = static_cast<Property&>(base);
    const Property& kept = static_cast<const Property&>(place);
    for (std::size_t i = 0; i < indices.size(); ++i) property[static_cast<int>(indices[i])] = kept[static_cast<int>(i)];
  }
  /// See PropertyType.
  void swap_each(OpenMesh::BaseProperty& base, std::span<const std::uint32_t> indices,
                 OpenMesh::BaseProperty& place) const override {
    for (std::size_t i = 0; i < indices.size(); ++i) PropertyTypeOf::swap(base, indices[i], place, i);
  }

 private:
  /// A source without weight adds nothing, not even if it is infinite.
  template <class Value>
  static auto mean(std::span<const WeightedIndex> sources, const Value& value) {
    using Sum = std::conditional_t<std::is_same_v<T, long double>, long double, double>;
    Sum sum = 0;
    for (const WeightedIndex& s : sources)
      if (s.weight != 0) sum += static_cast<Sum>(s.weight) * static_cast<Sum>(value(s.index));
    return static_cast<std::conditional_t<std::is_floating_point_v<T>, T, Sum>>(sum);
  }
};

/// The types of properties that can be averaged, compared and kept one by one. A property of any other type is copied
/// from one element to another as a whole value, which every type can.
class PropertyTypes {
 public:
  /// Arithmetic types, OpenMesh's vectors of one to six of them, strings, vectors of numbers, handles, status, Eigen's
  /// vectors and square matrices of two to four rows, and the traits of `Mesh`. Immutable; may be read from any thread.
  static const PropertyTypes& standard();

  /// @param base  is asked for what was not added here; must outlive this
  explicit PropertyTypes(const PropertyTypes* base = &standard()) : base_(base) {}

  /// Adds `PropertyT<T>`. Blending is taken for floating-point numbers, fixed vectors of them, and colours of bytes.
  template <class T>
  void add() {
    add(typeid(OpenMesh::PropertyT<T>), std::make_shared<PropertyTypeOf<T>>());
  }
  /// Adds a type with behaviour of its own. @param type  of the property, say typeid(OpenMesh::PropertyT<Weights>)
  void add(std::type_index type, std::shared_ptr<const PropertyType> behaviour) { own_[type] = std::move(behaviour); }

  /// Nullptr if the type is not known.
  const PropertyType* find(const OpenMesh::BaseProperty& property) const;
  /// The same, to be kept longer than this.
  std::shared_ptr<const PropertyType> share(const OpenMesh::BaseProperty& property) const;

 private:
  const std::shared_ptr<const PropertyType>* look_up(const OpenMesh::BaseProperty& property) const;

  const PropertyTypes* base_;
  std::unordered_map<std::type_index, std::shared_ptr<const PropertyType>> own_;
};

}  // namespace tri

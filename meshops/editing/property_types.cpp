#include "meshops/editing/property_types.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include "meshops/mesh.hpp"

namespace tri {
namespace {

/// The numbers in a property of rows (a number is a row of one), one row after the other.
template <class Scalar>
using Numbers = Scalar* (*)(OpenMesh::BaseProperty& property);

template <class Row, class Scalar>
Scalar* numbers_of(OpenMesh::BaseProperty& property) {
  Row* rows = static_cast<OpenMesh::PropertyT<Row>&>(property).data_vector().data();
  if constexpr (std::is_arithmetic_v<Row>)
    return rows;
  else
    return rows ? rows->data() : nullptr;
}

/// Rows of numbers, whichever of the many types holds them: a class for each of those would be a minute of compiling.
/// A place for kept values is a property of numbers.
template <class Scalar>
class RowType final : public PropertyType {
  using Place = OpenMesh::PropertyT<Scalar>;
  static constexpr std::size_t most = 16;

 public:
  /// @param size  numbers in a row, at most 16
  RowType(Numbers<Scalar> numbers, std::size_t size, bool blends) : numbers_(numbers), size_(size), blends_(blends) {}

  bool blends() const override { return blends_; }

  void blend(OpenMesh::BaseProperty& property, std::span<const WeightedIndex> sources, std::size_t to) const override {
    if (sources.empty()) return;
    if (!blends_) return property.copy(greatest(sources), to);
    using Sum = std::conditional_t<std::is_same_v<Scalar, long double>, long double, double>;
    std::array<Scalar, most> result{};
    for (std::size_t k = 0; k < size_; ++k) {
      Sum sum = 0;
      for (const WeightedIndex& s : sources)
        if (s.weight != 0) sum += static_cast<Sum>(s.weight) * static_cast<Sum>(row(property, s.index)[k]);
      if constexpr (std::is_floating_point_v<Scalar>)
        result[k] = static_cast<Scalar>(sum);
      else
        result[k] = property_values::component<Scalar>(static_cast<double>(sum));
    }
    std::copy_n(result.data(), size_, row(property, to));
  }

  bool equal(const OpenMesh::BaseProperty& property, std::size_t a, std::size_t b) const override {
    const Scalar* first = row(property, a);
    return std::equal(first, first + size_, row(property, b));
  }

  std::uint64_t hash(const OpenMesh::BaseProperty& place, std::size_t index) const override {
    const Scalar* values = kept_in(place) + index * size_;
    std::uint64_t result = 0;
    for (std::size_t k = 0; k < size_; ++k) result = property_values::mixed<Scalar>(result, values[k]);
    return result;
  }

  std::unique_ptr<OpenMesh::BaseProperty> make() const override { return std::make_unique<Place>(); }
  void keep(const OpenMesh::BaseProperty& property, std::size_t index, OpenMesh::BaseProperty& place) const override {
    const Scalar* values = row(property, index);
    auto& kept = static_cast<Place&>(place).data_vector();
    kept.insert(kept.end(), values, values + size_);
  }
  void set(OpenMesh::BaseProperty& property, std::size_t index, const OpenMesh::BaseProperty& place,
           std::size_t kept) const override {
    std::copy_n(kept_in(place) + kept * size_, size_, row(property, index));
  }
  void reset(OpenMesh::BaseProperty& property, std::size_t index) const override {
    std::fill_n(row(property, index), size_, Scalar());
  }
  void swap(OpenMesh::BaseProperty& property, std::size_t index, OpenMesh::BaseProperty& place,
            std::size_t kept) const override {
    Scalar* values = row(property, index);
    std::swap_ranges(values, values + size_, kept_in(place) + kept * size_);
  }
  void set_each(OpenMesh::BaseProperty& property, std::span<const std::uint32_t> indices,
                const OpenMesh::BaseProperty& place) const override {
    if (indices.empty()) return;
    const Scalar* kept = kept_in(place);
    Scalar* const all = row(property, 0);
    for (const std::uint32_t i : indices) std::copy_n(kept, size_, all + i * size_), kept += size_;
  }
  void swap_each(OpenMesh::BaseProperty& property, std::span<const std::uint32_t> indices,
                 OpenMesh::BaseProperty& place) const override {
    if (indices.empty()) return;
    Scalar* kept = kept_in(place);
    Scalar* const all = row(property, 0);
    for (const std::uint32_t i : indices) std::swap_ranges(kept, kept + size_, all + i * size_), kept += size_;
  }

 private:
  Scalar* row(OpenMesh::BaseProperty& property, std::size_t index) const { return numbers_(property) + index * size_; }
  /// The numbers in a place: in one made here as they are, in a property of the type as rows.
  Scalar* kept_in(OpenMesh::BaseProperty& place) const {
    return typeid(place) == typeid(Place) ? static_cast<Place&>(place).data_vector().data() : numbers_(place);
  }
  const Scalar* kept_in(const OpenMesh::BaseProperty& place) const {
    return kept_in(const_cast<OpenMesh::BaseProperty&>(place));
  }
  // OpenMesh hands out values of constant properties only one by one.
  const Scalar* row(const OpenMesh::BaseProperty& property, std::size_t index) const {
    return row(const_cast<OpenMesh::BaseProperty&>(property), index);
  }

  Numbers<Scalar> numbers_;
  std::size_t size_;
  bool blends_;
};

template <class... T>
void add_all(PropertyTypes& types) {
  (types.add<T>(), ...);
}

template <class Scalar, class... Row>
void add_rows(PropertyTypes& types) {
  static_assert(((sizeof(Row) % sizeof(Scalar) == 0 && sizeof(Row) <= 16 * sizeof(Scalar)) && ...));
  (types.add(typeid(OpenMesh::PropertyT<Row>),
             std::make_shared<RowType<Scalar>>(&numbers_of<Row, Scalar>, sizeof(Row) / sizeof(Scalar),
                                               property_values::blends<Row>())),
   ...);
}

template <class Scalar>
void add_vectors(PropertyTypes& types) {
  add_rows<Scalar, Scalar, OpenMesh::VectorT<Scalar, 1>, OpenMesh::VectorT<Scalar, 2>, OpenMesh::VectorT<Scalar, 3>,
           OpenMesh::VectorT<Scalar, 4>, OpenMesh::VectorT<Scalar, 5>, OpenMesh::VectorT<Scalar, 6>>(types);
  add_all<std::vector<Scalar>>(types);
}

template <class Scalar>
void add_eigen(PropertyTypes& types) {
  add_rows<Scalar, Eigen::Matrix<Scalar, 2, 1>, Eigen::Matrix<Scalar, 3, 1>, Eigen::Matrix<Scalar, 4, 1>,
           Eigen::Matrix<Scalar, 1, 2>, Eigen::Matrix<Scalar, 1, 3>, Eigen::Matrix<Scalar, 1, 4>,
           Eigen::Matrix<Scalar, 2, 2>, Eigen::Matrix<Scalar, 3, 3>, Eigen::Matrix<Scalar, 4, 4>>(types);
}

PropertyTypes make_standard_types() {
  PropertyTypes types(nullptr);
  add_vectors<signed char>(types);
  add_vectors<unsigned char>(types);
  add_vectors<short>(types);
  add_vectors<unsigned short>(types);
  add_vectors<int>(types);
  add_vectors<unsigned>(types);
  add_vectors<float>(types);
  add_vectors<double>(types);
  add_rows<char, char>(types);
  add_rows<long, long>(types);
  add_rows<unsigned long, unsigned long>(types);
  add_rows<long long, long long>(types);
  add_rows<unsigned long long, unsigned long long>(types);
  add_rows<long double, long double>(types);
  add_all<bool, std::string, std::vector<std::string>>(types);
  add_all<VertexHandle, EdgeHandle, HalfedgeHandle, FaceHandle, OpenMesh::Attributes::StatusInfo>(types);
  add_eigen<float>(types);
  add_eigen<double>(types);
  add_eigen<int>(types);
  add_all<Mesh::VertexData, Mesh::EdgeData, Mesh::HalfedgeData, Mesh::FaceData>(types);
  return types;
}

}  // namespace

const PropertyTypes& PropertyTypes::standard() {
  static const PropertyTypes types = make_standard_types();
  return types;
}

const std::shared_ptr<const PropertyType>* PropertyTypes::look_up(const OpenMesh::BaseProperty& property) const {
  const std::type_index type = typeid(property);
  for (const PropertyTypes* types = this; types; types = types->base_)
    if (const auto it = types->own_.find(type); it != types->own_.end()) return &it->second;
  return nullptr;
}

const PropertyType* PropertyTypes::find(const OpenMesh::BaseProperty& property) const {
  const auto* found = look_up(property);
  return found ? found->get() : nullptr;
}

std::shared_ptr<const PropertyType> PropertyTypes::share(const OpenMesh::BaseProperty& property) const {
  const auto* found = look_up(property);
  return found ? *found : nullptr;
}

}  // namespace tri

#pragma once

#include <Eigen/Core>
#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Utils/Property.hh>
#include <cstddef>
#include <span>

namespace tri {

/// The values of a property that holds a number, or a vector of numbers, for each element. Valid as long as the
/// property is neither resized nor removed.
template <class Number>
struct NumberRows {
  std::span<const Number> numbers;  ///< `size` of the first element, then of the second, …
  int size = 1;                     ///< numbers of an element, 1 to 6
  bool vector = false;              ///< whether it holds vectors, which may have one number

  std::size_t elements() const { return numbers.size() / static_cast<std::size_t>(size); }
  /// @param element  in [0, elements)  @param k  in [0, size)
  Number operator()(std::size_t element, int k = 0) const {
    return numbers[element * static_cast<std::size_t>(size) + static_cast<std::size_t>(k)];
  }
};

namespace number_properties_detail {

template <class Number>
bool find_number(const OpenMesh::BaseProperty& property, NumberRows<Number>& rows) {
  const auto* typed = dynamic_cast<const OpenMesh::PropertyT<Number>*>(&property);
  if (typed) rows.numbers = {typed->data(), typed->n_elements()};
  return typed != nullptr;
}

template <class Vector, class Number>
bool find_vector(const OpenMesh::BaseProperty& property, NumberRows<Number>& rows) {
  const auto* typed = dynamic_cast<const OpenMesh::PropertyT<Vector>*>(&property);
  if (!typed) return false;
  constexpr std::size_t size = sizeof(Vector) / sizeof(Number);
  const std::size_t n = typed->n_elements();
  rows = {{n ? typed->data()->data() : nullptr, n * size}, static_cast<int>(size), true};
  return true;
}

template <class... Vector, class Number>
bool find_any(const OpenMesh::BaseProperty& property, NumberRows<Number>& rows) {
  return (find_vector<Vector>(property, rows) || ...);
}

template <class Number, class Visit>
bool visit_number(const OpenMesh::BaseProperty& property, const Visit& visit) {
  NumberRows<Number> rows;
  const bool found = find_number(property, rows);
  if (found) visit(rows);
  return found;
}

template <class N>
bool find_openmesh(const OpenMesh::BaseProperty& property, NumberRows<N>& rows) {
  using OpenMesh::VectorT;
  return find_any<VectorT<N, 1>, VectorT<N, 2>, VectorT<N, 3>, VectorT<N, 4>, VectorT<N, 5>, VectorT<N, 6>>(property,
                                                                                                            rows);
}

template <class N>
bool find_eigen(const OpenMesh::BaseProperty& property, NumberRows<N>& rows) {
  using Eigen::Matrix;
  return find_any<Matrix<N, 2, 1>, Matrix<N, 3, 1>, Matrix<N, 4, 1>, Matrix<N, 1, 2>, Matrix<N, 1, 3>, Matrix<N, 1, 4>>(
      property, rows);
}

template <class Number, class Visit>
bool visit_openmesh(const OpenMesh::BaseProperty& property, const Visit& visit) {
  NumberRows<Number> rows;
  const bool found = find_number(property, rows) || find_openmesh(property, rows);
  if (found) visit(rows);
  return found;
}

template <class Number, class Visit>
bool visit_all(const OpenMesh::BaseProperty& property, const Visit& visit) {
  NumberRows<Number> rows;
  const bool found = find_number(property, rows) || find_openmesh(property, rows) || find_eigen(property, rows);
  if (found) visit(rows);
  return found;
}

}  // namespace number_properties_detail

/// Calls `visit(const NumberRows<Number>&)` if the property holds a number, or a vector of them, for each element: any
/// type of number but bool, OpenMesh's vectors of one to six, Eigen's of two to four.
/// @return whether it does
template <class Visit>
bool visit_numbers(const OpenMesh::BaseProperty& property, const Visit& visit) {
  using namespace number_properties_detail;
  return visit_all<double>(property, visit) || visit_all<float>(property, visit) || visit_all<int>(property, visit) ||
         visit_openmesh<unsigned>(property, visit) || visit_openmesh<short>(property, visit) ||
         visit_openmesh<unsigned short>(property, visit) || visit_openmesh<signed char>(property, visit) ||
         visit_openmesh<unsigned char>(property, visit) || visit_number<char>(property, visit) ||
         visit_number<long>(property, visit) || visit_number<unsigned long>(property, visit) ||
         visit_number<long long>(property, visit) || visit_number<unsigned long long>(property, visit);
}

}  // namespace tri

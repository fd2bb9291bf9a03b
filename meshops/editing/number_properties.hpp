#pragma once

#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Utils/Property.hh>

#include <Eigen/Core>
#include <type_traits>

namespace tri {

namespace number_properties_detail {

/// Calls `visit(const PropertyT<T>&)` if the property is of type T.
template <class T, class Visit>
bool visit_as(const OpenMesh::BaseProperty& property, const Visit& visit) {
  const auto* typed = dynamic_cast<const OpenMesh::PropertyT<T>*>(&property);
  if (typed) visit(*typed);
  return typed != nullptr;
}

template <class... T, class Visit>
bool visit_any(const OpenMesh::BaseProperty& property, const Visit& visit) {
  return (visit_as<T>(property, visit) || ...);
}

template <class S, class Visit>
bool visit_vectors_of(const OpenMesh::BaseProperty& property, const Visit& visit) {
  return visit_any<OpenMesh::VectorT<S, 1>, OpenMesh::VectorT<S, 2>, OpenMesh::VectorT<S, 3>, OpenMesh::VectorT<S, 4>,
                   OpenMesh::VectorT<S, 5>, OpenMesh::VectorT<S, 6>>(property, visit);
}

template <class S, class Visit>
bool visit_eigen(const OpenMesh::BaseProperty& property, const Visit& visit) {
  return visit_any<Eigen::Matrix<S, 2, 1>, Eigen::Matrix<S, 3, 1>, Eigen::Matrix<S, 4, 1>, Eigen::Matrix<S, 1, 2>,
                   Eigen::Matrix<S, 1, 3>, Eigen::Matrix<S, 1, 4>>(property, visit);
}

template <class T>
struct Row;
template <class S, int n>
struct Row<OpenMesh::VectorT<S, n>> {
  using Number = S;
  static constexpr int size = n;
};
template <class S, int rows, int columns>
struct Row<Eigen::Matrix<S, rows, columns>> {
  using Number = S;
  static constexpr int size = rows * columns;
};

}  // namespace number_properties_detail

/// Numbers in a vector of fixed size.
template <class T>
inline constexpr int row_size = number_properties_detail::Row<T>::size;
/// Their type.
template <class T>
using RowNumber = typename number_properties_detail::Row<T>::Number;

/// Calls `visit(const OpenMesh::PropertyT<T>&)` if the property holds one number or bool for each element.
/// @return whether it does
template <class Visit>
bool visit_numbers(const OpenMesh::BaseProperty& property, const Visit& visit) {
  return number_properties_detail::visit_any<double, float, int, unsigned, bool, short, unsigned short, char, signed char,
                                             unsigned char, long, unsigned long, long long, unsigned long long>(property, visit);
}

/// The same for vectors of numbers: OpenMesh's of one to six, Eigen's of two to four.
template <class Visit>
bool visit_rows(const OpenMesh::BaseProperty& property, const Visit& visit) {
  using namespace number_properties_detail;
  return visit_vectors_of<double>(property, visit) || visit_vectors_of<float>(property, visit) ||
         visit_vectors_of<int>(property, visit) || visit_vectors_of<unsigned>(property, visit) ||
         visit_vectors_of<short>(property, visit) || visit_vectors_of<unsigned short>(property, visit) ||
         visit_vectors_of<signed char>(property, visit) || visit_vectors_of<unsigned char>(property, visit) ||
         visit_eigen<double>(property, visit) || visit_eigen<float>(property, visit) || visit_eigen<int>(property, visit);
}

}  // namespace tri

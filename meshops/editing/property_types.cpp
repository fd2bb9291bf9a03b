#include "meshops/mesh.hpp"

#include "meshops/editing/property_types.hpp"

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace tri {
namespace {

template <class... T>
void add_all(PropertyTypes& types) {
  (types.add<T>(), ...);
}

template <class Scalar>
void add_vectors(PropertyTypes& types) {
  add_all<Scalar, OpenMesh::VectorT<Scalar, 1>, OpenMesh::VectorT<Scalar, 2>, OpenMesh::VectorT<Scalar, 3>,
          OpenMesh::VectorT<Scalar, 4>, OpenMesh::VectorT<Scalar, 5>, OpenMesh::VectorT<Scalar, 6>, std::vector<Scalar>>(types);
}

template <class Scalar>
void add_eigen(PropertyTypes& types) {
  add_all<Eigen::Matrix<Scalar, 2, 1>, Eigen::Matrix<Scalar, 3, 1>, Eigen::Matrix<Scalar, 4, 1>, Eigen::Matrix<Scalar, 1, 2>,
          Eigen::Matrix<Scalar, 1, 3>, Eigen::Matrix<Scalar, 1, 4>, Eigen::Matrix<Scalar, 2, 2>, Eigen::Matrix<Scalar, 3, 3>,
          Eigen::Matrix<Scalar, 4, 4>>(types);
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
  add_all<bool, char, long, unsigned long, long long, unsigned long long, long double>(types);
  add_all<std::string, std::vector<std::string>>(types);
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

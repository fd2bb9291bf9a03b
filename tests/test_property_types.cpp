#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "meshops/editing/property_types.hpp"
#include "meshops/mesh.hpp"

using namespace tri;

TEST_CASE_TEMPLATE("PropertyType: many values are set and swapped as each of them is", T, bool, int, Vec3,
                   std::string) {
  constexpr int size = 40;
  const auto value = [](int i) {
    if constexpr (std::is_same_v<T, Vec3>)
      return Vec3(i, -i, 2 * i);
    else if constexpr (std::is_same_v<T, std::string>)
      return std::string(static_cast<std::size_t>(i), 'x');
    else
      return static_cast<T>(i % 3);
  };
  OpenMesh::PropertyT<T> at_first;
  for (int i = 0; i < size; ++i) at_first.push_back(), at_first[i] = value(i);
  const PropertyType* type = PropertyTypes::standard().find(at_first);
  REQUIRE(type);
  const auto same = [&](const OpenMesh::PropertyT<T>& a, const OpenMesh::PropertyT<T>& b) {
    for (int i = 0; i < size; ++i)
      if (!(a[i] == b[i])) return false;
    return true;
  };
  const std::vector<std::uint32_t> indices{7, 3, 39, 0, 20};
  OpenMesh::PropertyT<T> together = at_first, singly = at_first;
  const auto keep_some = [&] {
    auto place = type->make();
    for (const std::uint32_t i : indices) type->keep(at_first, i + (i < 20 ? 1 : 0), *place);
    return place;
  };
  const auto kept = keep_some(), kept_too = keep_some();

  type->swap_each(together, indices, *kept);
  for (std::size_t i = 0; i < indices.size(); ++i) type->swap(singly, indices[i], *kept_too, i);
  CHECK(same(together, singly));
  CHECK_FALSE(same(together, at_first));
  type->set_each(together, indices, *kept);
  CHECK(same(together, at_first));
  for (std::size_t i = 0; i < indices.size(); ++i) type->set(singly, indices[i], *kept_too, i);
  CHECK(same(singly, at_first));
}

TEST_CASE_TEMPLATE("PropertyType: another property of the type is a place too, and values are hashed alike in any", T,
                   int, float, OpenMesh::VectorT<float, 2>, Vec3, Eigen::Vector4d, std::string) {
  constexpr int size = 6;
  const auto value = [](int i) {
    if constexpr (std::is_same_v<T, std::string>) {
      return std::string(static_cast<std::size_t>(i), 'x');
    } else if constexpr (std::is_arithmetic_v<T>) {
      return static_cast<T>(i);
    } else {
      T v;
      for (int k = 0; k < static_cast<int>(v.size()); ++k)
        v[k] = static_cast<std::remove_cvref_t<decltype(v[0])>>(10 * i + k);
      return v;
    }
  };
  OpenMesh::PropertyT<T> property, other;
  for (int i = 0; i < size; ++i)
    property.push_back(), property[i] = value(i), other.push_back(), other[i] = value(size + i);
  const PropertyType* type = PropertyTypes::standard().find(property);
  REQUIRE(type);
  const auto place = type->make();
  for (int i = 0; i < size; ++i) type->keep(property, static_cast<std::size_t>(i), *place);
  for (std::size_t i = 0; i < size; ++i) {
    CAPTURE(i);
    CHECK(type->hash(property, i) == type->hash(*place, i));
    if (!std::is_same_v<T, std::string>) CHECK(type->hash(property, i) != type->hash(other, i));
  }

  type->set(property, 1, other, 4);
  CHECK(property[1] == value(size + 4));
  CHECK(other[4] == value(size + 4));
  type->swap(property, 2, other, 5);
  CHECK(property[2] == value(size + 5));
  CHECK(other[5] == value(2));
  for (const int i : {0, 3, 4, 5}) CHECK(property[i] == value(i));
  const std::vector<std::uint32_t> indices{5, 0};
  type->set_each(property, indices, other);
  CHECK(property[5] == value(size));
  CHECK(property[0] == value(size + 1));
  const std::vector<std::uint32_t> more{3, 4};
  type->swap_each(property, more, other);
  CHECK(property[3] == value(size));
  CHECK(property[4] == value(size + 1));
  CHECK(other[0] == value(3));
  CHECK(other[1] == value(4));
}

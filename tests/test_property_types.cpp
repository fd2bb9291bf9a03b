#include "meshops/mesh.hpp"

#include <doctest/doctest.h>

#include <numeric>
#include <string>
#include <vector>

#include "meshops/editing/property_types.hpp"

using namespace tri;

TEST_CASE_TEMPLATE("PropertyType: many values are set and swapped as each of them is", T, bool, int, Vec3, std::string) {
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

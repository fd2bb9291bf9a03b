#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "meshops/soup_edit.hpp"
#include "soup_shapes.hpp"

namespace tri::test {

/// What must hold of the attributes that `with_attributes` gave, whatever an operator did to the mesh: the values of
/// elements that stayed are those they had, and those of new elements are between the values that they were made of.
/// @param moved  vertices changed their place, or new ones stand beside those they were made of, so that scalar "x"
/// need not
///               be the coordinate any more
inline void check_attributes(const Soup& after, const Soup& before, bool moved) {
  CHECK_NOTHROW(check_soup(after));
  CHECK(after.face_labels == before.face_labels);
  REQUIRE(after.vertex_scalars.contains("x"));
  REQUIRE(after.corner_scalars.contains("x"));
  REQUIRE(after.face_scalars.contains("id"));
  REQUIRE(after.face_scalars.contains("group"));
  REQUIRE(after.vertex_colors.size() == after.points.size());
  REQUIRE(after.vertex_normals.size() == after.points.size());
  if (before.points.empty()) return;
  const auto [low, high] =
      std::minmax_element(before.vertex_scalars.at("x").begin(), before.vertex_scalars.at("x").end());
  std::size_t vertex_values = 0, corner_values = 0, colors = 0, normals = 0, faces = 0;
  const auto fits = [&, low = *low, high = *high](double value, const Vec3& p) {
    if (!moved) return std::abs(value - p[0]) <= 1e-9;
    return value >= low - 1e-9 && value <= high + 1e-9;
  };
  for (std::size_t i = 0; i < after.points.size(); ++i) {
    vertex_values += !fits(after.vertex_scalars.at("x")[i], after.points[i]);
    colors += after.vertex_colors[i][1] != 7 || after.vertex_colors[i][2] != 9;
    // Those of shells that were turned over are as well.
    normals +=
        !(std::abs(std::abs(after.vertex_normals[i][2]) - 1) < 1e-9 && after.vertex_normals[i].norm() < 1 + 1e-9);
  }
  for (std::size_t i = 0; i < after.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      corner_values += !fits(after.corner_scalars.at("x")[3 * i + k], after.points[after.triangles[i][k]]);
    // The group of a triangle still follows from the triangle that it comes from.
    const double id = after.face_scalars.at("id")[i];
    faces += id != std::floor(id) || !(id >= 0 && id < static_cast<double>(before.triangles.size())) ||
             after.face_scalars.at("group")[i] != std::fmod(id, 2);
  }
  CHECK(vertex_values == 0);
  CHECK(corner_values == 0);
  CHECK(colors == 0);
  CHECK(normals == 0);
  CHECK(faces == 0);
}

}  // namespace tri::test

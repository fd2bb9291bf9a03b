#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "meshops/soup.hpp"

namespace tri::test {

/// A box with 12 triangles that face outward, corners numbered by x, then y, then z.
inline Soup box(const Vec3& low, const Vec3& high) {
  Soup soup;
  for (int i = 0; i < 8; ++i)
    soup.points.emplace_back(i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
  soup.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return soup;
}
inline Soup cube(const Vec3& low = Vec3(0, 0, 0), double size = 1) {
  return box(low, low + Vec3(size, size, size));
}

/// A sphere of two poles and `rings` rings of `around` vertices; faces outward.
inline Soup sphere(int around, int rings, double radius = 1, const Vec3& center = Vec3(0, 0, 0)) {
  Soup soup;
  soup.points.push_back(center + Vec3(0, 0, -radius));
  for (int j = 1; j <= rings; ++j) {
    for (int i = 0; i < around; ++i) {
      const double a = 2 * std::numbers::pi * i / around,
                   b = std::numbers::pi * (static_cast<double>(j) / (rings + 1) - 0.5);
      soup.points.push_back(center + Vec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)) * radius);
    }
  }
  soup.points.push_back(center + Vec3(0, 0, radius));
  const auto last = static_cast<std::uint32_t>(soup.points.size() - 1);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(1 + (j - 1) * around + i % around); };
  for (int i = 0; i < around; ++i) {
    soup.triangles.push_back({0, at(i + 1, 1), at(i, 1)});
    for (int j = 1; j < rings; ++j) {
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    soup.triangles.push_back({at(i, rings), at(i + 1, rings), last});
  }
  return soup;
}

/// A sheet in z = 0 of columns x rows cells of size 1, two triangles each.
inline Soup sheet(int columns, int rows) {
  Soup soup;
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x <= columns; ++x) soup.points.emplace_back(x, y, 0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x), b = a + 1,
                 c = b + static_cast<std::uint32_t>(columns) + 1, d = c - 1;
      soup.triangles.push_back({a, b, c});
      soup.triangles.push_back({a, c, d});
    }
  }
  return soup;
}

/// Both soups, the second one's vertices after the first one's. Attributes are left out.
inline Soup joined(Soup a, const Soup& b) {
  const auto shift = static_cast<std::uint32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return a;
}

/// The same triangles, each with corners of its own, as in an STL file.
inline Soup exploded(const Soup& soup) {
  Soup result;
  for (const Triangle& t : soup.triangles) {
    const auto first = static_cast<std::uint32_t>(result.points.size());
    for (const std::uint32_t v : t) result.points.push_back(soup.points[v]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

inline Soup turned_around(Soup soup) {
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  return soup;
}

/// The same with every kind of attribute. The scalars "x" of vertices and corners are the coordinate, so that wherever
/// they are interpolated rightly they still are.
inline Soup with_attributes(Soup soup) {
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    soup.vertex_scalars["x"].push_back(soup.points[i][0]);
    soup.vertex_colors.push_back({static_cast<std::uint8_t>(i), 7, 9});
    soup.vertex_normals.emplace_back(0, 0, 1);
  }
  soup.face_labels["group"] = {"even", "odd"};
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    soup.face_scalars["id"].push_back(static_cast<double>(i));
    soup.face_scalars["group"].push_back(static_cast<double>(i % 2));
    for (const std::uint32_t v : soup.triangles[i]) soup.corner_scalars["x"].push_back(soup.points[v][0]);
  }
  return soup;
}

inline bool same_soup(const Soup& a, const Soup& b) {
  return a.points == b.points && a.triangles == b.triangles && a.vertex_scalars == b.vertex_scalars &&
         a.vertex_colors == b.vertex_colors && a.vertex_normals == b.vertex_normals &&
         a.face_scalars == b.face_scalars && a.face_labels == b.face_labels && a.corner_scalars == b.corner_scalars;
}

/// Enclosed by closed triangles, positive if they face outward.
inline double soup_volume(const Soup& soup) {
  double sum = 0;
  for (const Triangle& t : soup.triangles) sum += (soup.points[t[0]] | (soup.points[t[1]] % soup.points[t[2]])) / 6;
  return sum;
}
inline double soup_area(const Soup& soup) {
  double sum = 0;
  for (const Triangle& t : soup.triangles)
    sum += ((soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]])).norm() / 2;
  return sum;
}

}  // namespace tri::test

#include "meshops/soup_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "meshops/error.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

void check_length(const std::string& name, std::size_t have, std::size_t expected) {
  if (have != expected)
    throw InvalidInput(fmt::format("attribute {} has {} values instead of {}", name, have, expected));
}

/// Calls `visit(vector)` for every list that has one entry per point, positions included.
template <class Visit>
void for_point_lists(Soup& soup, const Visit& visit) {
  visit(soup.points);
  for (auto& [name, values] : soup.vertex_scalars) visit(values);
  if (!soup.vertex_colors.empty()) visit(soup.vertex_colors);
  if (!soup.vertex_normals.empty()) visit(soup.vertex_normals);
}

/// Weights of the corners of `t` at `p`, projected into its plane and moved to within its bounds.
Vec3 weights_in(const Soup& soup, const Triangle& t, const Vec3& p) {
  const Vec3 normal = area_vector(soup, t);
  Vec3 weights(1, 1, 1);
  if (const double size = normal.sqrnorm(); size > 0) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 &b = soup.points[t[(k + 1) % 3]], &c = soup.points[t[(k + 2) % 3]];
      weights[k] = std::max(0.0, (((b - p) % (c - p)) | normal) / size);
    }
  } else {
    // Without an area: between the ends of the longest side.
    int k = 0;
    for (int m = 1; m < 3; ++m)
      if ((soup.points[t[(m + 1) % 3]] - soup.points[t[m]]).sqrnorm() >
          (soup.points[t[(k + 1) % 3]] - soup.points[t[k]]).sqrnorm())
        k = m;
    const Vec3 &a = soup.points[t[k]], side = soup.points[t[(k + 1) % 3]] - a;
    const double share = side.sqrnorm() > 0 ? std::clamp(((p - a) | side) / side.sqrnorm(), 0.0, 1.0) : 0;
    weights = Vec3(0, 0, 0);
    weights[k] = 1 - share;
    weights[(k + 1) % 3] = share;
  }
  const double sum = weights[0] + weights[1] + weights[2];
  return sum > 0 ? weights / sum : Vec3(1, 1, 1) / 3;
}

/// With the face attributes of another one, and without those of corners.
void append_triangle(Soup& soup, const Triangle& triangle, std::uint32_t source) {
  soup.triangles.push_back(triangle);
  for (auto& [name, values] : soup.face_scalars) {
    const double value = values[source];
    values.push_back(value);
  }
}

}  // namespace

void check_soup(const Soup& soup, const Context* context) {
  Pace pace(context);
  const std::size_t points = soup.points.size(), triangles = soup.triangles.size();
  for (std::size_t i = 0; i < triangles; ++i) {
    pace();
    const auto [a, b, c] = soup.triangles[i];
    if (std::max({a, b, c}) >= points)
      throw InvalidInput(
          fmt::format("triangle {} names vertex {}, but there are {} points", i, std::max({a, b, c}), points));
  }
  for (const auto& [name, values] : soup.vertex_scalars) check_length(name, values.size(), points);
  for (const auto& [name, values] : soup.face_scalars) check_length(name, values.size(), triangles);
  for (const auto& [name, values] : soup.corner_scalars) check_length(name, values.size(), 3 * triangles);
  if (!soup.vertex_colors.empty()) check_length("vertex_colors", soup.vertex_colors.size(), points);
  if (!soup.vertex_normals.empty()) check_length("vertex_normals", soup.vertex_normals.size(), points);
}

double soup_diagonal(const Soup& soup) {
  if (soup.triangles.empty()) return 0;
  Vec3 low = soup.points[soup.triangles[0][0]], high = low;
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) low.minimize(soup.points[v]), high.maximize(soup.points[v]);
  return (high - low).norm();
}

void keep_triangles(Soup& soup, const std::vector<char>& keep, const Context* context) {
  Pace pace(context);
  const auto shrink = [&](auto& list, std::size_t per_triangle) {
    std::size_t end = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
      pace();
      if (keep[i / per_triangle]) list[end++] = list[i];
    }
    list.resize(end);
  };
  shrink(soup.triangles, 1);
  for (auto& [name, values] : soup.face_scalars) shrink(values, 1);
  for (auto& [name, values] : soup.corner_scalars) shrink(values, 3);
}

void renumber_points(Soup& soup, std::span<const std::uint32_t> number, std::size_t count, const Context* context) {
  Pace pace(context);
  std::vector<std::uint32_t> source(count, dropped_point);
  for (std::uint32_t i = 0; i < number.size(); ++i)
    if (number[i] != dropped_point && source[number[i]] == dropped_point) source[number[i]] = i;
  for_point_lists(soup, [&](auto& list) {
    auto old = std::exchange(list, {});
    list.reserve(count);
    for (const std::uint32_t i : source) {
      pace();
      list.push_back(old[i]);
    }
  });
  for (Triangle& t : soup.triangles) {
    pace();
    for (std::uint32_t& v : t) v = number[v];
  }
}

std::uint32_t copy_point(Soup& soup, std::uint32_t point) {
  for_point_lists(soup, [&](auto& list) {
    const auto value = list[point];
    list.push_back(value);
  });
  return static_cast<std::uint32_t>(soup.points.size() - 1);
}

std::uint32_t add_point_between(Soup& soup, std::uint32_t a, std::uint32_t b, double t) {
  soup.points.push_back(soup.points[a] * (1 - t) + soup.points[b] * t);
  for (auto& [name, values] : soup.vertex_scalars) values.push_back(values[a] * (1 - t) + values[b] * t);
  if (!soup.vertex_colors.empty()) {
    std::array<std::uint8_t, 3> color{};
    for (std::size_t k = 0; k < 3; ++k)
      color[k] =
          static_cast<std::uint8_t>(std::lround(soup.vertex_colors[a][k] * (1 - t) + soup.vertex_colors[b][k] * t));
    soup.vertex_colors.push_back(color);
  }
  if (!soup.vertex_normals.empty()) {
    const Vec3 sum = soup.vertex_normals[a] * (1 - t) + soup.vertex_normals[b] * t;
    soup.vertex_normals.push_back(sum.sqrnorm() > 0 ? sum / sum.norm() : soup.vertex_normals[a]);
  }
  return static_cast<std::uint32_t>(soup.points.size() - 1);
}

void move_point_between(Soup& soup, std::uint32_t a, std::uint32_t b, double t) {
  add_point_between(soup, a, b, t);
  for_point_lists(soup, [&](auto& list) {
    list[a] = list.back();
    list.pop_back();
  });
}

void add_triangle_in(Soup& soup, const Triangle& triangle, std::uint32_t source) {
  const Triangle from = soup.triangles[source];
  append_triangle(soup, triangle, source);
  if (soup.corner_scalars.empty()) return;
  for (const std::uint32_t v : triangle) {
    const auto same = std::ranges::find(from, v);
    Vec3 weights(0, 0, 0);
    if (same != from.end())
      weights[static_cast<std::size_t>(same - from.begin())] = 1;
    else
      weights = weights_in(soup, from, soup.points[v]);
    for (auto& [name, values] : soup.corner_scalars) {
      double value = 0;
      for (std::size_t k = 0; k < 3; ++k)
        if (weights[k] != 0) value += weights[k] * values[3 * source + k];
      values.push_back(value);
    }
  }
}

void add_triangle_from(Soup& soup, const Triangle& triangle, std::uint32_t source,
                       const std::array<std::size_t, 3>& corners) {
  append_triangle(soup, triangle, source);
  for (auto& [name, values] : soup.corner_scalars)
    for (const std::size_t corner : corners) {
      const double value = values[corner];
      values.push_back(value);
    }
}

void reverse_triangle(Soup& soup, std::uint32_t triangle) {
  std::swap(soup.triangles[triangle][1], soup.triangles[triangle][2]);
  for (auto& [name, values] : soup.corner_scalars) std::swap(values[3 * triangle + 1], values[3 * triangle + 2]);
}

}  // namespace tri

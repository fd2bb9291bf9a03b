#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Checks that every index is below the number of points and every attribute has its length.
/// @param context  null: cannot be cancelled
/// @throws InvalidInput naming the first triangle or attribute that has not; Cancelled.
void check_soup(const Soup& soup, const Context* context = nullptr);

/// True if the triangle names a vertex twice.
inline bool repeats_vertex(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Whether an even number of swaps sorts the corners; of two triangles with the same corners, whether they face the
/// same way is whether this is the same.
inline bool is_even(const Triangle& t) {
  return (t[0] < t[1]) == ((t[1] < t[2]) == (t[0] < t[2]));
}

/// Twice the area of a triangle, as a vector in the direction of its normal.
inline Vec3 area_vector(const Soup& soup, const Triangle& t) {
  return (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
}

/// Length of the diagonal of the box around all triangles; 0 if there are none.
double soup_diagonal(const Soup& soup);

// Every change below carries all attributes along; linear in what it touches unless it says otherwise.

/// Drops the triangles whose entry in `keep` is 0; the others keep their order. O(triangles).
/// @param context  null: cannot be cancelled
/// @throws Cancelled; the soup is then half done
void keep_triangles(Soup& soup, const std::vector<char>& keep, const Context* context = nullptr);

/// Gives the points new numbers. Point i becomes `number[i]`; where several get the same, the position and the
/// attributes of the first are taken. A point whose number is `dropped_point` goes; no triangle may name it. O(points +
/// triangles).
/// @param count how many points there are afterwards; every number below it occurs
/// @param context  null: cannot be cancelled
/// @throws Cancelled; the soup is then half done
inline constexpr std::uint32_t dropped_point = 0xffffffff;
void renumber_points(Soup& soup, std::span<const std::uint32_t> number, std::size_t count,
                     const Context* context = nullptr);

/// Appends a copy of a point and returns its index.
std::uint32_t copy_point(Soup& soup, std::uint32_t point);

/// Appends a point on the way from `a` to `b` and returns its index: positions, scalars, colours (rounded) and normals
/// (of unit length again) are interpolated.
/// @param t share of `b`, in [0,1]
std::uint32_t add_point_between(Soup& soup, std::uint32_t a, std::uint32_t b, double t);

/// Moves point `a` towards `b`, its attributes interpolated in the same way.
void move_point_between(Soup& soup, std::uint32_t a, std::uint32_t b, double t);

/// Appends a triangle with the face attributes of triangle `source`. Corner attributes come from the corner of `source`
/// that has the same point; a point that is no corner of it gets them interpolated where it lies in the plane of
/// `source`, within its bounds.
void add_triangle_in(Soup& soup, const Triangle& triangle, std::uint32_t source);

/// Appends a triangle with the face attributes of triangle `source`, and at each corner those of a corner of its own.
/// @param corners  of each: 3 triangle + corner
void add_triangle_from(Soup& soup, const Triangle& triangle, std::uint32_t source,
                       const std::array<std::size_t, 3>& corners);

/// Turns a triangle around: its second and third corner change places.
void reverse_triangle(Soup& soup, std::uint32_t triangle);

}  // namespace tri

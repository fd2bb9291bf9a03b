#pragma once

#include <array>
#include <cstdint>

#include "meshops/crossings/arrangement/wide_int.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A point of the integer grid on which crossings are resolved; coordinates within [0, 2^28].
using GridPoint = std::array<std::int64_t, 3>;
inline constexpr int grid_bits = 28;

/// Corners of a triangle on the grid.
using GridTriangle = std::array<GridPoint, 3>;

inline int sign_of(Int128 x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// Six times the volume of (a, b, c, d): positive if d lies on the side to which (b - a) x (c - a) points. Exact.
Int128 volume6(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d);
/// (b - a) x (c - a), exact.
GridPoint normal_of(const GridPoint& a, const GridPoint& b, const GridPoint& c);
/// The axis along which a vector is longest.
int longest_axis(const GridPoint& v);

/// The points x with normal . x = offset.
struct GridPlane {
  GridPoint normal{};
  Int128 offset = 0;
};
GridPlane plane_through(const GridTriangle& t);
/// The plane that holds the line (p, q) and the direction of `axis`.
GridPlane plane_along_axis(const GridPoint& p, const GridPoint& q, int axis);

/// A point with rational coordinates x / w, y / w, z / w: at most 210 and 180 bits where three planes meet that go
/// through points of the grid.
struct ExactPoint {
  std::array<WideInt<4>, 3> x;
  WideInt<4> w = 1;                ///< above 0
  std::array<double, 3> approx{};  ///< within 2^-22
  bool on_grid = false;            ///< w is 1

  GridPoint rounded() const;  ///< to the nearest point of the grid
};

ExactPoint exact(const GridPoint& p);
/// u + (v - u) share / whole, whole > 0.
ExactPoint at_share(const GridPoint& u, const GridPoint& v, Int128 share, Int128 whole);
/// Where the line through u and v meets a plane given by three points; `u` and `v` lie on different sides of it.
ExactPoint where_crosses(const GridPoint& u, const GridPoint& v, const GridTriangle& plane);
/// Where two lines (u, v) and (p, q) of one plane meet, which do not lie along each other after dropping `axis`.
ExactPoint where_meet(const GridPoint& u, const GridPoint& v, const GridPoint& p, const GridPoint& q, int axis);
/// Where three planes meet, which have one point in common.
ExactPoint common_point(const GridPlane& a, const GridPlane& b, const GridPlane& c);

/// Sign of a's coordinate minus b's.
int compare(const ExactPoint& a, const ExactPoint& b, int axis);
bool same_place(const ExactPoint& a, const ExactPoint& b);
/// Sign of the area of (a, b, c) seen along an axis: coordinates i and j are kept.
int turn(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, int i, int j);
/// The same for points of the grid.
int turn(const GridPoint& a, const GridPoint& b, const GridPoint& c, int i, int j);

}  // namespace tri

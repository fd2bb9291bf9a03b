#include "meshops/crossings/triangle_pair.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/crossings/predicates.hpp"

namespace tri {
namespace {

/// Sign of the volume of tetrahedron (a, b, c, d): as `orientation_exact`, decided here where a bound suffices.
inline int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 p = a - d, q = b - d, r = c - d;
  const double det = p | (q % r);
  double size = 1;
  for (int k = 0; k < 3; ++k) size *= std::max({std::abs(p[k]), std::abs(q[k]), std::abs(r[k])});
  // Shewchuk's static bound for the permanent: 7 eps times six products, each below the product of the extents.
  const double bound = 6 * 8e-16 * size;
  if (size > 1e-200 && det > bound) return 1;
  if (size > 1e-200 && det < -bound) return -1;
  return orientation_exact(a, b, c, d);
}

/// Sign of the area of (a, b, c) seen in the plane of coordinates `x` and `y`.
inline int turn_of(const Vec3& a, const Vec3& b, const Vec3& c, int x, int y) {
  const double l = (b[x] - a[x]) * (c[y] - a[y]), r = (b[y] - a[y]) * (c[x] - a[x]);
  const double det = l - r, size = std::abs(l) + std::abs(r);
  if (size > 1e-200 && std::abs(det) > 4e-15 * size) return det > 0 ? 1 : -1;
  return orientation_exact(Vec2(a[x], a[y]), Vec2(b[x], b[y]), Vec2(c[x], c[y]));
}

/// The plane of two coordinates in which triangle `t`, which has an area, has one as well.
std::array<int, 2> view_of(const std::array<Vec3, 3>& t) {
  const Vec3 n = (t[1] - t[0]) % (t[2] - t[0]);
  int drop = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[drop])) drop = k;
  for (int k = 0; k < 3; ++k, drop = (drop + 1) % 3)
    if (turn_of(t[0], t[1], t[2], (drop + 1) % 3, (drop + 2) % 3) != 0) break;
  return {(drop + 1) % 3, (drop + 2) % 3};
}

/// Whether segment (p, q), which does not lie in the plane of `t` with both ends on one side, meets triangle `t`.
bool segment_meets(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  int positive = 0, negative = 0;
  for (int k = 0; k < 3; ++k) {
    const int s = orientation(p, q, t[k], t[(k + 1) % 3]);
    positive += s > 0;
    negative += s < 0;
  }
  return positive == 0 || negative == 0;
}

bool coplanar_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const auto [x, y] = view_of(a);
  // Separating axis: two convex polygons are disjoint exactly if a side of one has the other strictly outside.
  for (const auto* pair : {&a, &b}) {
    const auto& first = *pair;
    const auto& second = pair == &a ? b : a;
    const int turn = turn_of(first[0], first[1], first[2], x, y);
    for (int k = 0; k < 3; ++k) {
      bool outside = true;
      for (const Vec3& p : second) outside &= turn_of(first[k], first[(k + 1) % 3], p, x, y) * turn < 0;
      if (outside) return false;
    }
  }
  return true;
}

/// Whether a segment in the plane of a triangle meets it: none of the lines of their sides separates them.
bool flat_segment_meets(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  const auto [x, y] = view_of(t);
  const int turn = turn_of(t[0], t[1], t[2], x, y);
  for (int k = 0; k < 3; ++k)
    if (turn_of(t[k], t[(k + 1) % 3], p, x, y) * turn < 0 && turn_of(t[k], t[(k + 1) % 3], q, x, y) * turn < 0)
      return false;
  int left = 0, right = 0;
  for (int k = 0; k < 3; ++k) {
    const int side = turn_of(p, q, t[k], x, y);
    left += side > 0;
    right += side < 0;
  }
  return left != 3 && right != 3;
}

/// Whether segment (p, q) meets triangle `t`, given on which sides of its plane the ends are.
bool side_meets(const Vec3& p, int at_p, const Vec3& q, int at_q, const std::array<Vec3, 3>& t) {
  if (at_p * at_q > 0) return false;
  return at_p == 0 && at_q == 0 ? flat_segment_meets(p, q, t) : segment_meets(p, q, t);
}

}  // namespace

bool triangles_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  int sa[3], sb[3];
  int above = 0, below = 0;
  for (int k = 0; k < 3; ++k) {
    sb[k] = orientation(a[0], a[1], a[2], b[k]);
    above += sb[k] > 0, below += sb[k] < 0;
  }
  if (above == 3 || below == 3) return false;
  if (above == 0 && below == 0) return coplanar_intersect(a, b);
  above = below = 0;
  for (int k = 0; k < 3; ++k) {
    sa[k] = orientation(b[0], b[1], b[2], a[k]);
    above += sa[k] > 0, below += sa[k] < 0;
  }
  if (above == 3 || below == 3) return false;
  // Each crosses the other's plane: they meet exactly if a side of one meets the other.
  for (int k = 0; k < 3; ++k) {
    const int m = (k + 1) % 3;
    if (sb[k] * sb[m] <= 0 && !(sb[k] == 0 && sb[m] == 0) && segment_meets(b[k], b[m], a)) return true;
    if (sa[k] * sa[m] <= 0 && !(sa[k] == 0 && sa[m] == 0) && segment_meets(a[k], a[m], b)) return true;
  }
  return false;
}

bool fans_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const int b1 = orientation(a[0], a[1], a[2], b[1]), b2 = orientation(a[0], a[1], a[2], b[2]);
  if (b1 * b2 > 0) return false;  // then the planes meet in a line through the corner that leaves b on one side of a
  const int a1 = orientation(b[0], b[1], b[2], a[1]), a2 = orientation(b[0], b[1], b[2], a[2]);
  return side_meets(b[1], b1, b[2], b2, a) || side_meets(a[1], a1, a[2], a2, b);
}

bool wings_overlap(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  if (orientation(p, q, a, b) != 0) return false;
  const auto [x, y] = view_of({p, q, a});
  return turn_of(p, q, a, x, y) == turn_of(p, q, b, x, y);
}

bool segment_pierces(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  if (orientation(t[0], t[1], t[2], p) * orientation(t[0], t[1], t[2], q) >= 0) return false;
  const int side = orientation(p, q, t[0], t[1]);
  return side != 0 && side == orientation(p, q, t[1], t[2]) && side == orientation(p, q, t[2], t[0]);
}

bool triangle_has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  // Far above the rounding of the product the corners are not on one line.
  return (ab % ac).sqrnorm() > 1e-24 * ab.sqrnorm() * ac.sqrnorm() || !collinear_exact(a, b, c);
}

bool triangles_meet(const std::array<std::uint32_t, 3>& t, const std::array<Vec3, 3>& at_t,
                    const std::array<std::uint32_t, 3>& u, const std::array<Vec3, 3>& at_u) {
  std::size_t shared = 0, in_t[3] = {0, 0, 0}, in_u[3] = {0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (t[i] == u[j]) in_t[shared] = i, in_u[shared] = j, ++shared;
  if (shared == 0) return triangles_intersect(at_t, at_u);
  if (shared == 3) return true;
  if (shared == 2)
    return wings_overlap(at_t[in_t[0]], at_t[in_t[1]], at_t[3 - in_t[0] - in_t[1]], at_u[3 - in_u[0] - in_u[1]]);
  const std::size_t i = in_t[0], j = in_u[0];
  return fans_intersect({at_t[i], at_t[(i + 1) % 3], at_t[(i + 2) % 3]},
                        {at_u[j], at_u[(j + 1) % 3], at_u[(j + 2) % 3]});
}

}  // namespace tri

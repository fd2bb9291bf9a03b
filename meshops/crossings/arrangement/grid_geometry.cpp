#include "meshops/crossings/arrangement/grid_geometry.hpp"

#include <cmath>

namespace tri {
namespace {

using Wide4 = WideInt<4>;

GridPoint minus(const GridPoint& a, const GridPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

GridPoint cross(const GridPoint& a, const GridPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Int128 dot(const GridPoint& a, const GridPoint& b) {
  return static_cast<Int128>(a[0]) * b[0] + static_cast<Int128>(a[1]) * b[1] + static_cast<Int128>(a[2]) * b[2];
}

void approximate(ExactPoint& p) {
  const double w = p.w.to_double();
  for (int k = 0; k < 3; ++k) p.approx[k] = p.x[k].to_double() / w;
}

ExactPoint between(const GridPoint& u, const GridPoint& v, Int128 n, Int128 d) {
  return d < 0 ? at_share(u, v, -n, -d) : at_share(u, v, n, d);
}

}  // namespace

GridPoint normal_of(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return cross(minus(b, a), minus(c, a));
}

Int128 volume6(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  return dot(normal_of(a, b, c), minus(d, a));
}

int longest_axis(const GridPoint& v) {
  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(v[k]) > std::abs(v[longest])) longest = k;
  return longest;
}

GridPlane plane_through(const GridTriangle& t) {
  GridPlane plane;
  plane.normal = normal_of(t[0], t[1], t[2]);
  plane.offset = dot(plane.normal, t[0]);
  return plane;
}

GridPlane plane_along_axis(const GridPoint& p, const GridPoint& q, int axis) {
  GridPoint direction{};
  direction[axis] = 1;
  GridPlane plane;
  plane.normal = cross(minus(q, p), direction);
  plane.offset = dot(plane.normal, p);
  return plane;
}

GridPoint ExactPoint::rounded() const {
  GridPoint result;
  for (int k = 0; k < 3; ++k) {
    auto r = static_cast<std::int64_t>(std::floor(approx[k] + 0.5));
    if (!on_grid && std::abs(approx[k] + 0.5 - std::round(approx[k] + 0.5)) < 0x1p-20) {
      // So near the middle between two that the approximation does not tell: the largest r with r - 1/2 <= x / w.
      const WideInt<5> twice = WideInt<5>(x[k]).shifted(1);
      const auto reaches = [&](std::int64_t candidate) {
        return (twice - product<5>(w, WideInt<1>(2 * candidate - 1))).sign() >= 0;
      };
      while (!reaches(r)) --r;
      while (reaches(r + 1)) ++r;
    }
    result[k] = r;
  }
  return result;
}

ExactPoint exact(const GridPoint& p) {
  ExactPoint result;
  for (int k = 0; k < 3; ++k) result.x[k] = p[k], result.approx[k] = static_cast<double>(p[k]);
  result.on_grid = true;
  return result;
}

ExactPoint at_share(const GridPoint& u, const GridPoint& v, Int128 share, Int128 whole) {
  ExactPoint p;
  p.w = Wide4::from_int128(whole);
  const Wide4 along = Wide4::from_int128(share);
  for (int k = 0; k < 3; ++k) p.x[k] = product<4>(p.w, WideInt<1>(u[k])) + product<4>(along, WideInt<1>(v[k] - u[k]));
  approximate(p);
  return p;
}

ExactPoint where_crosses(const GridPoint& u, const GridPoint& v, const GridTriangle& plane) {
  const Int128 at_u = volume6(plane[0], plane[1], plane[2], u), at_v = volume6(plane[0], plane[1], plane[2], v);
  return between(u, v, at_u, at_u - at_v);
}

ExactPoint where_meet(const GridPoint& u, const GridPoint& v, const GridPoint& p, const GridPoint& q, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const auto area = [&](const GridPoint& x) {
    return static_cast<Int128>(q[i] - p[i]) * (x[j] - p[j]) - static_cast<Int128>(q[j] - p[j]) * (x[i] - p[i]);
  };
  const Int128 at_u = area(u), at_v = area(v);
  return between(u, v, at_u, at_u - at_v);
}

ExactPoint common_point(const GridPlane& a, const GridPlane& b, const GridPlane& c) {
  // Cramer's rule, with the 2 x 2 minors of b and c taken once.
  using W1 = WideInt<1>;
  const auto minor = [&](int i, int j) {
    return product<4>(W1(b.normal[i]), W1(c.normal[j])) - product<4>(W1(b.normal[j]), W1(c.normal[i]));
  };
  const std::array<Wide4, 3> m{minor(1, 2), minor(2, 0), minor(0, 1)};
  const Wide4 ca = Wide4::from_int128(a.offset), cb = Wide4::from_int128(b.offset), cc = Wide4::from_int128(c.offset);
  ExactPoint p;
  p.w = Wide4(0);
  for (int k = 0; k < 3; ++k) p.w = p.w + product<4>(m[k], W1(a.normal[k]));
  // x = (offset_a (b x c) + offset_b (c x a) + offset_c (a x b)) / (a . (b x c))
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const auto cross_at = [&](const GridPoint& s, const GridPoint& t) {
      return product<4>(W1(s[i]), W1(t[j])) - product<4>(W1(s[j]), W1(t[i]));
    };
    p.x[k] = product<4>(ca, m[k]) + product<4>(cb, cross_at(c.normal, a.normal)) +
             product<4>(cc, cross_at(a.normal, b.normal));
  }
  if (p.w.negative()) {
    p.w = -p.w;
    for (Wide4& x : p.x) x = -x;
  }
  approximate(p);
  return p;
}

int compare(const ExactPoint& a, const ExactPoint& b, int axis) {
  const double difference = a.approx[axis] - b.approx[axis];
  if (a.on_grid && b.on_grid) return difference > 0 ? 1 : difference < 0 ? -1 : 0;
  if (std::abs(difference) > 0x1p-20) return difference > 0 ? 1 : -1;
  return (product<7>(a.x[axis], b.w) - product<7>(b.x[axis], a.w)).sign();
}

bool same_place(const ExactPoint& a, const ExactPoint& b) {
  for (int k = 0; k < 3; ++k)
    if (compare(a, b, k) != 0) return false;
  return true;
}

int turn(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, int i, int j) {
  const double bx = b.approx[i] - a.approx[i], by = b.approx[j] - a.approx[j];
  const double cx = c.approx[i] - a.approx[i], cy = c.approx[j] - a.approx[j];
  const double left = bx * cy, right = by * cx, det = left - right;
  const double error = 0x1p-20 * (std::abs(bx) + std::abs(by) + std::abs(cx) + std::abs(cy)) + 0x1p-40 +
                       0x1p-49 * (std::abs(left) + std::abs(right));
  if (det > error) return 1;
  if (det < -error) return -1;
  if (a.on_grid && b.on_grid && c.on_grid) {
    const auto whole = [](double x) { return static_cast<Int128>(x); };
    return sign_of(whole(bx) * whole(cy) - whole(by) * whole(cx));
  }
  const auto minor = [&](const ExactPoint& p, const ExactPoint& q) {
    return product<7>(p.x[i], q.x[j]) - product<7>(p.x[j], q.x[i]);
  };
  const auto times = [](const WideInt<7>& m, const WideInt<4>& w) { return product<10>(m, w); };
  return (times(minor(b, c), a.w) - times(minor(a, c), b.w) + times(minor(a, b), c.w)).sign();
}

int turn(const GridPoint& a, const GridPoint& b, const GridPoint& c, int i, int j) {
  return sign_of(static_cast<Int128>(b[i] - a[i]) * (c[j] - a[j]) - static_cast<Int128>(b[j] - a[j]) * (c[i] - a[i]));
}

}  // namespace tri

#include "meshops/self_intersections.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "meshops/box_tree.hpp"

namespace tri {
namespace {


int sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

template <class T>
T determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const T ax = T(a[0]) - T(d[0]), ay = T(a[1]) - T(d[1]), az = T(a[2]) - T(d[2]);
  const T bx = T(b[0]) - T(d[0]), by = T(b[1]) - T(d[1]), bz = T(b[2]) - T(d[2]);
  const T cx = T(c[0]) - T(d[0]), cy = T(c[1]) - T(d[1]), cz = T(c[2]) - T(d[2]);
  return ax * (by * cz - bz * cy) + bx * (cy * az - cz * ay) + cx * (ay * bz - az * by);
}

/// Sign of the volume of tetrahedron (a, b, c, d).
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double det = determinant<double>(a, b, c, d);
  double largest[3] = {0, 0, 0};
  for (int k = 0; k < 3; ++k) largest[k] = std::max({std::abs(a[k] - d[k]), std::abs(b[k] - d[k]), std::abs(c[k] - d[k])});
  // Shewchuk's static bound for the permanent: 7 eps times six products, each below the product of the extents.
  const double bound = 6 * 8e-16 * largest[0] * largest[1] * largest[2];
  if (det > bound || det < -bound) return sign(det);
  const __float128 wide = determinant<__float128>(a, b, c, d);
  return wide > 0 ? 1 : wide < 0 ? -1 : 0;
}

int orientation2(const Vec3& a, const Vec3& b, const Vec3& c, int x, int y) {
  const double l = (b[x] - a[x]) * (c[y] - a[y]), r = (b[y] - a[y]) * (c[x] - a[x]);
  const double det = l - r;
  if (std::abs(det) > 4e-15 * (std::abs(l) + std::abs(r))) return sign(det);
  using F = __float128;
  const F wide = (F(b[x]) - F(a[x])) * (F(c[y]) - F(a[y])) - (F(b[y]) - F(a[y])) * (F(c[x]) - F(a[x]));
  return wide > 0 ? 1 : wide < 0 ? -1 : 0;
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
  const Vec3 n = (a[1] - a[0]) % (a[2] - a[0]);
  int drop = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[drop])) drop = k;
  const int x = (drop + 1) % 3, y = (drop + 2) % 3;
  // Separating axis: two convex polygons are disjoint exactly if a side of one has the other strictly outside.
  for (const auto* pair : {&a, &b}) {
    const auto& first = *pair;
    const auto& second = pair == &a ? b : a;
    const int turn = orientation2(first[0], first[1], first[2], x, y);
    for (int k = 0; k < 3; ++k) {
      bool outside = true;
      for (const Vec3& p : second) outside &= orientation2(first[k], first[(k + 1) % 3], p, x, y) * turn < 0;
      if (outside) return false;
    }
  }
  return true;
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

std::vector<std::array<std::uint32_t, 2>> self_intersections(std::span<const Vec3> points, std::span<const Triangle> triangles,
                                                             const Context& context) {
  std::vector<std::uint32_t> items;
  items.reserve(triangles.size());
  std::vector<Box> boxes(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Vec3& p = points[triangles[t][0]];
    if (!(((points[triangles[t][1]] - p) % (points[triangles[t][2]] - p)).sqrnorm() > 0)) continue;
    items.push_back(t);
    for (std::uint32_t v : triangles[t]) boxes[t].grow(points[v]);
  }
  const BoxTree tree(std::move(boxes), std::move(items));
  using Pairs = std::vector<std::array<std::uint32_t, 2>>;
  tbb::enumerable_thread_specific<Pairs> found;
  const auto search = [&](const tbb::blocked_range<std::size_t>& range) {
    if (context.cancelled()) return;
    Pairs& mine = found.local();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const std::uint32_t t = tree.items()[i];
      const Triangle& q = triangles[t];
      const std::array<Vec3, 3> a{points[q[0]], points[q[1]], points[q[2]]};
      tree.overlapping(tree.box(t), t + 1, [&](std::uint32_t u) {
        const Triangle& r = triangles[u];
        for (std::uint32_t v : q)
          if (v == r[0] || v == r[1] || v == r[2]) return;
        if (triangles_intersect(a, {points[r[0]], points[r[1]], points[r[2]]})) mine.push_back({t, u});
      });
    }
  };
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] { tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tree.items().size(), 1024), search); });
  context.checkpoint();
  Pairs pairs;
  for (const Pairs& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace tri

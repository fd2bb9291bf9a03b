#include "meshops/self_intersections.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>

#include "meshops/overlap_tree.hpp"

namespace tri {
namespace {

using Box = OverlapTree::Box;


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
  if (largest[0] == 0 || largest[1] == 0 || largest[2] == 0) return 0;  // in one plane across an axis
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

/// Spreads the lowest ten bits of `x` to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

/// Triangles sorted along a space-filling curve and cut into blocks; a tree holds the blocks' boxes, and within two overlapping
/// blocks every pair of boxes is compared in single precision (rounded outward), which the compiler does several at a time.
/// Searching for each triangle on its own costs three times as much.
class Blocks {
 public:
  Blocks(std::span<const Vec3> points, std::span<const Triangle> triangles) {
    Box all;
    for (const Vec3& p : points) all.grow(p);
    Vec3 scale(0, 0, 0);
    for (int k = 0; k < 3; ++k) scale[k] = all.hi[k] > all.lo[k] ? 1023.0 / (all.hi[k] - all.lo[k]) : 0;
    // The place on the curve in the upper half, the triangle in the lower.
    constexpr std::uint64_t no_area = std::uint64_t{1} << 63;
    std::vector<std::uint64_t> order(triangles.size());
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(triangles.size()), 4096), [&](const auto& range) {
      for (std::uint32_t t = range.begin(); t < range.end(); ++t) {
        const Vec3 &a = points[triangles[t][0]], &b = points[triangles[t][1]], &c = points[triangles[t][2]];
        std::uint64_t key = 0;
        for (int k = 0; k < 3; ++k) key |= spread(static_cast<std::uint64_t>(((a[k] + b[k] + c[k]) / 3 - all.lo[k]) * scale[k])) << k;
        // Triangles without area come last and are left out.
        if (!(((b - a) % (c - a)).sqrnorm() > 0)) key = no_area >> 32;
        order[t] = key << 32 | t;
      }
    });
    tbb::parallel_sort(order.begin(), order.end());
    while (!order.empty() && order.back() >= no_area) order.pop_back();
    items_.resize(order.size());
    corners_.resize(order.size());
    // The last block is filled up with boxes that overlap nothing.
    for (int k = 0; k < 6; ++k)
      sides_[k].assign((order.size() + block_size - 1) / block_size * block_size,
                       k < 3 ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity());
    const float below = -std::numeric_limits<float>::infinity(), above = std::numeric_limits<float>::infinity();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        items_[i] = static_cast<std::uint32_t>(order[i]);
        corners_[i] = triangles[items_[i]];
        Box box;
        for (std::uint32_t v : corners_[i]) box.grow(points[v]);
        for (int k = 0; k < 3; ++k) {
          sides_[k][i] = std::nextafter(static_cast<float>(box.lo[k]), below);
          sides_[k + 3][i] = std::nextafter(static_cast<float>(box.hi[k]), above);
        }
      }
    });
    std::vector<Box> boxes((order.size() + block_size - 1) / block_size);
    std::vector<std::uint32_t> ids(boxes.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      Box& box = boxes[i / block_size];
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = std::min(box.lo[k], static_cast<double>(sides_[k][i]));
        box.hi[k] = std::max(box.hi[k], static_cast<double>(sides_[k + 3][i]));
      }
    }
    std::iota(ids.begin(), ids.end(), 0u);
    tree_.emplace(std::move(boxes), std::move(ids));
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(tree_->items().size()); }

  /// Calls `visit(t, corners of t, u, corners of u)` for every pair of triangles with overlapping boxes, one in block `b`, the
  /// other in it or a later one.
  template <class Visit>
  void overlapping_pairs(std::uint32_t b, Visit visit) const {
    tree_->overlapping(tree_->box(b), b, [&](std::uint32_t c) {
      const std::size_t c_begin = std::size_t{c} * block_size;
      std::array<const float*, 6> side;
      for (int k = 0; k < 6; ++k) side[k] = sides_[k].data() + c_begin;
      const Box& other = tree_->box(c);
      for (std::size_t i = std::size_t{b} * block_size; i < std::min(std::size_t{b + 1} * block_size, items_.size()); ++i) {
        std::array<float, 6> s;
        for (int k = 0; k < 6; ++k) s[k] = sides_[k][i];
        if (s[0] > other.hi[0] || s[1] > other.hi[1] || s[2] > other.hi[2] || s[3] < other.lo[0] || s[4] < other.lo[1] || s[5] < other.lo[2])
          continue;
        std::array<std::uint8_t, block_size> hit;
        for (std::size_t j = 0; j < block_size; ++j)
          hit[j] = (side[0][j] <= s[3]) & (side[1][j] <= s[4]) & (side[2][j] <= s[5]) & (side[3][j] >= s[0]) &
                   (side[4][j] >= s[1]) & (side[5][j] >= s[2]);
        for (std::size_t eight = 0; eight < block_size; eight += 8) {
          std::uint64_t hits = 0;
          std::memcpy(&hits, hit.data() + eight, 8);
          for (; hits != 0; hits &= hits - 1) {  // a byte is 0 or 1
            const int byte = std::countr_zero(hits) / 8;
            const std::size_t m = c_begin + eight + (std::endian::native == std::endian::little ? byte : 7 - byte);
            if (b != c || m > i) visit(items_[i], corners_[i], items_[m], corners_[m]);
          }
        }
      }
    });
  }

 private:
  static constexpr std::size_t block_size = 32;
  std::vector<std::uint32_t> items_;
  std::vector<Triangle> corners_;
  std::array<std::vector<float>, 6> sides_;  // low x, y, z, high x, y, z
  std::optional<OverlapTree> tree_;
};

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
  const Blocks blocks(points, triangles);
  context.checkpoint();
  using Pairs = std::vector<std::array<std::uint32_t, 2>>;
  tbb::enumerable_thread_specific<Pairs> found;
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, blocks.size(), 32), [&](const auto& range) {
      if (context.cancelled()) return;
      Pairs& mine = found.local();
      for (std::uint32_t b = range.begin(); b < range.end(); ++b)
        blocks.overlapping_pairs(b, [&](std::uint32_t t, const Triangle& q, std::uint32_t u, const Triangle& r) {
          bool joined = false;  // without branches, since nobody can predict which corners are the same
          for (std::uint32_t v : q) joined |= (v == r[0]) | (v == r[1]) | (v == r[2]);
          if (joined) return;
          if (triangles_intersect({points[q[0]], points[q[1]], points[q[2]]}, {points[r[0]], points[r[1]], points[r[2]]}))
            mine.push_back({std::min(t, u), std::max(t, u)});
        });
    });
  });
  context.checkpoint();
  Pairs pairs;
  for (const Pairs& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace tri

#include "meshops/crossings/self_intersections.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "meshops/crossings/predicates.hpp"
#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/search/cancellable_sort.hpp"
#include "meshops/search/key_sort.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/search/spread_bits.hpp"

namespace tri {
namespace {

using BlockBox = OverlapTree::Box;

/// Triangles sorted along a space-filling curve and cut into blocks; a tree holds the blocks' boxes, and within two
/// overlapping blocks every pair of boxes is compared on a grid of 16 bits, which the compiler does eight at a time:
/// places keep their order when they are rounded to the grid, so no pair that overlaps is missed. Searching for each
/// triangle on its own costs three times as much.
class Blocks {
 public:
  Blocks(std::span<const Vec3> points, std::span<const Triangle> triangles, const Context& context) {
    BlockBox all;
    for (const Vec3& p : points) all.grow(p);
    Vec3 scale(0, 0, 0);
    for (int k = 0; k < 3; ++k) scale[k] = all.hi[k] > all.lo[k] ? grid / (all.hi[k] - all.lo[k]) : 0;
    const auto on_grid = [&](const Vec3& p, int k) {
      const double x = (p[k] - all.lo[k]) * scale[k];
      return x > 0 ? x < grid ? static_cast<std::uint32_t>(x) : grid : 0u;
    };
    std::vector<KeyedIndex> order(triangles.size());
    constexpr std::uint32_t no_area = std::uint32_t{1} << 30;
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(triangles.size()), 4096),
                      [&](const auto& range) {
                        context.checkpoint();
                        for (std::uint32_t t = range.begin(); t < range.end(); ++t) {
                          const Vec3 &a = points[triangles[t][0]], &b = points[triangles[t][1]],
                                     &c = points[triangles[t][2]];
                          std::uint32_t key = 0;
                          for (int k = 0; k < 3; ++k) key |= spread_bits(on_grid(a, k) >> 6) << k;
                          // Triangles without area come last and are left out.
                          if (!triangle_has_area(a, b, c)) key = no_area;
                          order[t] = {key, t};
                        }
                      });
    context.checkpoint();
    sort_by_key(order, 31);
    context.checkpoint();
    while (!order.empty() && order.back().key == no_area) order.pop_back();
    items_.resize(order.size());
    corners_.resize(order.size());
    blocks_.resize((order.size() + block_size - 1) / block_size);
    std::vector<BlockBox> boxes(blocks_.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks_.size(), 128), [&](const auto& range) {
      context.checkpoint();
      for (std::size_t b = range.begin(); b < range.end(); ++b) {
        for (std::size_t j = 0; j < block_size; ++j) {
          const std::size_t i = b * block_size + j;
          if (i >= order.size()) {
            for (int k = 0; k < 3; ++k) blocks_[b].low[k][j] = 32767, blocks_[b].high[k][j] = -32768;
            continue;
          }
          items_[i] = order[i].index;
          corners_[i] = triangles[items_[i]];
          const Vec3 &p = points[corners_[i][0]], &q = points[corners_[i][1]], &r = points[corners_[i][2]];
          for (int k = 0; k < 3; ++k) {
            const std::uint32_t x = on_grid(p, k), y = on_grid(q, k), z = on_grid(r, k);
            blocks_[b].low[k][j] = static_cast<std::int16_t>(static_cast<int>(std::min({x, y, z})) - 32768);
            blocks_[b].high[k][j] = static_cast<std::int16_t>(static_cast<int>(std::max({x, y, z})) - 32768);
          }
          for (const Vec3* corner : {&p, &q, &r}) boxes[b].grow(*corner);
        }
      }
    });
    context.checkpoint();
    bounds_.resize(blocks_.size());
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      for (int k = 0; k < 3; ++k) {
        const auto& low = blocks_[b].low[k];
        const auto& high = blocks_[b].high[k];
        bounds_[b].low[k] = *std::min_element(low.begin(), low.end());
        bounds_[b].high[k] = *std::max_element(high.begin(), high.end());
      }
    std::vector<std::uint32_t> ids(boxes.size());
    std::iota(ids.begin(), ids.end(), 0u);
    tree_.emplace(std::move(boxes), std::move(ids), &context);
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(blocks_.size()); }

  /// Calls `visit(t, corners of t, u, corners of u)` for every pair of triangles with overlapping boxes, one in block
  /// `b`, the other in it or a later one; and for some whose boxes nearly do.
  template <class Visit>
  void overlapping_pairs(std::uint32_t b, Visit visit) const {
    const Block& own = blocks_[b];
    const std::size_t b_begin = std::size_t{b} * block_size;
    tree_->overlapping(tree_->box(b), b, [&](std::uint32_t c) {
      const Block& other = blocks_[c];
      const std::size_t c_begin = std::size_t{c} * block_size;
      // Which of its own meet the other block at all, then for each of them which of the other's it meets.
      for (std::uint32_t mine = overlapping(own, bounds_[c]); mine != 0; mine &= mine - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(mine));
        std::uint32_t hits = overlapping(other, own.bounds(i));
        if (b == c) hits &= ~std::uint32_t{1} << i;  // later ones
        for (; hits != 0; hits &= hits - 1) {
          const std::size_t m = c_begin + static_cast<std::size_t>(std::countr_zero(hits));
          visit(items_[b_begin + i], corners_[b_begin + i], items_[m], corners_[m]);
        }
      }
    });
  }

 private:
  static constexpr std::size_t block_size = 32;
  static constexpr std::uint32_t grid = 65534;  // the last place is for boxes that overlap nothing
  struct Bounds {
    std::array<std::int16_t, 3> low, high;
  };
  struct Block {
    std::array<std::array<std::int16_t, block_size>, 3> low, high;  // x, y, z
    Bounds bounds(std::size_t i) const {
      return {{low[0][i], low[1][i], low[2][i]}, {high[0][i], high[1][i], high[2][i]}};
    }
  };

  /// Bit j: box j of the block overlaps the bounds.
  static std::uint32_t overlapping(const Block& block, const Bounds& with) {
    const auto [lx, ly, lz] = with.low;
    const auto [hx, hy, hz] = with.high;
    std::array<std::uint8_t, block_size> hit;  // 0 or 1
    for (std::size_t j = 0; j < block_size; ++j) {
      const auto apart =
          static_cast<std::int16_t>(-((block.low[0][j] > hx) | (block.low[1][j] > hy) | (block.low[2][j] > hz) |
                                      (block.high[0][j] < lx) | (block.high[1][j] < ly) | (block.high[2][j] < lz)));
      hit[j] = static_cast<std::uint8_t>(apart + 1);
    }
    std::uint32_t bits = 0;
    for (std::size_t eight = 0; eight < block_size; eight += 8) {
      std::uint64_t bytes = 0;
      for (std::size_t k = 0; k < 8; ++k) bytes |= std::uint64_t{hit[eight + k]} << 8 * k;
      bits |= static_cast<std::uint32_t>(bytes * 0x0102040810204080u >> 56) << eight;
    }
    return bits;
  }

  std::vector<Bounds> bounds_;
  std::vector<std::uint32_t> items_;
  std::vector<Triangle> corners_;
  std::vector<Block> blocks_;
  std::optional<OverlapTree> tree_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 2>> self_intersections(std::span<const Vec3> points,
                                                             std::span<const Triangle> triangles,
                                                             const Context& context, Neighbors neighbors) {
  using Pairs = std::vector<std::array<std::uint32_t, 2>>;
  tbb::enumerable_thread_specific<Pairs> found;
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    const Blocks blocks(points, triangles, context);
    context.checkpoint();
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, blocks.size(), 32), [&](const auto& range) {
      context.checkpoint();
      Pairs& mine = found.local();
      for (std::uint32_t b = range.begin(); b < range.end(); ++b)
        blocks.overlapping_pairs(b, [&](std::uint32_t t, const Triangle& q, std::uint32_t u, const Triangle& r) {
          bool joined = false;  // without branches, since nobody can predict which corners are the same
          for (std::uint32_t v : q) joined |= (v == r[0]) | (v == r[1]) | (v == r[2]);
          if (joined && neighbors == Neighbors::skip) return;
          const std::array<Vec3, 3> at_q{points[q[0]], points[q[1]], points[q[2]]},
              at_r{points[r[0]], points[r[1]], points[r[2]]};
          if (joined ? triangles_meet(q, at_q, r, at_r) : triangles_intersect(at_q, at_r))
            mine.push_back({std::min(t, u), std::max(t, u)});
        });
    });
  });
  context.checkpoint();
  Pairs pairs;
  for (const Pairs& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  cancellable_sort(pairs.begin(), pairs.end(), &context);
  return pairs;
}

}  // namespace tri

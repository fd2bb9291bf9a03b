#include "libtri/triangulation/spatial_order.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "libtri/surfaces/page_buffer.hpp"

namespace tri {
namespace {

struct KeyedPoint {
  std::uint64_t key;
  std::uint32_t index;

  friend bool operator<(const KeyedPoint& a, const KeyedPoint& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  }
};

constexpr int radix_bits = 11;
constexpr std::size_t radix = std::size_t{1} << radix_bits;
constexpr std::size_t small_bucket = 1536;
constexpr std::size_t curve_block = 1 << 16;

std::uint64_t spread_bits(std::uint32_t value) {  // bit i to bit 2i
  std::uint64_t v = value;
  v = (v | v << 16) & 0x0000ffff0000ffff;
  v = (v | v << 8) & 0x00ff00ff00ff00ff;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0f;
  v = (v | v << 2) & 0x3333333333333333;
  v = (v | v << 1) & 0x5555555555555555;
  return v;
}

// Maps a box to 32 bits per axis, monotonically; both axes at the same scale, so that the cuts leave squares.
class Quantizer {
 public:
  template <class PointAt>
  Quantizer(std::size_t count, PointAt point_at) {
    Vec2 low = point_at(0), high = low;
    for (std::size_t i = 1; i < count; ++i) {
      const Vec2& p = point_at(i);
      for (int k = 0; k < 2; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
    single_point_ = low == high;
    if (single_point_) return;
    // Halved where the extent could overflow, axis by axis, so that no axis loses its lowest bits to the other.
    int largest = -10000;
    for (int k = 0; k < 2; ++k) {
      halved_[k] = std::max(std::fabs(low[k]), std::fabs(high[k])) > 0x1p1000;
      before_[k] = halved_[k] ? 0.5 : 1.0;
      low_[k] = low[k] * before_[k];
      const double extent = high[k] * before_[k] - low_[k];
      if (extent > 0) largest = std::max(largest, std::ilogb(extent) + halved_[k]);
    }
    for (int k = 0; k < 2; ++k) {
      // Two steps, since the scale of the smallest extents is itself out of range. The larger extent fills [2^31,
      // 2^32).
      const int exponent = 31 - largest + halved_[k];
      first_[k] = std::ldexp(1.0, exponent / 2);
      second_[k] = std::ldexp(1.0, exponent - exponent / 2);
    }
  }
  bool single_point() const { return single_point_; }

  std::uint64_t key(const Vec2& p) const {
    std::uint32_t q[2];
    for (int k = 0; k < 2; ++k) {
      const double scaled = (p[k] * before_[k] - low_[k]) * first_[k] * second_[k];
      q[k] = static_cast<std::uint32_t>(std::min<std::int64_t>(static_cast<std::int64_t>(scaled), 0xffffffff));
    }
    return spread_bits(q[0]) << 1 | spread_bits(q[1]);
  }

 private:
  bool single_point_ = false;
  int halved_[2] = {0, 0};
  double before_[2] = {1, 1}, low_[2] = {0, 0}, first_[2] = {0, 0}, second_[2] = {0, 0};
};

// Sorts items whose keys agree above `top_bit` bits; `scratch` is as large.
void sort_serial(KeyedPoint* items, KeyedPoint* scratch, std::size_t count, int top_bit) {
  if (count <= small_bucket || top_bit <= 0) {
    std::sort(items, items + count);
    return;
  }
  const int bits = std::min(radix_bits, top_bit);
  const int shift = top_bit - bits;
  std::vector<std::uint32_t> start(radix + 1, 0);
  const std::uint64_t mask = radix - 1;
  for (std::size_t i = 0; i < count; ++i) ++start[(items[i].key >> shift & mask) + 1];
  for (std::size_t b = 0; b < radix; ++b) start[b + 1] += start[b];
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < count; ++i) scratch[next[items[i].key >> shift & mask]++] = items[i];
  std::copy(scratch, scratch + count, items);
  for (std::size_t b = 0; b < radix; ++b) {
    const std::size_t size = start[b + 1] - start[b];
    if (size > 1) sort_serial(items + start[b], scratch + start[b], size, shift);
  }
}

// One stable scatter by the highest bits, then every bucket by itself. Leaves the result in `items`.
void sort_items(PageBuffer<KeyedPoint>& items, std::size_t count) {
  auto scratch = PageBuffer<KeyedPoint>(count);
  if (count < 2 * curve_block) {
    sort_serial(items.get(), scratch.get(), count, 64);
    return;
  }
  const int shift = 64 - radix_bits;
  const std::size_t blocks = (count + curve_block - 1) / curve_block;
  std::vector<std::uint32_t> next(blocks * radix, 0);
  const auto for_block = [&](std::size_t block, auto&& visit) {
    const std::size_t end = std::min(count, (block + 1) * curve_block);
    for (std::size_t i = block * curve_block; i < end; ++i) visit(items[i]);
  };
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    std::uint32_t* histogram = next.data() + block * radix;
    for_block(block, [&](const KeyedPoint& item) { ++histogram[item.key >> shift]; });
  });
  std::vector<std::uint32_t> start(radix + 1, 0);
  std::uint32_t sum = 0;
  for (std::size_t b = 0; b < radix; ++b) {
    start[b] = sum;
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::uint32_t size = next[block * radix + b];
      next[block * radix + b] = sum;
      sum += size;
    }
  }
  start[radix] = sum;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    std::uint32_t* to = next.data() + block * radix;
    for_block(block, [&](const KeyedPoint& item) { scratch[to[item.key >> shift]++] = item; });
  });
  std::swap(items, scratch);
  tbb::parallel_for(std::size_t{0}, radix, [&](std::size_t b) {
    const std::size_t size = start[b + 1] - start[b];
    if (size > 1) sort_serial(items.get() + start[b], scratch.get() + start[b], size, shift);
  });
}

class Sorter {
 public:
  Sorter(std::span<const Vec2> points, SpatialOrder& result) : points_(points), result_(result) {}

  void run() {
    const std::size_t n = points_.size();
    result_.order.resize(n);
    for (std::size_t i = 0; i < n; ++i) result_.order[i] = static_cast<std::uint32_t>(i);
    result_.cuts.assign(n, 0);
    duplicate_of_previous_.assign(n, 0);
    if (n > 1) sort_range(0, n, 0);
    remove_duplicates();
  }

 private:
  void sort_range(std::size_t begin, std::size_t end, unsigned depth) {
    const std::size_t count = end - begin;
    const Quantizer quantizer(count, [&](std::size_t i) -> const Vec2& { return points_[result_.order[begin + i]]; });
    if (quantizer.single_point()) {
      // The one that came first is kept.
      std::sort(result_.order.begin() + static_cast<std::ptrdiff_t>(begin),
                result_.order.begin() + static_cast<std::ptrdiff_t>(end));
      for (std::size_t i = begin + 1; i < end; ++i) {
        duplicate_of_previous_[i] = 1;
        any_duplicate_ = true;
      }
      return;
    }
    auto items = PageBuffer<KeyedPoint>(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, curve_block), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const std::uint32_t index = result_.order[begin + i];
        items[i] = {quantizer.key(points_[index]), index};
      }
    });
    sort_items(items, count);
    std::vector<std::pair<std::size_t, std::size_t>> cells;  // runs of equal keys
    result_.order[begin] = items[0].index;
    for (std::size_t i = 1; i < count; ++i) {
      result_.order[begin + i] = items[i].index;
      const std::uint64_t difference = items[i].key ^ items[i - 1].key;
      if (difference != 0) {
        result_.cuts[begin + i] =
            static_cast<std::uint16_t>(depth + static_cast<unsigned>(std::countl_zero(difference)));
      } else if (!cells.empty() && cells.back().second == begin + i) {
        cells.back().second = begin + i + 1;
      } else {
        cells.emplace_back(begin + i - 1, begin + i + 1);
      }
    }
    items.reset();
    for (const auto& [first, last] : cells) sort_range(first, last, depth + 64);
  }

  void remove_duplicates() {
    if (!any_duplicate_) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < result_.order.size(); ++i) {
      if (duplicate_of_previous_[i]) {
        result_.duplicates.push_back({result_.order[i], result_.order[kept - 1]});
      } else {
        result_.order[kept] = result_.order[i];
        result_.cuts[kept++] = result_.cuts[i];
      }
    }
    result_.order.resize(kept);
    result_.cuts.resize(kept);
    std::sort(result_.duplicates.begin(), result_.duplicates.end());
  }

  std::span<const Vec2> points_;
  SpatialOrder& result_;
  std::vector<std::uint8_t> duplicate_of_previous_;
  bool any_duplicate_ = false;
};

}  // namespace

SpatialOrder spatial_order(std::span<const Vec2> points, const Context& context) {
  context.checkpoint();
  SpatialOrder result;
  Sorter(points, result).run();
  return result;
}

}  // namespace tri

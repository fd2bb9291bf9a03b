#include "libtri/triangulation/point_order.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "meshops/search/key_sort.hpp"

namespace tri {

namespace {

// Spreads ten bits so that two zeros stand between neighbours.
std::uint32_t spread(std::uint32_t x) {
  x = (x | (x << 16)) & 0x030000FFu;
  x = (x | (x << 8)) & 0x0300F00Fu;
  x = (x | (x << 4)) & 0x030C30C3u;
  x = (x | (x << 2)) & 0x09249249u;
  return x;
}

constexpr std::size_t order_block = 1 << 16;  // points

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Vec3& low, const Vec3& high) {
  // One cell size for all axes, so that cells are cubes.
  const Vec3 size = high - low;
  const double longest = std::max({size[0], size[1], size[2]});
  const double scale = longest > 0 ? 1024 / longest : 0;
  std::vector<KeyedIndex> entries(points.size());
  const tbb::blocked_range<std::size_t> all(0, points.size(), order_block);
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      std::uint32_t key = 0;
      bool finite = true;
      for (int c = 0; c < 3; ++c) {
        const double x = (points[i][c] - low[c]) * scale;
        finite = finite && std::isfinite(points[i][c]);
        const std::uint32_t cell = x > 0 ? (x < 1023 ? static_cast<std::uint32_t>(x) : 1023u) : 0u;
        key |= spread(cell) << c;
      }
      entries[i] = {finite ? key : 0x7fffffffu, static_cast<std::uint32_t>(i)};
    }
  });
  sort_by_key(entries, 31);
  std::vector<std::uint32_t> order(points.size());
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) order[i] = entries[i].index;
  });
  return order;
}

}  // namespace tri

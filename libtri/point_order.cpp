#include "libtri/point_order.hpp"

#include <array>
#include <cmath>

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

struct Entry {
  std::uint32_t key, index;
};

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Vec3& low, const Vec3& high) {
  // One cell size for all axes, so that cells are cubes.
  const Vec3 size = high - low;
  const double longest = std::max({size[0], size[1], size[2]});
  const double scale = longest > 0 ? 1024 / longest : 0;
  std::vector<Entry> entries(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
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
  // Radix sort, 11 bits a pass: 31 bits in three.
  std::vector<Entry> other(points.size());
  for (int shift = 0; shift < 33; shift += 11) {
    std::array<std::uint32_t, 2049> start{};
    for (const Entry& e : entries) ++start[((e.key >> shift) & 2047u) + 1];
    for (int k = 0; k < 2048; ++k) start[k + 1] += start[k];
    for (const Entry& e : entries) other[start[(e.key >> shift) & 2047u]++] = e;
    entries.swap(other);
  }
  other.clear();
  other.shrink_to_fit();
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = entries[i].index;
  return order;
}

}  // namespace tri

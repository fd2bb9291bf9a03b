#include "libtri/point_order.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

constexpr std::size_t block_size = 1 << 16;  // entries; fixed, though the result would not depend on it
constexpr int digit_bits = 11;
constexpr std::uint32_t digits = 1 << digit_bits;

// One stable pass of a radix sort: every block counts its digits, and writes to the places that the counts before leave.
void sort_digit(std::vector<Entry>& entries, std::vector<Entry>& other, int shift) {
  const std::size_t blocks = (entries.size() + block_size - 1) / block_size;
  std::vector<std::array<std::uint32_t, digits>> place(blocks);
  const auto for_blocks = [&](const auto& visit) {
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
      for (std::size_t i = block * block_size; i < std::min((block + 1) * block_size, entries.size()); ++i)
        visit(place[block], entries[i], entries[i].key >> shift & (digits - 1));
    });
  };
  for_blocks([](auto& mine, const Entry&, std::uint32_t digit) { ++mine[digit]; });
  std::uint32_t next = 0;
  for (std::uint32_t digit = 0; digit < digits; ++digit)
    for (auto& mine : place) next += std::exchange(mine[digit], next);
  for_blocks([&](auto& mine, const Entry& e, std::uint32_t digit) { other[mine[digit]++] = e; });
  entries.swap(other);
}

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Vec3& low, const Vec3& high) {
  // One cell size for all axes, so that cells are cubes.
  const Vec3 size = high - low;
  const double longest = std::max({size[0], size[1], size[2]});
  const double scale = longest > 0 ? 1024 / longest : 0;
  std::vector<Entry> entries(points.size());
  const tbb::blocked_range<std::size_t> all(0, points.size(), block_size);
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
  const auto by_key = [](const Entry& a, const Entry& b) { return a.key < b.key; };
  if (!std::is_sorted(entries.begin(), entries.end(), by_key)) {
    std::vector<Entry> other(points.size());
    for (int shift = 0; shift < 3 * digit_bits; shift += digit_bits) sort_digit(entries, other, shift);  // 31 bits
  }
  std::vector<std::uint32_t> order(points.size());
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) order[i] = entries[i].index;
  });
  return order;
}

}  // namespace tri

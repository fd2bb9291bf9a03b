#include "meshops/search/key_sort.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

namespace tri {
namespace {

constexpr std::size_t sort_block = 1 << 16;  // entries
constexpr int digit_bits = 11;
constexpr std::uint32_t digits = 1 << digit_bits;

// One stable pass: every block counts its digits, and writes to the places that the counts before leave.
void sort_digit(std::vector<KeyedIndex>& entries, std::vector<KeyedIndex>& other, int shift) {
  const std::size_t blocks = (entries.size() + sort_block - 1) / sort_block;
  std::vector<std::array<std::uint32_t, digits>> place(blocks);
  const auto for_blocks = [&](const auto& visit) {
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
      const std::size_t end = std::min((block + 1) * sort_block, entries.size());
      for (std::size_t i = block * sort_block; i < end; ++i)
        visit(place[block], entries[i], entries[i].key >> shift & (digits - 1));
    });
  };
  for_blocks([](auto& mine, const KeyedIndex&, std::uint32_t digit) { ++mine[digit]; });
  std::uint32_t next = 0;
  for (std::uint32_t digit = 0; digit < digits; ++digit)
    for (auto& mine : place) next += std::exchange(mine[digit], next);
  for_blocks([&](auto& mine, const KeyedIndex& e, std::uint32_t digit) { other[mine[digit]++] = e; });
  entries.swap(other);
}

}  // namespace

void sort_by_key(std::vector<KeyedIndex>& entries, int bits) {
  const auto before = [](const KeyedIndex& a, const KeyedIndex& b) { return a.key < b.key; };
  if (std::is_sorted(entries.begin(), entries.end(), before)) return;
  std::vector<KeyedIndex> other(entries.size());
  for (int shift = 0; shift < bits; shift += digit_bits) sort_digit(entries, other, shift);
}

}  // namespace tri

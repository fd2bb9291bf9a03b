#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tri {

/// A set of indices that costs as much as is in it, however large the indices: bits in pages made on demand.
class TouchedSet {
 public:
  /// True if the index was not in the set.
  bool insert(std::size_t index) {
    const std::size_t page = index / page_bits;
    if (page >= pages_.size()) pages_.resize(page + 1);
    if (!pages_[page]) pages_[page] = std::make_unique<Page>();
    std::uint64_t& word = (*pages_[page])[index % page_bits / 64];
    const std::uint64_t bit = std::uint64_t(1) << (index % 64);
    const bool fresh = (word & bit) == 0;
    word |= bit;
    return fresh;
  }

  /// True if the index was inserted.
  bool contains(std::size_t index) const {
    const std::size_t page = index / page_bits;
    return page < pages_.size() && pages_[page] && ((*pages_[page])[index % page_bits / 64] >> (index % 64) & 1) != 0;
  }

 private:
  static constexpr std::size_t page_bits = 4096;
  using Page = std::array<std::uint64_t, page_bits / 64>;

  std::vector<std::unique_ptr<Page>> pages_;
};

}  // namespace tri

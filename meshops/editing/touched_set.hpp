#pragma once

#include <algorithm>
#include <array>
#include <bit>
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

  /// Calls `visit(index)` in increasing order for those of the set between `page_bits * begin` and `page_bits * end`.
  template <class Visit>
  void for_pages(std::size_t begin, std::size_t end, const Visit& visit) const {
    for (std::size_t page = begin; page < std::min(end, pages_.size()); ++page) {
      if (!pages_[page]) continue;
      for (std::size_t w = 0; w < pages_[page]->size(); ++w)
        for (std::uint64_t word = (*pages_[page])[w]; word != 0; word &= word - 1)
          visit(page * page_bits + 64 * w + static_cast<std::size_t>(std::countr_zero(word)));
    }
  }
  /// For all of the set.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for_pages(0, pages_.size(), visit);
  }
  std::size_t pages() const { return pages_.size(); }

  static constexpr std::size_t page_bits = 4096;

 private:
  using Page = std::array<std::uint64_t, page_bits / 64>;

  std::vector<std::unique_ptr<Page>> pages_;
};

}  // namespace tri

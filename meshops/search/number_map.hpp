#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "meshops/limits.hpp"

namespace tri {

/// Spreads the bits of an index, for hash tables.
struct IndexHash {
  std::size_t operator()(std::uint32_t index) const {
    return static_cast<std::size_t>(index * 0x9e3779b97f4a7c15u >> 20);
  }
};

/// Numbers of keys. In two blocks of memory, so that millions of them are gone at once, unlike nodes of
/// std::unordered_map, for whose end a cancel would have to wait.
template <class Key, class Hash = IndexHash>
class NumberMap {
 public:
  /// @param expected  about how many there will be
  explicit NumberMap(std::size_t expected = 0) : slots_(std::bit_ceil(2 * expected + 16), no_index) {
    entries_.reserve(expected);
  }

  /// The number of a key, `no_index` if it has none.
  std::uint32_t find(const Key& key) const {
    const std::uint32_t entry = slots_[slot_of(key)];
    return entry == no_index ? no_index : entries_[entry].number;
  }

  /// Gives a key a number, unless it has one. @return its number, and whether it is new
  std::pair<std::uint32_t, bool> insert(const Key& key, std::uint32_t number) {
    std::size_t slot = slot_of(key);
    if (slots_[slot] != no_index) return {entries_[slots_[slot]].number, false};
    if (2 * (entries_.size() + 1) > slots_.size()) {
      slots_.assign(2 * slots_.size(), no_index);
      for (std::uint32_t i = 0; i < entries_.size(); ++i) slots_[slot_of(entries_[i].key)] = i;
      slot = slot_of(key);
    }
    slots_[slot] = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({key, number});
    return {number, true};
  }

  /// How many keys there are.
  std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    Key key;
    std::uint32_t number;
  };

  /// Where the key is, or belongs.
  std::size_t slot_of(const Key& key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = Hash()(key) & mask;
    while (slots_[at] != no_index && !(entries_[slots_[at]].key == key)) at = (at + 1) & mask;
    return at;
  }

  std::vector<std::uint32_t> slots_;  ///< places in `entries_`
  std::vector<Entry> entries_;
};

}  // namespace tri

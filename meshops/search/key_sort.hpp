#pragma once

#include <cstdint>
#include <vector>

namespace tri {

struct KeyedIndex {
  std::uint32_t key = 0, index = 0;
};

/// Sorts by key; equal keys keep their order. A radix sort on the threads of the caller's arena; what is sorted already
/// is left alone. Takes as much memory again.
/// @param bits  keys are below 2^bits, at most 33
void sort_by_key(std::vector<KeyedIndex>& entries, int bits);

}  // namespace tri

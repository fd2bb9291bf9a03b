#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace tri {

/// The indices below `n` for which `wanted(index)` holds, ascending. Asked on the threads of the caller's arena.
template <class Wanted>
std::vector<std::uint32_t> select_indices(std::size_t n, Wanted wanted) {
  constexpr std::size_t block_size = 1 << 14;
  std::vector<std::vector<std::uint32_t>> found((n + block_size - 1) / block_size);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t block) {
    for (std::size_t i = block * block_size; i < std::min((block + 1) * block_size, n); ++i)
      if (wanted(static_cast<std::uint32_t>(i))) found[block].push_back(static_cast<std::uint32_t>(i));
  });
  std::vector<std::uint32_t> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace tri

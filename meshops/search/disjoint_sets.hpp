#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tri {

/// Union-find over 0..n-1; the representative of a set is its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) {
    parent_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) parent_.push_back(i);
  }
  std::size_t find(std::size_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }
  std::size_t size() const { return parent_.size(); }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace tri

#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace tri {

/// A queue of items by cost in which nothing enters below the cost that was taken out last: constant time for each
/// step, no memory but two numbers per item.
///
/// Costs that differ by less than 1% may share a bucket, within which the first to enter is the first to leave. An item
/// is in the queue once or not at all.
class BucketQueue {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// @param items items are 0 .. items - 1
  explicit BucketQueue(std::size_t items) : next_(items, absent), buckets_(count, {none, none}) {}

  /// @param cost at least 0; around 1 if neither end of the range of a float is to be met
  static std::uint32_t bucket_of(double cost) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(cost < 3e38 ? cost : 3e38)) >> shift;
  }

  bool contains(std::uint32_t item) const { return next_[item] != absent; }

  /// Enters an item that is not in the queue; a bucket below the current one counts as the current one.
  void push(std::uint32_t item, std::uint32_t bucket) {
    if (bucket < current_) bucket = current_;
    Bucket& b = buckets_[bucket];
    if (b.last == none)
      b.first = item;
    else
      next_[b.last] = item;
    b.last = item;
    next_[item] = none;
  }

  std::uint32_t current() const { return current_; }

  /// Takes the first item of the lowest bucket out; `none` if there is no item left.
  std::uint32_t pop() {
    for (; current_ < count; ++current_) {
      Bucket& b = buckets_[current_];
      if (b.first == none) continue;
      const std::uint32_t item = b.first;
      b.first = next_[item];
      if (b.first == none) b.last = none;
      next_[item] = absent;
      return item;
    }
    current_ = count - 1;
    return none;
  }

 private:
  static constexpr int shift = 16;  // the exponent and seven bits of a float
  static constexpr std::uint32_t count = std::uint32_t{1} << (31 - shift);
  static constexpr std::uint32_t absent = none - 1;

  struct Bucket {
    std::uint32_t first, last;
  };
  std::vector<std::uint32_t> next_;  // in the same bucket
  std::vector<Bucket> buckets_;
  std::uint32_t current_ = 0;
};

}  // namespace tri

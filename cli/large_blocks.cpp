// Large arrays of the program come from one address range and are handed on from one to the next. Taking a fresh page
// from the system costs as much as the work done on it, and with a million points every step makes arrays of tens of
// megabytes: without this a fifth of the processor time goes into page faults.
//
// What is in use and what is kept for later use together never exceed the most that was in use at any time.
#if defined(__linux__)
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <map>
#include <mutex>
#include <new>

namespace {

constexpr std::size_t least_large = std::size_t{1} << 20;  // smaller blocks are malloc's
constexpr std::size_t step = std::size_t{1} << 16;
constexpr std::size_t huge_page = std::size_t{1} << 21;
constexpr std::size_t range_size = std::size_t{1} << 40;  // of addresses, not of memory

std::size_t round_up(std::size_t size, std::size_t to) {
  return (size + to - 1) / to * to;
}

class LargeBlocks {
 public:
  LargeBlocks() {
    for (std::size_t size = range_size; size >= (std::size_t{1} << 32); size /= 4) {
      void* const at = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
      if (at == MAP_FAILED) continue;
      begin_ = reinterpret_cast<std::uintptr_t>(at);
      end_ = begin_ + size;
      fresh_ = round_up(begin_, huge_page);
      madvise(at, size, MADV_HUGEPAGE);  // a hint: refusal changes nothing but the time
      return;
    }
  }

  bool owns(const void* block) const {
    const auto at = reinterpret_cast<std::uintptr_t>(block);
    return at >= begin_ && at < end_;
  }

  /// @return null if there is no room
  void* take(std::size_t size, std::size_t alignment) {
    if (size > range_size) return nullptr;  // nor may it overflow when it is rounded up
    size = round_up(size, step);
    const std::lock_guard lock(mutex_);
    if (begin_ == end_) return nullptr;
    std::uintptr_t at = take_kept(size, alignment);
    if (at == 0) {
      at = round_up(fresh_, alignment);
      if (size > end_ - at || at > end_) return nullptr;
      // In place of what is kept, so that the sum stays below the most that was ever in use.
      while (!kept_.empty() && used_ + kept_size_ + size > std::max(most_used_, used_ + size)) release_largest();
      fresh_ = at + size;
    }
    used_ += size;
    most_used_ = std::max(most_used_, used_);
    live_.emplace(at, size);
    return reinterpret_cast<void*>(at);
  }

  void give(void* block) {
    const std::lock_guard lock(mutex_);
    const auto found = live_.find(reinterpret_cast<std::uintptr_t>(block));
    if (found == live_.end()) std::abort();  // freed twice
    auto [at, size] = *found;
    live_.erase(found);
    used_ -= size;
    keep(at, size);
  }

 private:
  void keep(std::uintptr_t at, std::size_t size) {
    kept_size_ += size;
    const auto after = kept_.lower_bound(at);
    if (after != kept_.end() && after->first == at + size) {
      size += after->second;
      kept_.erase(after);
    }
    const auto next = kept_.lower_bound(at);
    if (next != kept_.begin()) {
      const auto before = std::prev(next);
      if (before->first + before->second == at) {
        before->second += size;
        return;
      }
    }
    kept_.emplace(at, size);
  }

  /// The smallest kept block that holds it; what is left over is kept.
  std::uintptr_t take_kept(std::size_t size, std::size_t alignment) {
    auto best = kept_.end();
    for (auto it = kept_.begin(); it != kept_.end(); ++it) {
      const std::size_t skipped = round_up(it->first, alignment) - it->first;
      if (it->second >= skipped + size && (best == kept_.end() || it->second < best->second)) best = it;
    }
    if (best == kept_.end()) return 0;
    const auto [at, whole] = *best;
    const std::uintptr_t from = round_up(at, alignment);
    kept_.erase(best);
    kept_size_ -= whole;
    if (from > at) keep(at, from - at);
    if (at + whole > from + size) keep(from + size, at + whole - from - size);
    return from;
  }

  void release_largest() {
    const auto largest =
        std::max_element(kept_.begin(), kept_.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    madvise(reinterpret_cast<void*>(largest->first), largest->second, MADV_DONTNEED);
    kept_size_ -= largest->second;
    kept_.erase(largest);  // its addresses are not used again: there are enough
  }

  std::mutex mutex_;
  std::uintptr_t begin_ = 0, end_ = 0, fresh_ = 0;
  std::map<std::uintptr_t, std::size_t> live_, kept_;  // address, size
  std::size_t used_ = 0, kept_size_ = 0, most_used_ = 0;
};

/// Never destroyed: static objects may free their arrays after it would be.
LargeBlocks& large_blocks() {
  alignas(LargeBlocks) static unsigned char place[sizeof(LargeBlocks)];
  static LargeBlocks* const blocks = new (place) LargeBlocks;
  return *blocks;
}

void* take(std::size_t size, std::size_t alignment) {
  if (size >= least_large) {
    if (void* const block = large_blocks().take(size, std::max<std::size_t>(alignment, 64))) return block;
  }
  if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__ || size > range_size)
    return std::malloc(std::max<std::size_t>(size, 1));
  return std::aligned_alloc(alignment, round_up(std::max<std::size_t>(size, 1), alignment));
}

void* take_or_throw(std::size_t size, std::size_t alignment) {
  for (;;) {
    if (void* const block = take(size, alignment)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void give(void* block) noexcept {
  if (large_blocks().owns(block))
    large_blocks().give(block);
  else
    std::free(block);
}

}  // namespace

void* operator new(std::size_t size) {
  return take_or_throw(size, 1);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return take_or_throw(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* block) noexcept {
  give(block);
}
void operator delete(void* block, std::size_t) noexcept {
  give(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
  give(block);
}
void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
  give(block);
}
#endif

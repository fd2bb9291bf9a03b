// The allocator of the program, linked into this test alone: operator new and delete are replaced in the whole
// executable.

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr std::size_t large = std::size_t{1} << 20;  // from this size on

std::uintptr_t address(const void* block) {
  return reinterpret_cast<std::uintptr_t>(block);
}

struct Block {
  unsigned char* at;
  std::size_t size;
  unsigned char mark;
};

void fill(const Block& block) {
  std::memset(block.at, block.mark, block.size);
}

bool intact(const Block& block) {
  return std::all_of(block.at, block.at + block.size, [&](unsigned char c) { return c == block.mark; });
}

/// Resident memory of this process in bytes.
std::size_t resident() {
  std::ifstream file("/proc/self/statm");
  std::size_t whole = 0, pages = 0;
  file >> whole >> pages;
  return pages * 4096;
}

/// Takes and gives blocks of random size in random order; every block keeps what was written to it.
void churn(unsigned seed, std::size_t smallest, std::size_t largest, int steps) {
  std::mt19937 random(seed);
  std::vector<Block> blocks;
  std::size_t damaged = 0;
  for (int i = 0; i < steps; ++i) {
    if (blocks.size() < 8 && random() % 3 != 0) {
      const std::size_t size = smallest + random() % (largest - smallest);
      blocks.push_back({static_cast<unsigned char*>(::operator new(size)), size, static_cast<unsigned char>(random())});
      fill(blocks.back());
    } else if (!blocks.empty()) {
      std::swap(blocks[random() % blocks.size()], blocks.back());
      damaged += !intact(blocks.back());
      ::operator delete(blocks.back().at);
      blocks.pop_back();
    }
  }
  for (const Block& block : blocks) {
    damaged += !intact(block);
    ::operator delete(block.at);
  }
  CHECK(damaged == 0);
}

}  // namespace

TEST_CASE("large_blocks: blocks in use never overlap and keep what is written, whatever the order of giving back") {
  churn(1, large / 2, 4 * large, 600);  // on both sides of the border
  churn(2, large, large + 200'000, 600);
}

TEST_CASE("large_blocks: blocks in use are apart from one another") {
  std::map<std::uintptr_t, std::size_t> ranges;
  std::vector<void*> blocks;
  for (std::size_t i = 0; i < 40; ++i) {
    const std::size_t size = large + i * 70'001;
    blocks.push_back(::operator new(size));
    ranges[address(blocks.back())] = size;
    if (i % 3 == 2) {  // leave gaps to be filled
      ranges.erase(address(blocks[i - 1]));
      ::operator delete(blocks[i - 1]);
      blocks[i - 1] = nullptr;
    }
  }
  std::uintptr_t end = 0;
  for (const auto& [at, size] : ranges) {
    CHECK(at >= end);
    end = at + size;
  }
  for (void* block : blocks) ::operator delete(block);
}

TEST_CASE("large_blocks: a block that was given back is handed on, whole or in parts") {
  // Larger than all that other cases give back, so that nothing else fits.
  const std::size_t size = 400 * large;
  void* const first = ::operator new(size);
  const std::uintptr_t at = address(first);
  ::operator delete(first);
  void* const same = ::operator new(size);
  CHECK(address(same) == at);
  ::operator delete(same);
  // Two halves of it, and joined again.
  void *const low = ::operator new(size / 2), *const high = ::operator new(size / 2);
  CHECK(std::min(address(low), address(high)) == at);
  CHECK(std::max(address(low), address(high)) == at + size / 2);
  ::operator delete(low);
  ::operator delete(high);
  void* const whole = ::operator new(size);
  CHECK(address(whole) == at);
  ::operator delete(whole);
}

TEST_CASE("large_blocks: every alignment that is asked for is given, for small and large blocks") {
  for (std::size_t alignment = 16; alignment <= (std::size_t{1} << 16); alignment *= 2)
    for (const std::size_t size : {std::size_t{1}, std::size_t{100}, large - 1, large, 3 * large + 5}) {
      CAPTURE(alignment);
      CAPTURE(size);
      void* const block = ::operator new(size, std::align_val_t(alignment));
      CHECK(address(block) % alignment == 0);
      std::memset(block, 1, size);
      ::operator delete(block, std::align_val_t(alignment));
    }
}

TEST_CASE("large_blocks: nothing is a block as well, and what no machine has is refused") {
  void *const none = ::operator new(0), *const other = ::operator new(0);
  CHECK(none != nullptr);
  CHECK(none != other);
  ::operator delete(none);
  ::operator delete(other);
  ::operator delete(nullptr);
  for (const std::size_t size :
       {std::size_t{1} << 50, std::numeric_limits<std::size_t>::max(), std::numeric_limits<std::size_t>::max() - 100})
    CHECK_THROWS_AS(::operator delete(::operator new(size)), std::bad_alloc);
}

TEST_CASE("large_blocks: threads may take and give at once, and give what another took") {
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < 4; ++t) threads.emplace_back([t] { churn(10 + t, large / 2, 2 * large, 150); });
  for (std::thread& thread : threads) thread.join();
  std::vector<int>* taken = nullptr;
  std::thread([&] { taken = new std::vector<int>(large, 7); }).join();
  CHECK(std::count(taken->begin(), taken->end(), 7) == static_cast<std::ptrdiff_t>(large));
  std::thread([&] { delete taken; }).join();
}

TEST_CASE("large_blocks: sizes that grow without end do not add up") {
  // Each is larger than all that were given back before, as a vector that grows: what is kept for later use must go.
  const std::size_t before = resident();
  std::size_t size = large, most = 0;
  for (int i = 0; i < 40; ++i, size += 3 * large / 2) {
    unsigned char* const block = static_cast<unsigned char*>(::operator new(size));
    std::memset(block, 1, size);
    most = std::max(most, resident());
    ::operator delete(block);
  }
  // The sum of all is 20 times the largest.
  CHECK(most < before + 3 * size);
}

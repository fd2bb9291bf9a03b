#include "meshops/joining/side_pairs.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "meshops/error.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

/// The larger vertex of a side, then the side, then whether it runs from the smaller vertex to the larger.
using Entry = std::uint64_t;

Entry make_entry(std::uint32_t larger, std::uint32_t side, bool forward) {
  return (static_cast<Entry>(larger) << 32) | (side << 1) | static_cast<Entry>(forward);
}
std::uint32_t larger_vertex(Entry entry) {
  return static_cast<std::uint32_t>(entry >> 32);
}
std::int32_t side_of(Entry entry) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(entry) >> 1);
}
bool is_forward(Entry entry) {
  return (entry & 1) != 0;
}

/// Consecutive triangles, and the range of the smaller vertices of their sides.
struct Block {
  static constexpr std::size_t size = 1024;
  std::uint32_t first = 0xffffffff;
  std::uint32_t last = 0;
};

void sort_bucket(Entry* begin, Entry* end) {
  if (end - begin > 24) {
    std::sort(begin, end);
    return;
  }
  for (Entry* i = begin + 1; i < end; ++i) {
    const Entry entry = *i;
    Entry* j = i;
    for (; j > begin && j[-1] > entry; --j) *j = j[-1];
    *j = entry;
  }
}

void pair_bucket(Entry* begin, Entry* end, SidePairs& pairs) {
  sort_bucket(begin, end);
  while (begin < end) {
    Entry* run = begin + 1;
    while (run < end && larger_vertex(*run) == larger_vertex(*begin)) ++run;
    if (run - begin == 2) {
      const std::int32_t a = side_of(begin[0]), b = side_of(begin[1]);
      if (is_forward(begin[0]) != is_forward(begin[1])) {
        pairs.twin[a] = b;
        pairs.twin[b] = a;
      } else {
        pairs.twin[a] = pairs.twin[b] = SidePairs::none;
        pairs.same_way.push_back({a, b});
      }
    } else {
      if (run - begin > 2) pairs.crowded.emplace_back();
      for (const Entry* i = begin; i < run; ++i) {
        pairs.twin[side_of(*i)] = SidePairs::none;
        if (run - begin > 2) pairs.crowded.back().push_back(side_of(*i));
      }
    }
    begin = run;
  }
}

}  // namespace

SidePairs pair_sides(std::span<const Triangle> triangles, std::size_t points, Context& context) {
  Pace pace(context);
  SidePairs pairs;
  // Sides by smaller vertex, and for each block of triangles the range of these vertices.
  std::vector<std::uint32_t> count(points);
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i % Block::size == 0) {
      if (blocks.size() % 32 == 0) context.checkpoint();
      blocks.emplace_back();
    }
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = std::min(triangles[i][k], triangles[i][k == 2 ? 0 : k + 1]);
      ++count[v];
      blocks.back().first = std::min(blocks.back().first, v);
      blocks.back().last = std::max(blocks.back().last, v);
    }
  }
  pairs.twin.resize(3 * triangles.size());

  // A few ranges of vertices one after another: their buckets stay in the cache, and need less memory.
  const std::size_t sides_per_range = std::max<std::size_t>(std::size_t{1} << 19, pairs.twin.size() / 12);
  std::vector<Entry> entries;
  for (std::size_t begin = 0, end = 0; begin < points; begin = end) {
    context.checkpoint();
    std::size_t sum = 0;
    while (end < points && (sum == 0 || sum + count[end] <= sides_per_range))
      sum += std::exchange(count[end++], static_cast<std::uint32_t>(sum));
    if (entries.size() < sum) entries.resize(sum);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (blocks[b].last < begin || blocks[b].first >= end) continue;
      for (std::size_t i = b * Block::size; i < std::min((b + 1) * Block::size, triangles.size()); ++i) {
        const Triangle& t = triangles[i];
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t from = t[k], to = t[k == 2 ? 0 : k + 1], smaller = std::min(from, to);
          if (smaller < begin || smaller >= end) continue;
          entries[count[smaller]++] = make_entry(std::max(from, to), static_cast<std::uint32_t>(3 * i) + k, from < to);
        }
      }
    }
    // By now count[v] is where the bucket of v ends.
    Entry* bucket = entries.data();
    for (std::size_t v = begin; v < end; ++v) {
      pace();
      Entry* const bucket_end = entries.data() + count[v];
      if (bucket < bucket_end) pair_bucket(bucket, bucket_end, pairs);
      bucket = bucket_end;
    }
  }
  return pairs;
}

std::vector<std::uint32_t> vertices_with_several_fans(std::span<const Triangle> triangles, std::size_t points,
                                                      std::span<const std::int32_t> twin, const Context& context) {
  Pace pace(context);
  // A fan is walked counter-clockwise; an open one has to be entered at its first triangle, whose side has no twin.
  std::vector<std::int32_t> first(points, SidePairs::none);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    pace();
    for (int k = 0; k < 3; ++k) first[triangles[i][k]] = static_cast<std::int32_t>(3 * i) + k;
  }
  for (std::size_t side = 0; side < twin.size(); ++side) {
    pace();
    if (twin[side] == SidePairs::none) first[triangles[side / 3][side % 3]] = static_cast<std::int32_t>(side);
  }
  const auto fan_size = [&](std::size_t v) {
    std::uint32_t size = 0;
    std::int32_t side = first[v];
    do {
      ++size;
      side = twin[SidePairs::previous(side)];
    } while (side != SidePairs::none && side != first[v]);
    return size;
  };
  // Each walk covers one fan; only if something is left over is it worth while to count by vertex.
  const std::size_t covered = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, points, 4096), std::size_t{0},
      [&](const auto& range, std::size_t sum) {
        if (context.cancelled()) throw Cancelled();
        for (std::size_t v = range.begin(); v < range.end(); ++v)
          if (first[v] != SidePairs::none) sum += fan_size(v);
        return sum;
      },
      std::plus<>());
  std::vector<std::uint32_t> several;
  if (covered == twin.size()) return several;
  std::vector<std::uint32_t> corners(points);
  for (const Triangle& t : triangles) {
    pace();
    for (const std::uint32_t v : t) ++corners[v];
  }
  for (std::size_t v = 0; v < points; ++v) {
    pace();
    if (corners[v] > 0 && fan_size(v) != corners[v]) several.push_back(static_cast<std::uint32_t>(v));
  }
  return several;
}

}  // namespace tri

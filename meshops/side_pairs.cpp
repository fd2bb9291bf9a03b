#include "meshops/side_pairs.hpp"

#include <algorithm>
#include <memory>
#include <utility>

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
        pairs.same_way.push_back({a, b});
      }
    } else if (run - begin > 2) {
      std::vector<std::int32_t>& sides = pairs.crowded.emplace_back();
      for (const Entry* i = begin; i < run; ++i) sides.push_back(side_of(*i));
    }
    begin = run;
  }
}

}  // namespace

SidePairs pair_sides(std::span<const Triangle> triangles, std::size_t points, Context& context) {
  SidePairs pairs;
  std::vector<std::uint32_t> start(points + 1);
  for (const Triangle& t : triangles) {
    ++start[std::min(t[0], t[1])];
    ++start[std::min(t[1], t[2])];
    ++start[std::min(t[2], t[0])];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& s : start) sum += std::exchange(s, sum);

  // After the scatter, start[v] is where the bucket of v ends.
  context.checkpoint();
  std::unique_ptr<Entry[]> entries(new Entry[sum]);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    const auto side = static_cast<std::uint32_t>(3 * i);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[k == 2 ? 0 : k + 1];
      const bool forward = from < to;
      entries[start[forward ? from : to]++] = make_entry(forward ? to : from, side + k, forward);
    }
  }
  context.checkpoint();
  pairs.twin.assign(3 * triangles.size(), SidePairs::none);
  std::uint32_t begin = 0;
  for (std::size_t v = 0; v < points; ++v) {
    if (start[v] > begin + 1) pair_bucket(&entries[begin], &entries[0] + start[v], pairs);
    begin = start[v];
  }
  return pairs;
}

std::vector<std::uint32_t> vertices_with_several_fans(std::span<const Triangle> triangles, std::size_t points,
                                                      std::span<const std::int32_t> twin) {
  // A fan is walked counter-clockwise; an open one has to be entered at its first triangle, whose side has no twin.
  std::vector<std::int32_t> first(points, SidePairs::none);
  std::vector<std::uint32_t> corners(points);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[i][k];
      const auto side = static_cast<std::int32_t>(3 * i + k);
      if (corners[v]++ == 0 || twin[side] == SidePairs::none) first[v] = side;
    }
  }
  std::vector<std::uint32_t> several;
  for (std::size_t v = 0; v < points; ++v) {
    if (corners[v] == 0) continue;
    std::uint32_t seen = 0;
    std::int32_t side = first[v];
    do {
      ++seen;
      side = twin[SidePairs::previous(side)];
    } while (side != SidePairs::none && side != first[v]);
    if (seen != corners[v]) several.push_back(static_cast<std::uint32_t>(v));
  }
  return several;
}

}  // namespace tri

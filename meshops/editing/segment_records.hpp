#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh.hpp"

// What the two kinds of change segments have in common.
namespace tri::segment_records {

/// The handles in a record, as numbers.
template <class Record>
auto raw(const Record& record) {
  return std::bit_cast<std::array<int, sizeof(Record) / sizeof(int)>>(record);
}

inline void mix(std::uint64_t& sum, std::uint64_t value) {
  sum = (sum ^ value) * 0x9e3779b97f4a7c15u;
  sum ^= sum >> 32;
}
template <class Record>
void mix_record(std::uint64_t& sum, const Record& record) {
  for (const int i : raw(record)) mix(sum, static_cast<std::uint32_t>(i));
}

inline auto& record_of(OpenMesh::TriConnectivity& mesh, OpenMesh::ArrayItems::Vertex*, std::size_t i) {
  return mesh.vertex(VertexHandle(static_cast<int>(i)));
}
inline auto& record_of(OpenMesh::TriConnectivity& mesh, OpenMesh::ArrayItems::Edge*, std::size_t i) {
  return mesh.edge(EdgeHandle(static_cast<int>(i)));
}
inline auto& record_of(OpenMesh::TriConnectivity& mesh, OpenMesh::ArrayItems::Face*, std::size_t i) {
  return mesh.face(FaceHandle(static_cast<int>(i)));
}
template <class Record>
Record& record_at(OpenMesh::TriConnectivity& mesh, std::size_t i) {
  return record_of(mesh, static_cast<Record*>(nullptr), i);
}

/// For tasks that touch nothing in common; the next one is not begun after a cancel.
inline void run_all(const std::vector<std::function<void()>>& tasks, const Context* context) {
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    if (context) context->checkpoint();
    tasks[i]();
  });
}

inline constexpr std::size_t block_size = 1 << 17;  // elements

/// A number made of the numbers of blocks, which `sum_of(block, sum)` computes, side by side if there are several.
template <class SumOf>
void mix_blocks(std::uint64_t& sum, std::size_t blocks, const Context* context, const SumOf& sum_of) {
  std::vector<std::uint64_t> sums(blocks, 0);
  const auto one = [&](std::size_t block) {
    if (context) context->checkpoint();
    sum_of(block, sums[block]);
  };
  if (blocks > 1)
    tbb::parallel_for(std::size_t{0}, blocks, one);
  else if (blocks == 1)
    one(0);
  for (const std::uint64_t s : sums) mix(sum, s);
}

template <class Visit>
void mix_range(std::uint64_t& sum, std::size_t begin, std::size_t end, const Context* context, const Visit& visit) {
  if (begin >= end) return;
  mix_blocks(sum, (end - begin + block_size - 1) / block_size, context, [&](std::size_t block, std::uint64_t& part) {
    for (std::size_t i = begin + block * block_size; i < std::min(begin + (block + 1) * block_size, end); ++i)
      visit(part, i);
  });
}

}  // namespace tri::segment_records

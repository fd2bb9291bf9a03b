#pragma once

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string_view>
#include <thread>

#include "meshops/context.hpp"

namespace tri {

/// Threads that an operation may use: as many as the context allows, and no more than there are cores.
inline int worker_threads(const Context& context) {
  const int cores = tbb::info::default_concurrency();
  return context.threads > 0 ? std::min(context.threads, cores) : cores;
}

/// Calls `body(block, begin, end)` for each block of `block_size` (> 0) indices below `count`, on at most
/// `context.threads` threads. What a block is does not depend on them, so neither do results that are kept by block and
/// combined in order.
///
/// Reports progress as `step`, unless that is empty, from the calling thread.
/// @throws Cancelled between blocks, and what `body` throws.
template <class Body>
void for_each_block(const Context& context, std::string_view step, std::size_t count, std::size_t block_size,
                    const Body& body) {
  const std::size_t blocks = (count + block_size - 1) / block_size;
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<std::size_t> done{0};
  context.checkpoint();
  if (!step.empty()) context.progress(step, 0);
  tbb::task_arena arena(worker_threads(context));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
      context.checkpoint();
      const std::size_t begin = block * block_size;
      body(block, begin, std::min(count, begin + block_size));
      const std::size_t finished = ++done;
      if (!step.empty() && std::this_thread::get_id() == caller)
        context.progress(step, static_cast<double>(finished) / static_cast<double>(blocks));
    });
  });
  if (!step.empty()) context.progress(step, 1);
}

}  // namespace tri

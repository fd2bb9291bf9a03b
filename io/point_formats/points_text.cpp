#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/point_formats/points_dialect.hpp"
#include "io/point_formats/points_formats.hpp"
#include "io/text_scanner.hpp"

namespace tri::io_detail {
namespace {

constexpr std::size_t chunk_size = std::size_t{1} << 20;
// Between two looks at the context.
constexpr std::size_t chunks_at_once = 32;

struct Chunk {
  const char* first;
  const char* last;
  std::size_t lines = 0;        // with a point
  std::size_t first_point = 0;  // index of the first of them
  bool unit_normals = true;
  std::uint64_t missing = 0;  // values of columns that a line may lack
  PointsLineError error;
};

std::vector<Chunk> chunks_of(const char* first, const char* last, char line_end) {
  std::vector<Chunk> chunks;
  while (first < last) {
    const char* next = last;
    if (static_cast<std::size_t>(last - first) > chunk_size) {
      const char* from = first + chunk_size;
      const void* end = std::memchr(from, line_end, static_cast<std::size_t>(last - from));
      if (end) next = static_cast<const char*>(end) + 1;
    }
    chunks.push_back({first, next});
    first = next;
  }
  return chunks;
}

template <class Function>
void for_each_line(const Chunk& chunk, char line_end, Function&& function) {
  for (const char* p = chunk.first; p < chunk.last;) {
    const auto left = static_cast<std::size_t>(chunk.last - p);
    const auto* end = static_cast<const char*>(std::memchr(p, line_end, left));
    const std::string_view line(p, end ? static_cast<std::size_t>(end - p) : left);
    p += line.size() + 1;
    if (is_skipped_line(line)) continue;
    if (!function(line)) return;
  }
}

/// Where the columns of a file go.
struct Columns {
  PointSet set;
  std::vector<std::vector<double>*> scalars;  // in the order of the dialect

  void resize(const PointsDialect& dialect, std::size_t count) {
    set.points.resize(count);
    if (dialect.normals) set.normals.resize(count);
    if (dialect.intensity) set.intensity.resize(count);
    if (dialect.colors) set.colors.resize(count);
    scalars.clear();
    for (const std::string& name : dialect.scalars) {
      scalars.push_back(&set.scalars[name]);
      scalars.back()->resize(count);
    }
  }
};

bool store_color(const double* v, std::array<std::uint8_t, 3>& color) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(v[k] >= 0 && v[k] <= 255 && v[k] == std::floor(v[k]))) return false;
    color[k] = static_cast<std::uint8_t>(v[k]);
  }
  return true;
}

void parse_chunk(Chunk& chunk, const PointsDialect& dialect, Columns& columns) {
  PointSet& set = columns.set;
  std::size_t i = chunk.first_point;
  std::vector<double> values(static_cast<std::size_t>(dialect.values()));
  const double* const v = values.data();
  const bool more = dialect.values() > dialect.required();
  for_each_line(chunk, dialect.line_end, [&](std::string_view line) {
    parse_points_line(line, dialect, values.data(), chunk.error);
    if (chunk.error.where) return false;
    set.points[i] = Vec3(v[0], v[1], v[2]);
    if (dialect.normals) {
      set.normals[i] = Vec3(v[3], v[4], v[5]);
      chunk.unit_normals = chunk.unit_normals && std::abs(set.normals[i].sqrnorm() - 1) <= unit_tolerance;
    }
    if (more) {
      for (int k = dialect.required(); k < dialect.values(); ++k) chunk.missing += std::isnan(v[k]);
      if (dialect.intensity) set.intensity[i] = v[dialect.intensity_at()];
      if (dialect.colors && !store_color(v + dialect.colors_at(), set.colors[i])) {
        chunk.error = {line.data(), "the colour is not three whole numbers from 0 to 255"};
        return false;
      }
      for (std::size_t k = 0; k < columns.scalars.size(); ++k)
        (*columns.scalars[k])[i] = v[static_cast<std::size_t>(dialect.scalars_at()) + k];
    }
    ++i;
    return true;
  });
}

}  // namespace

PointSet parse_points_text(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info) {
  info.format = PointsFormat::text;
  PointsDialect dialect = recognise_points_dialect(bytes, file, info);
  std::vector<Chunk> chunks = chunks_of(dialect.first_point, bytes.data() + bytes.size(), dialect.line_end);
  Columns columns;

  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(context.threads > 0 ? std::min(context.threads, cores) : cores);
  const auto in_parallel = [&](double from, double to, const auto& work) {
    for (std::size_t begin = 0; begin < chunks.size(); begin += chunks_at_once) {
      context.checkpoint();
      context.progress("read", from + (to - from) * static_cast<double>(begin) / static_cast<double>(chunks.size()));
      const std::size_t end = std::min(chunks.size(), begin + chunks_at_once);
      arena.execute([&] { tbb::parallel_for(begin, end, [&](std::size_t i) { work(chunks[i]); }); });
    }
  };
  // Counted first, so that every line knows its place and nothing is copied.
  in_parallel(0, 0.2, [&](Chunk& chunk) {
    for_each_line(chunk, dialect.line_end, [&](std::string_view) { return ++chunk.lines > 0; });
  });
  std::size_t count = 0;
  for (Chunk& chunk : chunks) {
    chunk.first_point = count;
    count += chunk.lines;
  }
  for (bool again = true; again;) {
    again = false;
    columns.resize(dialect, count);
    in_parallel(0.2, 1, [&](Chunk& chunk) { parse_chunk(chunk, dialect, columns); });
    const auto not_unit =
        std::find_if(chunks.begin(), chunks.end(), [](const Chunk& c) { return !c.unit_normals || c.error.where; });
    if (dialect.normals && !dialect.normals_named && not_unit != chunks.end()) {
      // Nobody said that columns 4 to 6 are normals, and what some line holds there is none: they are other values.
      dialect.normals = false;
      dialect.target.resize(3);
      columns.set.normals.clear();
      columns.set.normals.shrink_to_fit();
      for (Chunk& chunk : chunks) chunk.error = {}, chunk.unit_normals = true;
      info.notes.emplace_back("columns 4 to 6 are not unit vectors on every line: they were ignored");
      again = true;
    }
  }
  for (const Chunk& chunk : chunks)
    if (chunk.error.where)
      throw IoError(file, chunk.error.message, IoError::Unit::line, line_of(bytes, chunk.error.where));
  if (dialect.normals && !dialect.normals_named)
    info.notes.emplace_back("columns 4 to 6 are unit vectors: they were read as normals");
  std::uint64_t missing = 0;
  for (const Chunk& chunk : chunks) missing += chunk.missing;
  if (missing > 0)
    info.notes.push_back(fmt::format("{} values beside the coordinates are missing or no numbers: NaN", missing));
  return std::move(columns.set);
}

}  // namespace tri::io_detail

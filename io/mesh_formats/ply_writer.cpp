#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/text_number.hpp"

namespace tri::io_detail {
namespace {

struct Column {
  std::string name;
  const std::vector<double>* values;
  enum class Type { uchar_, int_, double_ } type;
};

bool all_integers(const std::vector<double>& values, double low, double high) {
  return std::all_of(values.begin(), values.end(), [=](double v) {
    return v >= low && v <= high && v == std::floor(v) && !(v == 0 && std::signbit(v));
  });
}

Column::Type type_of(const std::string& name, const std::vector<double>& values) {
  const bool level = name == "red" || name == "green" || name == "blue" || name == "alpha";
  if (level && all_integers(values, 0, 255)) return Column::Type::uchar_;
  const bool index = name == "point_index" || name == "cad_face";
  if (index && all_integers(values, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()))
    return Column::Type::int_;
  return Column::Type::double_;
}

// The properties of a triangulated mesh first and in their usual order, then others by name.
std::vector<Column> columns_of(const std::map<std::string, std::vector<double>>& scalars) {
  static constexpr const char* usual[] = {"point_index", "cad_face", "u", "v", "deviation"};
  std::vector<Column> columns;
  for (const char* name : usual)
    if (const auto found = scalars.find(name); found != scalars.end())
      columns.push_back({found->first, &found->second, type_of(found->first, found->second)});
  for (const auto& [name, values] : scalars)
    if (std::find(std::begin(usual), std::end(usual), name) == std::end(usual))
      columns.push_back({name, &values, type_of(name, values)});
  return columns;
}

std::string declarations(const std::vector<Column>& columns) {
  std::string text;
  for (const Column& column : columns) {
    const char* type = column.type == Column::Type::uchar_ ? "uchar"
                       : column.type == Column::Type::int_ ? "int"
                                                           : "double";
    text += fmt::format("property {} {}\n", type, column.name);
  }
  return text;
}

// The values of an element, separated by blanks.
class TextRecord {
 public:
  explicit TextRecord(AtomicFile& file) : text_(file) {}
  template <class Value>
  void value(Value v) {
    if (!first_) text_ << ' ';
    first_ = false;
    if constexpr (sizeof(Value) == 1)
      text_ << static_cast<int>(v);
    else
      text_ << v;
  }
  void end() {
    text_ << '\n';
    first_ = true;
  }

 private:
  TextWriter text_;
  bool first_ = true;
};

// The values of an element, byte after byte.
class BinaryRecord {
 public:
  explicit BinaryRecord(char* at) : at_(at) {}
  template <class Value>
  void value(Value v) {
    std::memcpy(at_, &v, sizeof(Value));
    at_ += sizeof(Value);
  }

 private:
  char* at_;
};

template <class Record>
void put_columns(Record& record, const std::vector<Column>& columns, std::size_t i) {
  for (const Column& column : columns) {
    const double v = (*column.values)[i];
    if (column.type == Column::Type::uchar_)
      record.value(static_cast<std::uint8_t>(v));
    else if (column.type == Column::Type::int_)
      record.value(static_cast<std::int32_t>(v));
    else
      record.value(v);
  }
}

std::size_t size_of(const std::vector<Column>& columns) {
  std::size_t size = 0;
  for (const Column& column : columns)
    size += column.type == Column::Type::uchar_ ? 1 : column.type == Column::Type::int_ ? 4 : 8;
  return size;
}

template <class Record>
void put_vertex(Record& record, const Soup& soup, const std::vector<Column>& columns, std::size_t i) {
  for (int k = 0; k < 3; ++k) record.value(soup.points[i][k]);
  if (!soup.vertex_normals.empty())
    for (int k = 0; k < 3; ++k) record.value(soup.vertex_normals[i][k]);
  put_columns(record, columns, i);
  if (!soup.vertex_colors.empty())
    for (const std::uint8_t c : soup.vertex_colors[i]) record.value(c);
}

/// Texture coordinates of the corners; null without.
struct Texture {
  const std::vector<double>* s = nullptr;
  const std::vector<double>* t = nullptr;
};

Texture texture_of(const Soup& soup) {
  const auto s = soup.corner_scalars.find("s"), t = soup.corner_scalars.find("t");
  if (s == soup.corner_scalars.end() || t == soup.corner_scalars.end()) return {};
  return {&s->second, &t->second};
}

template <class Record>
void put_face(Record& record, const Soup& soup, const std::vector<Column>& columns, const Texture& texture,
              std::size_t i) {
  record.value(std::uint8_t{3});
  for (const std::uint32_t v : soup.triangles[i]) record.value(v);
  put_columns(record, columns, i);
  if (!texture.s) return;
  record.value(std::uint8_t{6});
  for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
    record.value((*texture.s)[c]);
    record.value((*texture.t)[c]);
  }
}

// Says how far writing has come.
class Progress {
 public:
  Progress(const Soup& soup, Context& context)
      : all_(static_cast<double>(soup.points.size() + soup.triangles.size())), context_(context) {}
  void at(std::size_t element) {
    context_.checkpoint();
    context_.progress("write", static_cast<double>(element) / all_);
  }

 private:
  double all_;
  Context& context_;
};

void write_text(AtomicFile& file, const Soup& soup, const std::vector<Column>& vertex_columns,
                const std::vector<Column>& face_columns, Context& context) {
  Progress progress(soup, context);
  const Texture texture = texture_of(soup);
  TextRecord record(file);
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    if (i % checkpoint_interval == 0) progress.at(i);
    put_vertex(record, soup, vertex_columns, i);
    record.end();
  }
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    if (i % checkpoint_interval == 0) progress.at(soup.points.size() + i);
    put_face(record, soup, face_columns, texture, i);
    record.end();
  }
}

// Fills blocks of records on all threads; while one is written, the next is filled.
template <class Put>
void write_records(AtomicFile& file, std::size_t count, std::size_t size, Put put, Progress& progress,
                   std::size_t done_before) {
  constexpr std::size_t block = 1 << 16;
  std::vector<char> filled, next;
  const auto fill = [&](std::size_t begin) {
    const std::size_t end = std::min(begin + block, count);
    next.resize(begin < end ? (end - begin) * size : 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, std::max(begin, end), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) put(i, next.data() + (i - begin) * size);
    });
  };
  fill(0);
  for (std::size_t begin = 0; begin < count; begin += block) {
    progress.at(done_before + begin);
    filled.swap(next);
    tbb::parallel_invoke([&] { file.write({filled.data(), filled.size()}); }, [&] { fill(begin + block); });
  }
}

void write_binary_ply(AtomicFile& file, const Soup& soup, const std::vector<Column>& vertex_columns,
                      const std::vector<Column>& face_columns, Context& context) {
  Progress progress(soup, context);
  const std::size_t vertex_size =
      24 + (soup.vertex_normals.empty() ? 0 : 24) + size_of(vertex_columns) + (soup.vertex_colors.empty() ? 0 : 3);
  const Texture texture = texture_of(soup);
  const std::size_t face_size = 13 + size_of(face_columns) + (texture.s ? 49 : 0);
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    write_records(
        file, soup.points.size(), vertex_size,
        [&](std::size_t i, char* at) {
          BinaryRecord record(at);
          put_vertex(record, soup, vertex_columns, i);
        },
        progress, 0);
    write_records(
        file, soup.triangles.size(), face_size,
        [&](std::size_t i, char* at) {
          BinaryRecord record(at);
          put_face(record, soup, face_columns, texture, i);
        },
        progress, soup.points.size());
  });
}

}  // namespace

void write_ply(AtomicFile& file, const Soup& soup, bool ascii, Context& context) {
  const std::vector<Column> vertex_columns = columns_of(soup.vertex_scalars);
  const std::vector<Column> face_columns = columns_of(soup.face_scalars);
  const bool normals = !soup.vertex_normals.empty();
  const bool colors = !soup.vertex_colors.empty();
  const bool wide = soup.points.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());

  std::string header = fmt::format("ply\nformat {} 1.0\ncomment written by tri\nelement vertex {}\n",
                                   ascii ? "ascii" : "binary_little_endian", soup.points.size());
  header += "property double x\nproperty double y\nproperty double z\n";
  if (normals) header += "property double nx\nproperty double ny\nproperty double nz\n";
  header += declarations(vertex_columns);
  if (colors) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  header += fmt::format("element face {}\nproperty list uchar {} vertex_indices\n", soup.triangles.size(),
                        wide ? "uint" : "int");
  header += declarations(face_columns);
  if (texture_of(soup).s) header += "property list uchar double texcoord\n";
  header += "end_header\n";
  file.write(header);

  if (ascii)
    write_text(file, soup, vertex_columns, face_columns, context);
  else
    write_binary_ply(file, soup, vertex_columns, face_columns, context);
}

}  // namespace tri::io_detail

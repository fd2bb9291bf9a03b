#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/mesh_formats.hpp"
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

// The same sequence of values as text or as bytes.
class Sink {
 public:
  Sink(AtomicFile& file, bool ascii) : file_(file), text_(file), ascii_(ascii) {}
  template <class Value>
  void value(Value v) {
    if (!ascii_) {
      file_.write_value(v);
      return;
    }
    if (!first_) text_ << ' ';
    first_ = false;
    if constexpr (sizeof(Value) == 1)
      text_ << static_cast<int>(v);
    else
      text_ << v;
  }
  void values(const std::vector<Column>& columns, std::size_t i) {
    for (const Column& column : columns) {
      const double v = (*column.values)[i];
      if (column.type == Column::Type::uchar_)
        value(static_cast<std::uint8_t>(v));
      else if (column.type == Column::Type::int_)
        value(static_cast<std::int32_t>(v));
      else
        value(v);
    }
  }
  void end_record() {
    if (ascii_) text_ << '\n';
    first_ = true;
  }

 private:
  AtomicFile& file_;
  TextWriter text_;
  bool ascii_;
  bool first_ = true;
};

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
  header += declarations(face_columns) + "end_header\n";
  file.write(header);

  Sink sink(file, ascii);
  const double all = static_cast<double>(soup.points.size() + soup.triangles.size());
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    if (i % checkpoint_interval == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / all);
    }
    for (int k = 0; k < 3; ++k) sink.value(soup.points[i][k]);
    if (normals)
      for (int k = 0; k < 3; ++k) sink.value(soup.vertex_normals[i][k]);
    sink.values(vertex_columns, i);
    if (colors)
      for (const std::uint8_t c : soup.vertex_colors[i]) sink.value(c);
    sink.end_record();
  }
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    if (i % checkpoint_interval == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(soup.points.size() + i) / all);
    }
    sink.value(std::uint8_t{3});
    for (const std::uint32_t v : soup.triangles[i]) sink.value(v);
    sink.values(face_columns, i);
    sink.end_record();
  }
}

}  // namespace tri::io_detail

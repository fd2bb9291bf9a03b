#include "io/point_formats/points_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/text_number.hpp"
#include "meshops/points/point_soup.hpp"

namespace tri::io_detail {
namespace {

void report(const PointSet& set, std::size_t i, Context& context) {
  if (i % checkpoint_interval != 0) return;
  context.checkpoint();
  context.progress("write", static_cast<double>(i) / static_cast<double>(set.size()));
}

}  // namespace

NamedColumns numbers_of(const PointSet& set, std::span<const std::string_view> taken) {
  NamedColumns columns;
  for (const auto& [name, values] : set.scalars) {
    std::string plain = name.empty() ? "_" : name;
    for (char& c : plain)
      if (c == ' ' || c == ',' || c == ';' || c == '\t' || c == '\n' || c == '\r') c = '_';
    const auto used = [&] {
      return std::find(taken.begin(), taken.end(), plain) != taken.end() ||
             std::any_of(columns.begin(), columns.end(), [&](const auto& c) { return c.first == plain; });
    };
    while (used()) plain.insert(0, "input_");
    columns.emplace_back(std::move(plain), &values);
  }
  return columns;
}

void write_points_text(AtomicFile& file, const PointSet& set, char separator, bool header, Context& context) {
  const NamedColumns columns = numbers_of(set);
  TextWriter out(file);
  if (header || !set.intensity.empty() || !set.colors.empty() || !columns.empty()) {
    std::string names = "x,y,z";
    if (!set.normals.empty()) names += ",nx,ny,nz";
    if (!set.intensity.empty()) names += std::string(",") + intensity_name;
    if (!set.colors.empty()) names += ",red,green,blue";
    for (const auto& column : columns) names += "," + column.first;
    for (char& c : names) c = c == ',' ? separator : c;
    out << (separator == ' ' ? "# " : "") << names << '\n';
  }
  for (std::size_t i = 0; i < set.size(); ++i) {
    report(set, i, context);
    const Vec3& p = set.points[i];
    out << p[0] << separator << p[1] << separator << p[2];
    if (!set.normals.empty())
      for (int k = 0; k < 3; ++k) out << separator << set.normals[i][k];
    if (!set.intensity.empty()) out << separator << set.intensity[i];
    if (!set.colors.empty())
      for (const std::uint8_t c : set.colors[i]) out << separator << static_cast<int>(c);
    for (const auto& column : columns) out << separator << (*column.second)[i];
    out << '\n';
  }
}

void write_pcd(AtomicFile& file, const PointSet& set, Context& context) {
  const NamedColumns columns = numbers_of(set);
  std::string names, sizes, types, counts;
  const auto declare = [&](const std::string& name, int size, char type) {
    names += " " + name;
    sizes += fmt::format(" {}", size);
    types += fmt::format(" {}", type);
    counts += " 1";
  };
  for (const char* name : {"x", "y", "z"}) declare(name, 8, 'F');
  if (!set.normals.empty())
    for (const char* name : {"normal_x", "normal_y", "normal_z"}) declare(name, 8, 'F');
  if (!set.intensity.empty()) declare(intensity_name, 8, 'F');
  if (!set.colors.empty()) declare("rgb", 4, 'U');
  for (const auto& column : columns) declare(column.first, 8, 'F');
  file.write(
      fmt::format("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\n"
                  "WIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                  names, sizes, types, counts, set.size(), set.size()));
  for (std::size_t i = 0; i < set.size(); ++i) {
    report(set, i, context);
    for (int k = 0; k < 3; ++k) file.write_value(set.points[i][k]);
    if (!set.normals.empty())
      for (int k = 0; k < 3; ++k) file.write_value(set.normals[i][k]);
    if (!set.intensity.empty()) file.write_value(set.intensity[i]);
    if (!set.colors.empty()) {
      const auto& [red, green, blue] = set.colors[i];
      file.write_value(static_cast<std::uint32_t>(red << 16 | green << 8 | blue));
    }
    for (const auto& column : columns) file.write_value((*column.second)[i]);
  }
}

}  // namespace tri::io_detail

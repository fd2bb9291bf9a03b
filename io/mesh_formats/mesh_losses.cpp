#include "io/mesh_formats/mesh_losses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/pictures/face_color.hpp"

namespace tri::io_detail {
namespace {

/// Every triangle has a colour of whole numbers, or none at all (NaN).
bool has_writable_face_colors(const Soup& soup) {
  if (!has_face_colors(soup)) return false;
  const std::vector<double>&red = soup.face_scalars.at("red"), &green = soup.face_scalars.at("green"),
        &blue = soup.face_scalars.at("blue");
  std::array<std::uint8_t, 3> color{};
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    if (!face_color(soup, i, color) && !(std::isnan(red[i]) && std::isnan(green[i]) && std::isnan(blue[i])))
      return false;
  return true;
}

bool is_color(const std::string& name) {
  return name == "red" || name == "green" || name == "blue";
}

/// Whether the format has a place for this face scalar.
bool holds_face_scalar(const Soup& soup, const std::string& name, const std::vector<double>& values, MeshFormat format,
                       bool ascii) {
  const bool labelled = soup.face_labels.contains(name);
  switch (format) {
    case MeshFormat::ply:
    case MeshFormat::vtk:
      return true;
    case MeshFormat::stl:
      return name == "attribute" && !ascii && is_stl_attribute(values);
    case MeshFormat::obj:
      return labelled && (name == "group" || name == "object" || name == "material");
    case MeshFormat::off:
      return is_color(name) && has_writable_face_colors(soup);
    case MeshFormat::threemf:
      // A triangle has one property: a colour for each corner, or a material with a colour.
      if (soup.vertex_colors.empty() && (name == "material" || is_color(name)))
        return is_color(name) ? has_writable_face_colors(soup) : labelled;
      return labelled && name == "object";
    case MeshFormat::gltf:
      return labelled && (name == "object" || name == "material");
  }
  return false;
}

bool holds_corner_scalar(const Soup& soup, const std::string& name, MeshFormat format) {
  if ((name == "s" || name == "t") && has_corner_scalars(soup, {"s", "t"}))
    return format == MeshFormat::obj || format == MeshFormat::ply || format == MeshFormat::gltf ||
           (format == MeshFormat::off && !vertex_textures(soup).empty());
  const bool normal = name == "nx" || name == "ny" || name == "nz";
  return format == MeshFormat::obj && normal && has_corner_scalars(soup, {"nx", "ny", "nz"});
}

bool holds_normals(const Soup& soup, MeshFormat format) {
  // Corners of OBJ have one normal.
  if (format == MeshFormat::obj) return !has_corner_scalars(soup, {"nx", "ny", "nz"});
  return format != MeshFormat::stl && format != MeshFormat::threemf;
}

/// Vertices that a format without lists of vertices does not write.
std::size_t unused_vertices(const Soup& soup) {
  std::vector<bool> used(soup.points.size());
  for (const Triangle& triangle : soup.triangles)
    for (const std::uint32_t v : triangle) used[v] = true;
  return static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
}

}  // namespace

bool has_corner_scalars(const Soup& soup, std::initializer_list<const char*> names) {
  return std::all_of(names.begin(), names.end(), [&](const char* name) { return soup.corner_scalars.contains(name); });
}

std::vector<std::array<double, 2>> vertex_textures(const Soup& soup) {
  std::vector<std::array<double, 2>> result;
  if (!has_corner_scalars(soup, {"s", "t"})) return result;
  const std::vector<double>&s = soup.corner_scalars.at("s"), &t = soup.corner_scalars.at("t");
  std::vector<char> seen(soup.points.size(), 0);
  result.resize(soup.points.size());
  std::size_t found = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::uint32_t v = soup.triangles[i / 3][i % 3];
    const std::array<double, 2> place{s[i], t[i]};
    if (!std::isfinite(place[0]) || !std::isfinite(place[1]) || (seen[v] && place != result[v])) return {};
    found += !seen[v];
    seen[v] = 1;
    result[v] = place;
  }
  if (found < result.size()) result.clear();
  return result;
}

void note_what_is_lost(const Soup& soup, bool ascii, MeshWriteReport& report) {
  const std::string format(name_of(report.format));
  const bool no_vertices =
      report.format == MeshFormat::stl || (report.format == MeshFormat::gltf && soup.triangles.empty());
  if (const std::size_t unused = no_vertices ? unused_vertices(soup) : 0; unused > 0)
    report.notes.push_back(fmt::format("{} holds no vertex without a triangle: {} were not written", format, unused));
  if (!soup.vertex_normals.empty() && !holds_normals(soup, report.format)) {
    if (report.format == MeshFormat::obj)
      report.notes.emplace_back(
          "vertices keep no normals of their own: corners have theirs, and OBJ holds one for each corner");
    else
      report.notes.push_back(format + " holds no vertex normals: they were not written");
  }
  if (!soup.vertex_colors.empty() && report.format == MeshFormat::stl)
    report.notes.push_back(format + " holds no vertex colours: they were not written");
  std::array<std::string, 4> lost;
  const auto lose = [&](std::size_t kind, const std::string& name) {
    lost[kind] += (lost[kind].empty() ? "" : ", ") + name;
  };
  const bool names_scalars = report.format == MeshFormat::ply || report.format == MeshFormat::vtk;
  for (const auto& [name, values] : soup.vertex_scalars)
    if (!names_scalars && report.format != MeshFormat::gltf) lose(0, name);
  for (const auto& [name, values] : soup.face_scalars)
    if (!holds_face_scalar(soup, name, values, report.format, ascii)) lose(1, name);
  for (const auto& [name, values] : soup.corner_scalars)
    if (!holds_corner_scalar(soup, name, report.format)) lose(2, name);
  for (const auto& [name, values] : soup.face_labels)
    if (names_scalars) lose(3, name);
  static constexpr const char* kinds[] = {"vertex scalars", "face scalars", "scalars of corners",
                                          "names (their numbers were written)"};
  for (std::size_t kind = 0; kind < lost.size(); ++kind)
    if (!lost[kind].empty())
      report.notes.push_back(fmt::format("{} holds no {}: {} were not written", format, kinds[kind], lost[kind]));
}

}  // namespace tri::io_detail

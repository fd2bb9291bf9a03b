#include "meshops/points/point_soup.hpp"

#include <fmt/format.h>

#include <utility>

#include "meshops/error.hpp"

namespace tri {

bool names_intensity(const std::string& name) {
  std::string lower;
  for (const char c : name) lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return lower == intensity_name || lower == "scalar_intensity" || lower == "reflectance";
}

Soup to_soup(PointSet set) {
  Soup soup;
  soup.points = std::move(set.points);
  soup.vertex_normals = std::move(set.normals);
  soup.vertex_colors = std::move(set.colors);
  soup.vertex_scalars = std::move(set.scalars);
  if (!set.intensity.empty()) soup.vertex_scalars[intensity_name] = std::move(set.intensity);
  return soup;
}

PointSet to_points(Soup soup) {
  PointSet set;
  set.points = std::move(soup.points);
  set.normals = std::move(soup.vertex_normals);
  set.colors = std::move(soup.vertex_colors);
  for (auto& [name, values] : soup.vertex_scalars) {
    if (set.intensity.empty() && names_intensity(name))
      set.intensity = std::move(values);
    else
      set.scalars[name] = std::move(values);
  }
  return set;
}

void carry_columns(Soup& mesh, const PointSet& points, std::span<const std::uint32_t> original) {
  const auto found = mesh.vertex_scalars.find("point_index");
  if (found == mesh.vertex_scalars.end()) throw InvalidInput("the mesh does not say which point a vertex is");
  std::vector<std::uint32_t> point_of;
  point_of.reserve(found->second.size());
  for (const double index : found->second) {
    if (!(index >= 0 && index < static_cast<double>(points.size())))
      throw InvalidInput(fmt::format("a vertex is point {} of {}", index, points.size()));
    point_of.push_back(static_cast<std::uint32_t>(index));
  }
  const auto carry = [&](const std::string& name, const std::vector<double>& values) {
    std::vector<double> column;
    column.reserve(point_of.size());
    for (const std::uint32_t p : point_of) column.push_back(values[p]);
    mesh.vertex_scalars[mesh.vertex_scalars.contains(name) ? "input_" + name : name] = std::move(column);
  };
  if (!points.intensity.empty()) carry(intensity_name, points.intensity);
  for (const auto& [name, values] : points.scalars) carry(name, values);
  if (!points.colors.empty()) {
    mesh.vertex_colors.clear();
    mesh.vertex_colors.reserve(point_of.size());
    for (const std::uint32_t p : point_of) mesh.vertex_colors.push_back(points.colors[p]);
  }
  if (original.empty()) return;
  std::vector<double>& index = mesh.vertex_scalars["point_index"];
  for (std::size_t v = 0; v < index.size(); ++v) index[v] = original[point_of[v]];
}

}  // namespace tri

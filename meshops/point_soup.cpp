#include "meshops/point_soup.hpp"

#include <utility>

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

}  // namespace tri

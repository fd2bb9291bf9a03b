#include "libtri/deviation.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "libtri/model/outward_normals.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr double spot_radius = 0.1;  // of the diagonal

void check(std::span<const Vec3> points, std::span<const Foot> feet, const DeviationOptions& options) {
  if (points.size() != feet.size())
    throw InvalidInput(std::to_string(points.size()) + " points, but " + std::to_string(feet.size()) + " feet");
  if (options.max_distance && !(*options.max_distance > 0))
    throw InvalidInput("max_distance is " + std::to_string(*options.max_distance) + "; it must be above 0");
  if (options.tolerance && !(options.tolerance->low <= options.tolerance->high))
    throw InvalidInput("the tolerance ends at " + std::to_string(options.tolerance->high) +
                       ", below its beginning at " + std::to_string(options.tolerance->low));
  for (std::size_t i = 0; i < feet.size(); ++i)
    if (feet[i].face < 0) throw InvalidInput("point " + std::to_string(i) + " has a coordinate that is not finite");
}

// The statistics of values[first, end) with indices of points instead of places in the list.
ValueStatistics of_points(std::span<const double> values, std::span<const std::uint32_t> points,
                          const std::optional<Tolerance>& tolerance, const Context& context) {
  ValueStatistics s = value_statistics(values, tolerance, context);
  if (s.count > 0) {
    s.min_index = points[s.min_index];
    s.max_index = points[s.max_index];
  }
  return s;
}

}  // namespace

Deviations deviations(const CadModel& model, std::span<const Vec3> points, std::span<const Foot> feet,
                      const DeviationOptions& options, const Context& context) {
  check(points, feet, options);
  Deviations result;
  const double limit = options.max_distance.value_or(std::numeric_limits<double>::infinity());
  std::vector<double> severity(feet.size(), -std::numeric_limits<double>::infinity());
  // Points that count, gathered by face with a counting sort; within a face they keep their order.
  std::vector<std::size_t> first(model.faces.size() + 1, 0);
  std::vector<std::uint32_t> near;
  std::vector<double> near_values;
  result.values.reserve(feet.size());
  result.faces.reserve(feet.size());
  for (std::uint32_t i = 0; i < feet.size(); ++i) {
    const Foot& foot = feet[i];
    result.values.push_back(foot.deviation);
    result.faces.push_back(model.faces[static_cast<std::size_t>(foot.face)].index);
    if (std::abs(foot.deviation) > limit) {
      result.far.push_back(i);
      continue;
    }
    severity[i] = options.tolerance ? options.tolerance->excess(foot.deviation) : std::abs(foot.deviation);
    near.push_back(i);
    near_values.push_back(foot.deviation);
    ++first[static_cast<std::size_t>(foot.face) + 1];
  }
  result.overall = of_points(near_values, near, options.tolerance, context);

  for (std::size_t f = 0; f < model.faces.size(); ++f) first[f + 1] += first[f];
  std::vector<std::uint32_t> by_face(near.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const std::uint32_t i : near) by_face[next[static_cast<std::size_t>(feet[i].face)]++] = i;
  for (std::size_t k = 0; k < by_face.size(); ++k) near_values[k] = feet[by_face[k]].deviation;
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const CadFace& face = model.faces[f];
    const std::size_t begin = first[f], count = first[f + 1] - begin;
    result.per_face.push_back({face.index, face.name, face.surface_type, face.area,
                               of_points(std::span(near_values).subspan(begin, count),
                                         std::span(by_face).subspan(begin, count), options.tolerance, context)});
  }

  for (const std::uint32_t i : worst_places(points, severity, spot_radius * model.diagonal, options.spots))
    result.spots.push_back({i, points[i], feet[i].point, feet[i].deviation, result.faces[i]});
  return result;
}

std::vector<Foot> feet_of(const Mesh& mesh, const CadModel& model) {
  OpenMesh::VPropHandleT<int> face;
  OpenMesh::VPropHandleT<Vec2> uv;
  OpenMesh::VPropHandleT<double> deviation;
  if (!mesh.get_property_handle(face, property::cad_face) || !mesh.get_property_handle(uv, property::uv) ||
      !mesh.get_property_handle(deviation, property::deviation))
    throw InvalidInput("the mesh has no properties that tie it to a model");
  std::map<int, std::int32_t> position;
  for (std::size_t f = 0; f < model.faces.size(); ++f) position[model.faces[f].index] = static_cast<std::int32_t>(f);
  std::vector<std::optional<TrimRegion>> regions(model.faces.size());
  std::vector<Foot> feet;
  feet.reserve(mesh.n_vertices());
  for (const VertexHandle v : mesh.vertices()) {
    const auto found = position.find(mesh.property(face, v));
    if (found == position.end())
      throw InvalidInput("vertex " + std::to_string(v.idx()) + " lies on no face of the model");
    Foot foot;
    foot.face = found->second;
    foot.uv = mesh.property(uv, v);
    foot.deviation = mesh.property(deviation, v);
    const auto f = static_cast<std::size_t>(foot.face);
    foot.point = model.faces[f].surface->point(foot.uv[0], foot.uv[1]);
    if (!regions[f]) regions[f].emplace(model.faces[f]);
    const Vec3 normal = outward_normal(model.faces[f], *regions[f], foot.uv);
    for (int k = 0; k < 3; ++k) foot.normal[static_cast<std::size_t>(k)] = static_cast<float>(normal[k]);
    feet.push_back(foot);
  }
  return feet;
}

std::vector<double> counted_values(const Deviations& d) {
  std::vector<double> values;
  values.reserve(d.values.size() - d.far.size());
  for (std::size_t i = 0, next = 0; i < d.values.size(); ++i) {
    if (next < d.far.size() && d.far[next] == i)
      ++next;
    else
      values.push_back(d.values[i]);
  }
  return values;
}

}  // namespace tri

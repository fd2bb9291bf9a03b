#include "libtri/triangulation/shell/connect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libtri/triangulation/shell/delaunay_flips.hpp"
#include "libtri/triangulation/shell/insertion.hpp"
#include "libtri/triangulation/shell/vertex_removal.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/disjoint_sets.hpp"

namespace tri {
namespace {

/// A face with fewer points than this says nothing about its point spacing.
constexpr std::size_t enough_points = 8;

/// Half the point spacing of the densest face around each vertex of the tessellation; infinite for measured points.
std::vector<float> edge_length_limits(const CadModel& model, const Tessellation& mesh, std::span<const Foot> feet,
                                      std::size_t vertices) {
  std::vector<double> area(model.faces.size(), 0);
  std::vector<std::size_t> count(model.faces.size(), 0);
  double total = 0;
  std::size_t registered = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& q = mesh.triangles[t];
    const Vec3& a = mesh.points[q[0]];
    const double own = 0.5 * ((mesh.points[q[1]] - a) % (mesh.points[q[2]] - a)).norm();
    area[mesh.faces[t]] += own;
    total += own;
  }
  for (const Foot& foot : feet)
    if (foot.face >= 0) ++count[foot.face], ++registered;
  const double usual = std::sqrt(total / static_cast<double>(std::max<std::size_t>(1, registered)));
  std::vector<float> limit(vertices, std::numeric_limits<float>::infinity());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int f = mesh.faces[t];
    const double spacing = count[f] >= enough_points ? std::sqrt(area[f] / static_cast<double>(count[f])) : usual;
    for (std::uint32_t v : mesh.triangles[t]) limit[v] = std::min(limit[v], static_cast<float>(0.5 * spacing));
  }
  return limit;
}

}  // namespace

ShellConnection connect_by_shell(const CadModel& model, const Tessellation& tessellation, std::span<const Foot> feet,
                                 Context& context) {
  context.progress("insert points", 0);
  EditMesh mesh = insert_feet(model, tessellation, feet, context);
  context.progress("insert points", 0.5);
  delaunay_flips(mesh, {}, context);
  context.progress("insert points", 0.9);
  std::vector<float> limits = edge_length_limits(model, tessellation, feet, mesh.vertices.size());
  context.checkpoint();
  split_encroached_edges(mesh, limits, context);
  context.checkpoint();
  measure_vertex_areas(mesh);
  context.checkpoint();
  context.progress("insert points", 1);
  remove_model_vertices(mesh, context);
  context.progress("optimise", 0);
  delaunay_flips(mesh, {}, context);
  cost_flips(mesh, {}, context);
  context.progress("optimise", 1);

  // What is left of the model goes: whole parts without points, and stars that could not be closed.
  context.checkpoint();
  Pace pace(context);
  ShellConnection result;
  DisjointSets parts(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t, pace())
    if (mesh.alive(static_cast<std::int32_t>(t)))
      for (int k = 1; k < 3; ++k) parts.join(mesh.triangles[t][0], mesh.triangles[t][k]);
  std::vector<bool> has_point(mesh.vertices.size(), false);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (mesh.vertices[v].point >= 0) has_point[parts.find(v)] = true;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].point >= 0 || mesh.vertex_triangle[v] < 0) continue;
    if (has_point[parts.find(v)]) {
      ++result.open_stars;
    } else if (parts.find(v) == v) {
      ++result.lost_shells;
    }
  }
  std::vector<std::int32_t> renumbered(mesh.triangles.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    pace();
    if (!mesh.alive(static_cast<std::int32_t>(t))) continue;
    Triangle points;
    bool measured = true;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t point = mesh.vertices[mesh.triangles[t][k]].point;
      measured &= point >= 0;
      points[k] = static_cast<std::uint32_t>(point);
    }
    if (!measured) continue;
    renumbered[t] = static_cast<std::int32_t>(result.mesh.triangles.size());
    result.mesh.triangles.push_back(points);
  }
  result.mesh.neighbors.resize(result.mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t, pace())
    if (renumbered[t] >= 0)
      for (int k = 0; k < 3; ++k) {
        const std::int32_t n = mesh.neighbors[t][k];
        result.mesh.neighbors[renumbered[t]][k] = n < 0 ? -1 : renumbered[n];
      }
  return result;
}

}  // namespace tri

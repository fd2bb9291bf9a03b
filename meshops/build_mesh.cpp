#include "meshops/build_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "meshops/error.hpp"
#include "meshops/side_pairs.hpp"
#include "meshops/to_soup.hpp"

namespace tri {
namespace {

constexpr std::int32_t none = SidePairs::none;
constexpr std::size_t places_named = 10;

void check_sizes(std::size_t points, std::span<const Triangle> triangles) {
  if (triangles.size() >= (std::size_t{1} << 31) / 3 || points >= (std::size_t{1} << 31))
    throw InvalidInput(
        fmt::format("{} points and {} triangles are more than a mesh can number", points, triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto [a, b, c] = triangles[i];
    if (std::max({a, b, c}) >= points)
      throw InvalidInput(
          fmt::format("triangle {} names vertex {}, but there are {} points", i, std::max({a, b, c}), points));
  }
}

void check_attribute(const std::string& name, std::size_t have, std::size_t expected) {
  if (have != expected)
    throw InvalidInput(fmt::format("attribute {} has {} values instead of {}", name, have, expected));
}

void check_attributes(const Soup& soup) {
  for (const auto& [name, values] : soup.vertex_scalars) check_attribute(name, values.size(), soup.points.size());
  for (const auto& [name, values] : soup.face_scalars) check_attribute(name, values.size(), soup.triangles.size());
  if (!soup.vertex_colors.empty()) check_attribute("vertex_colors", soup.vertex_colors.size(), soup.points.size());
  if (!soup.vertex_normals.empty()) check_attribute("vertex_normals", soup.vertex_normals.size(), soup.points.size());
}

bool repeats_vertex(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Writes all links of a manifold triangle list. `twin` is used up: entries become half-edge numbers.
void link(std::span<const Triangle> triangles, std::size_t vertices, std::vector<std::int32_t>& twin, Mesh& mesh) {
  std::size_t alone = 0;
  for (const std::int32_t t : twin) alone += t == none;
  mesh.resize(vertices, (twin.size() + alone) / 2, triangles.size());

  std::vector<HalfedgeHandle> boundary;
  boundary.reserve(alone);
  int edges = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    const auto first = static_cast<std::int32_t>(3 * i);
    HalfedgeHandle h[3];
    for (int k = 0; k < 3; ++k) {
      std::int32_t& entry = twin[first + k];
      if (entry != none && entry < first) {
        h[k] = HalfedgeHandle(twin[entry] + 1);
      } else {
        h[k] = HalfedgeHandle(2 * edges++);
        if (entry == none) {
          const HalfedgeHandle outside(h[k].idx() + 1);
          mesh.set_vertex_handle(outside, VertexHandle(static_cast<int>(t[k])));
          boundary.push_back(outside);
        }
      }
      entry = h[k].idx();
    }
    const FaceHandle f(static_cast<int>(i));
    for (int k = 0; k < 3; ++k) {
      mesh.set_vertex_handle(h[k], VertexHandle(static_cast<int>(t[k == 2 ? 0 : k + 1])));
      mesh.set_face_handle(h[k], f);
      mesh.set_next_halfedge_handle(h[k], h[k == 2 ? 0 : k + 1]);
      mesh.set_halfedge_handle(VertexHandle(static_cast<int>(t[k])), h[k]);
    }
    mesh.set_halfedge_handle(f, h[0]);
  }
  // Circulators that start at a boundary vertex rely on its outgoing half-edge being the boundary one.
  for (const HalfedgeHandle b : boundary) mesh.set_halfedge_handle(mesh.from_vertex_handle(b), b);
  for (const HalfedgeHandle b : boundary)
    mesh.set_next_halfedge_handle(b, mesh.halfedge_handle(mesh.to_vertex_handle(b)));
}

template <class Items, class Text>
void note_places(Report& report, const Items& items, const std::string& what, const Text& text) {
  for (std::size_t i = 0; i < std::min(items.size(), places_named); ++i)
    report.notes.push_back(fmt::format("{}: {}", what, text(items[i])));
  if (items.size() > places_named)
    report.notes.push_back(fmt::format("{}: {} more", what, items.size() - places_named));
}

void set_figure(Report& report, const char* name, std::size_t count) {
  if (count) report.figures[name] = static_cast<double>(count);
}

void report_repairs(const ManifoldRepairs& repairs, std::size_t points,
                    const std::vector<std::uint32_t>& triangle_of_face, Report& report) {
  const auto triangle = [&](std::uint32_t f) { return triangle_of_face[f]; };
  const auto edge = [](const std::array<std::uint32_t, 2>& ends) { return fmt::format("{} - {}", ends[0], ends[1]); };
  set_figure(report, "triangles reversed", repairs.reversed_triangles.size());
  set_figure(report, "edges split", repairs.crowded.size());
  set_figure(report, "edges cut", repairs.cut.size());
  set_figure(report, "vertices split", repairs.copied_points.size());
  set_figure(report, "triangles detached", repairs.detached_triangles.size());
  note_places(report, repairs.reversed_triangles, "reversed triangle", triangle);
  note_places(report, repairs.crowded, "split edge of three or more triangles", edge);
  note_places(report, repairs.cut, "cut edge whose triangles run the same way", edge);
  note_places(report, repairs.copied_points, "split vertex", [](std::uint32_t p) { return p; });
  note_places(report, repairs.detached_triangles, "detached triangle", triangle);

  report.vertices_added = repairs.copied_points.size();
  for (std::size_t i = 0; i < repairs.copied_points.size(); ++i)
    report.touched_vertices.push_back(static_cast<std::uint32_t>(points + i));
  report.touched_faces = repairs.reversed_triangles;
  report.touched_faces.insert(report.touched_faces.end(), repairs.detached_triangles.begin(),
                              repairs.detached_triangles.end());
  std::sort(report.touched_faces.begin(), report.touched_faces.end());
  report.touched_faces.erase(std::unique(report.touched_faces.begin(), report.touched_faces.end()),
                             report.touched_faces.end());
}

/// @param given triangles without a repeated vertex
void build(std::span<const Vec3> points, std::span<const Triangle> given, SidePairs& pairs, BuiltMesh& result,
           Context& context) {
  std::vector<Triangle> repaired;
  ManifoldRepairs repairs;
  context.checkpoint();
  if (!pairs.same_way.empty() || !pairs.crowded.empty() ||
      !vertices_with_several_fans(given, points.size(), pairs.twin).empty()) {
    repaired.assign(given.begin(), given.end());
    repairs = make_manifold(repaired, points, pairs, context);
    given = repaired;
  }
  context.checkpoint();
  context.progress("build-mesh", 0.5);

  const std::size_t vertices = points.size() + repairs.copied_points.size();
  link(given, vertices, pairs.twin, result.mesh);
  result.point_of_vertex.resize(points.size());
  std::iota(result.point_of_vertex.begin(), result.point_of_vertex.end(), 0u);
  result.point_of_vertex.insert(result.point_of_vertex.end(), repairs.copied_points.begin(),
                                repairs.copied_points.end());
  for (std::size_t v = 0; v < vertices; ++v)
    result.mesh.set_point(VertexHandle(static_cast<int>(v)), points[result.point_of_vertex[v]]);
  report_repairs(repairs, points.size(), result.triangle_of_face, result.report);
}

/// For each side the side of the known neighbour on the same edge.
std::vector<std::int32_t> twins_of_neighbors(std::span<const Triangle> triangles,
                                             std::span<const std::array<std::int32_t, 3>> neighbors) {
  if (neighbors.size() != triangles.size())
    throw InvalidInput(fmt::format("{} triples of neighbours for {} triangles", neighbors.size(), triangles.size()));
  std::vector<std::int32_t> twin(3 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      // The side from corner k lies opposite corner k - 1.
      const int opposite = k == 0 ? 2 : k - 1;
      const std::int32_t other = neighbors[i][opposite];
      std::int32_t& entry = twin[3 * i + k];
      entry = none;
      if (other == -1) continue;
      const std::uint32_t from = triangles[i][k], to = triangles[i][k == 2 ? 0 : k + 1];
      if (other >= 0 && other < static_cast<std::int32_t>(triangles.size())) {
        for (int j = 0; j < 3; ++j) {
          if (triangles[other][j] == to && triangles[other][j == 2 ? 0 : j + 1] == from &&
              neighbors[other][j == 0 ? 2 : j - 1] == static_cast<std::int32_t>(i))
            entry = 3 * other + j;
        }
      }
      if (entry == none)
        throw InvalidInput(
            fmt::format("triangle {} has neighbour {} across edge {} - {}, which does not fit", i, other, from, to));
    }
  }
  return twin;
}

}  // namespace

BuiltMesh build_mesh(const Soup& soup, Context& context) {
  check_sizes(soup.points.size(), soup.triangles);
  check_attributes(soup);
  context.progress("build-mesh", 0);

  BuiltMesh result;
  std::span<const Triangle> triangles = soup.triangles;
  std::vector<Triangle> kept;
  std::vector<std::uint32_t> set_aside;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (repeats_vertex(triangles[i])) set_aside.push_back(static_cast<std::uint32_t>(i));
  if (set_aside.empty()) {
    result.triangle_of_face.resize(triangles.size());
    std::iota(result.triangle_of_face.begin(), result.triangle_of_face.end(), 0u);
  } else {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (repeats_vertex(triangles[i])) continue;
      kept.push_back(triangles[i]);
      result.triangle_of_face.push_back(static_cast<std::uint32_t>(i));
    }
    triangles = kept;
    result.report.faces_removed = set_aside.size();
    result.report.skipped["names a vertex twice"] = set_aside.size();
    note_places(result.report, set_aside, "set aside triangle", [](std::uint32_t i) { return i; });
  }
  SidePairs pairs = pair_sides(triangles, soup.points.size(), context);
  build(soup.points, triangles, pairs, result, context);
  set_attributes(soup, result.point_of_vertex, result.triangle_of_face, result.mesh);
  context.progress("build-mesh", 1);
  return result;
}

BuiltMesh build_mesh(std::span<const Vec3> points, std::span<const Triangle> triangles,
                     std::span<const std::array<std::int32_t, 3>> neighbors, Context& context) {
  check_sizes(points.size(), triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (repeats_vertex(triangles[i])) throw InvalidInput(fmt::format("triangle {} names a vertex twice", i));
  context.progress("build-mesh", 0);
  BuiltMesh result;
  result.triangle_of_face.resize(triangles.size());
  std::iota(result.triangle_of_face.begin(), result.triangle_of_face.end(), 0u);
  SidePairs pairs;
  pairs.twin = twins_of_neighbors(triangles, neighbors);
  build(points, triangles, pairs, result, context);
  context.progress("build-mesh", 1);
  return result;
}

}  // namespace tri

#include "meshops/build_mesh.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

#include "meshops/editing/label_property.hpp"
#include "meshops/error.hpp"
#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr std::int32_t no_side = SidePairs::none;
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

bool whole_numbers(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double v) {
    return v == std::floor(v) && std::abs(v) <= static_cast<double>(std::numeric_limits<int>::max());
  });
}

template <class T, class Value>
void add_vertex_property(Mesh& mesh, const BuiltMesh& built, const std::string& name, Pace& pace, const Value& value) {
  OpenMesh::VPropHandleT<T> handle;
  mesh.add_property(handle, name);
  for (const VertexHandle v : mesh.vertices()) {
    pace();
    mesh.property(handle, v) = value(built.point_of(v));
  }
}

/// The value of a corner goes to the half-edge of its triangle that ends there.
void set_corners(const Soup& soup, const std::vector<double>& values, const std::string& name, Mesh& mesh,
                 const BuiltMesh& built, Pace& pace) {
  OpenMesh::HPropHandleT<double> handle;
  mesh.add_property(handle, "h:" + name);
  for (const FaceHandle f : mesh.faces()) {
    pace();
    const std::uint32_t t = built.triangle_of(f);
    HalfedgeHandle h = mesh.halfedge_handle(f);
    for (int i = 0; i < 3; ++i, h = mesh.next_halfedge_handle(h)) {
      const std::uint32_t point = built.point_of(mesh.to_vertex_handle(h));
      for (std::size_t k = 0; k < 3; ++k)
        if (soup.triangles[t][k] == point) mesh.property(handle, h) = values[3 * t + k];
    }
  }
}

/// Soup attributes become properties of the mesh.
void set_attributes(const Soup& soup, Mesh& mesh, const BuiltMesh& built, const Context& context) {
  Pace pace(context);
  const bool has_uv = soup.vertex_scalars.contains("u") && soup.vertex_scalars.contains("v");
  for (const auto& scalar : soup.vertex_scalars) {
    const std::string& name = scalar.first;
    const std::vector<double>& values = scalar.second;  // no binding: lambdas capture none before Clang 16
    const std::string full = "v:" + name;
    if (has_uv && name == "v") continue;
    if (has_uv && name == "u") {
      const std::vector<double>& v = soup.vertex_scalars.at("v");
      add_vertex_property<Vec2>(mesh, built, property::uv, pace,
                                [&](std::uint32_t i) { return Vec2(values[i], v[i]); });
    } else if ((full == property::point_index || full == property::cad_face) && whole_numbers(values)) {
      add_vertex_property<int>(mesh, built, full, pace, [&](std::uint32_t i) { return static_cast<int>(values[i]); });
    } else {
      add_vertex_property<double>(mesh, built, full, pace, [&](std::uint32_t i) { return values[i]; });
    }
  }
  for (const auto& [name, values] : soup.face_scalars) {
    OpenMesh::FPropHandleT<double> handle;
    mesh.add_property(handle, "f:" + name);
    for (const FaceHandle f : mesh.faces()) {
      pace();
      mesh.property(handle, f) = values[built.triangle_of(f)];
    }
  }
  for (const auto& scalar : soup.corner_scalars) set_corners(soup, scalar.second, scalar.first, mesh, built, pace);
  for (const auto& [name, labels] : soup.face_labels) {
    OpenMesh::MPropHandleT<std::vector<std::string>> handle;
    mesh.add_property(handle, property::labels + name);
    mesh.property(handle) = labels;
  }
  if (!soup.vertex_normals.empty()) {
    mesh.request_vertex_normals();
    for (const VertexHandle v : mesh.vertices()) mesh.set_normal(v, soup.vertex_normals[built.point_of(v)]);
  }
  if (!soup.vertex_colors.empty()) {
    mesh.request_vertex_colors();
    for (const VertexHandle v : mesh.vertices()) {
      const auto [r, g, b] = soup.vertex_colors[built.point_of(v)];
      mesh.set_color(v, {r, g, b});
    }
  }
}

std::size_t count_edges(const SidePairs::Sides& twin) {
  std::size_t alone = 0;
  for (const std::int32_t t : twin) alone += t == no_side;
  return (twin.size() + alone) / 2;
}

constexpr std::size_t link_block = 1 << 14;  // triangles

/// Writes all links of a manifold triangle list. `twin` is used up: entries become half-edge numbers.
///
/// Edges are numbered by their first side, which owns them; counted by blocks, so that every block knows its first
/// number.
void link(std::span<const Triangle> triangles, std::size_t vertices, SidePairs::Sides& twin, Mesh& mesh,
          const Context& context) {
  mesh.resize(vertices, count_edges(twin), triangles.size());
  const std::size_t n_blocks = (triangles.size() + link_block - 1) / link_block;
  const auto for_blocks = [&](const auto& visit) {
    tbb::parallel_for(std::size_t{0}, n_blocks, [&](std::size_t block) {
      context.checkpoint();
      for (std::size_t i = block * link_block; i < std::min((block + 1) * link_block, triangles.size()); ++i)
        visit(block, i);
    });
  };
  std::vector<int> edges(n_blocks + 1, 0);
  std::vector<std::uint8_t> owned(triangles.size(), 0);  // bit k: the side from corner k owns its edge
  for_blocks([&](std::size_t block, std::size_t i) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t entry = twin[3 * i + k];
      if (entry != no_side && entry < static_cast<std::int32_t>(3 * i)) continue;
      owned[i] |= static_cast<std::uint8_t>(1 << k);
      ++edges[block + 1];
    }
  });
  for (std::size_t block = 0; block < n_blocks; ++block) edges[block + 1] += edges[block];

  // An entry of `twin` is read and written by the owner of its edge alone.
  std::vector<std::vector<HalfedgeHandle>> boundaries(n_blocks);
  for_blocks([&](std::size_t block, std::size_t i) {
    for (int k = 0; k < 3; ++k) {
      if ((owned[i] >> k & 1) == 0) continue;
      std::int32_t& entry = twin[3 * i + k];
      const HalfedgeHandle h(2 * edges[block]++), outside(h.idx() + 1);
      if (entry == no_side) {
        mesh.set_vertex_handle(outside, VertexHandle(static_cast<int>(triangles[i][k])));
        boundaries[block].push_back(outside);
      } else {
        twin[entry] = outside.idx();
      }
      entry = h.idx();
    }
  });
  tbb::parallel_invoke(
      [&] {
        for_blocks([&](std::size_t, std::size_t i) {
          const Triangle& t = triangles[i];
          const FaceHandle f(static_cast<int>(i));
          const HalfedgeHandle h[3] = {HalfedgeHandle(twin[3 * i]), HalfedgeHandle(twin[3 * i + 1]),
                                       HalfedgeHandle(twin[3 * i + 2])};
          for (int k = 0; k < 3; ++k) {
            mesh.set_vertex_handle(h[k], VertexHandle(static_cast<int>(t[k == 2 ? 0 : k + 1])));
            mesh.set_face_handle(h[k], f);
            mesh.set_next_halfedge_handle(h[k], h[k == 2 ? 0 : k + 1]);
          }
          mesh.set_halfedge_handle(f, h[0]);
        });
      },
      [&] {
        Pace pace(context);
        for (std::size_t i = 0; i < triangles.size(); ++i, pace())
          for (int k = 0; k < 3; ++k)
            mesh.set_halfedge_handle(VertexHandle(static_cast<int>(triangles[i][k])), HalfedgeHandle(twin[3 * i + k]));
      });
  // Circulators that start at a boundary vertex rely on its outgoing half-edge being the boundary one.
  for (const auto& boundary : boundaries)
    for (const HalfedgeHandle b : boundary) mesh.set_halfedge_handle(mesh.from_vertex_handle(b), b);
  for (const auto& boundary : boundaries)
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

void set_repair_figure(Report& report, const char* name, std::size_t count) {
  if (count) report.figures[name] = static_cast<double>(count);
}

void report_repairs(BuiltMesh& result) {
  const ManifoldRepairs& repairs = result.repairs;
  Report& report = result.report;
  const auto triangle = [&](std::uint32_t f) { return result.triangle_of(FaceHandle(static_cast<int>(f))); };
  const auto edge = [](const std::array<std::uint32_t, 2>& ends) { return fmt::format("{} - {}", ends[0], ends[1]); };
  set_repair_figure(report, "triangles reversed", repairs.reversed_triangles.size());
  set_repair_figure(report, "edges split", repairs.crowded.size());
  set_repair_figure(report, "edges cut", repairs.cut.size());
  set_repair_figure(report, "vertices split", repairs.copied_points.size());
  set_repair_figure(report, "triangles detached", repairs.detached_triangles.size());
  note_places(report, repairs.reversed_triangles, "reversed triangle", triangle);
  note_places(report, repairs.crowded, "split edge of three or more triangles", edge);
  note_places(report, repairs.cut, "cut edge whose triangles run the same way", edge);
  note_places(report, repairs.copied_points, "split vertex", [](std::uint32_t p) { return p; });
  note_places(report, repairs.detached_triangles, "detached triangle", triangle);

  report.vertices_added = repairs.copied_points.size();
  for (std::size_t i = 0; i < repairs.copied_points.size(); ++i)
    report.touched_vertices.push_back(static_cast<std::uint32_t>(result.points + i));
  report.touched_faces = repairs.reversed_triangles;
  report.touched_faces.insert(report.touched_faces.end(), repairs.detached_triangles.begin(),
                              repairs.detached_triangles.end());
  std::sort(report.touched_faces.begin(), report.touched_faces.end());
  report.touched_faces.erase(std::unique(report.touched_faces.begin(), report.touched_faces.end()),
                             report.touched_faces.end());
}

/// @param given triangles without a repeated vertex
/// @param pair gives the `SidePairs` of them
template <class Pair>
void build(std::span<const Vec3> points, std::span<const Triangle> given, const Pair& pair, Mesh& mesh,
           BuiltMesh& result, Context& context) {
  SidePairs pairs;
  const auto place_points = [&] {
    mesh.resize(points.size(), 0, given.size());
    if (!points.empty()) std::copy(points.begin(), points.end(), &mesh.point(VertexHandle(0)));
  };
  // Taking memory costs the mesh as much time as finding its links does, so the two go side by side.
  tbb::parallel_invoke([&] { pairs = pair(); }, place_points);
  context.checkpoint();
  context.progress("build-mesh", 0.4);

  bool manifold = pairs.same_way.empty() && pairs.crowded.empty();
  if (manifold) {
    tbb::parallel_invoke(
        [&] { manifold = vertices_with_several_fans(given, points.size(), pairs.twin, context).empty(); },
        [&] { mesh.resize(points.size(), count_edges(pairs.twin), given.size()); });
  }
  context.checkpoint();
  std::vector<Triangle> repaired;
  if (!manifold) {
    repaired.assign(given.begin(), given.end());
    result.repairs = make_manifold(repaired, points, pairs, context);
    given = repaired;
    context.checkpoint();
  }
  context.progress("build-mesh", 0.6);

  result.points = points.size();
  const std::vector<std::uint32_t>& copied = result.repairs.copied_points;
  link(given, points.size() + copied.size(), pairs.twin, mesh, context);
  for (std::size_t i = 0; i < copied.size(); ++i)
    mesh.set_point(VertexHandle(static_cast<int>(points.size() + i)), points[copied[i]]);
  report_repairs(result);
}

/// Runs `work` on as many threads as the context allows.
template <class Work>
void in_arena(const Context& context, const Work& work) {
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute(work);
}

/// For each side the side of the known neighbour on the same edge. @throws Cancelled
SidePairs::Sides twins_of_neighbors(std::span<const Triangle> triangles,
                                    std::span<const std::array<std::int32_t, 3>> neighbors, const Context& context) {
  if (neighbors.size() != triangles.size())
    throw InvalidInput(fmt::format("{} triples of neighbours for {} triangles", neighbors.size(), triangles.size()));
  SidePairs::Sides twin(3 * triangles.size());
  std::atomic<std::size_t> first_misfit{twin.size()};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), link_block), [&](const auto& range) {
    context.checkpoint();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      for (int k = 0; k < 3; ++k) {
        // The side from corner k lies opposite corner k - 1.
        const std::int32_t other = neighbors[i][k == 0 ? 2 : k - 1];
        std::int32_t& entry = twin[3 * i + k];
        entry = no_side;
        if (other == -1) continue;
        const std::uint32_t from = triangles[i][k], to = triangles[i][k == 2 ? 0 : k + 1];
        if (other >= 0 && other < static_cast<std::int32_t>(triangles.size())) {
          for (int j = 0; j < 3; ++j)
            if (triangles[other][j] == to && triangles[other][j == 2 ? 0 : j + 1] == from &&
                neighbors[other][j == 0 ? 2 : j - 1] == static_cast<std::int32_t>(i))
              entry = 3 * other + j;
        }
        if (entry != no_side) continue;
        std::size_t least = first_misfit;
        while (3 * i + k < least && !first_misfit.compare_exchange_weak(least, 3 * i + k)) {
        }
      }
    }
  });
  if (first_misfit < twin.size()) {
    const std::size_t i = first_misfit / 3, k = first_misfit % 3;
    throw InvalidInput(fmt::format("triangle {} has neighbour {} across edge {} - {}, which does not fit", i,
                                   neighbors[i][k == 0 ? 2 : k - 1], triangles[i][k],
                                   triangles[i][k == 2 ? 0 : k + 1]));
  }
  return twin;
}

void build_known(std::span<const Vec3> points, std::span<const Triangle> triangles,
                 std::span<const std::array<std::int32_t, 3>> neighbors, Mesh& mesh, BuiltMesh& result,
                 Context& context) {
  check_sizes(points.size(), triangles);
  Pace pace(context);
  for (std::size_t i = 0; i < triangles.size(); ++i, pace())
    if (repeats_vertex(triangles[i])) throw InvalidInput(fmt::format("triangle {} names a vertex twice", i));
  context.progress("build-mesh", 0);
  const auto pair = [&] {
    SidePairs pairs;
    pairs.twin = twins_of_neighbors(triangles, neighbors, context);
    return pairs;
  };
  in_arena(context, [&] { build(points, triangles, pair, mesh, result, context); });
  context.progress("build-mesh", 1);
}

/// @param result  gets everything but the mesh
void build_soup(const Soup& soup, Mesh& mesh, BuiltMesh& result, Context& context) {
  check_sizes(soup.points.size(), soup.triangles);
  context.progress("build-mesh", 0);
  check_soup(soup, &context);

  Pace pace(context);
  std::span<const Triangle> triangles = soup.triangles;
  std::vector<Triangle> kept;
  std::vector<std::uint32_t>& set_aside = result.set_aside;
  for (std::size_t i = 0; i < triangles.size(); ++i, pace())
    if (repeats_vertex(triangles[i])) set_aside.push_back(static_cast<std::uint32_t>(i));
  if (!set_aside.empty()) {
    for (std::size_t i = 0; i < triangles.size(); ++i, pace()) {
      if (repeats_vertex(triangles[i])) continue;
      kept.push_back(triangles[i]);
      result.triangle_of_face.push_back(static_cast<std::uint32_t>(i));
    }
    triangles = kept;
    result.report.faces_removed = set_aside.size();
    result.report.skipped["names a vertex twice"] = set_aside.size();
    note_places(result.report, set_aside, "set aside triangle", [](std::uint32_t i) { return i; });
  }
  const auto pair = [&] { return pair_sides(triangles, soup.points.size(), context); };
  in_arena(context, [&] { build(soup.points, triangles, pair, mesh, result, context); });
  set_attributes(soup, mesh, result, context);
  context.progress("build-mesh", 1);
}

}  // namespace

BuiltMesh build_mesh(const Soup& soup, Context& context) {
  BuiltMesh result;
  build_soup(soup, result.mesh, result, context);
  return result;
}

Report build_mesh_into(Mesh& mesh, const Soup& soup, Context& context) {
  if (mesh.n_vertices() > 0 || mesh.n_faces() > 0) throw InvalidInput("build_mesh_into: the mesh is not empty");
  BuiltMesh result;
  build_soup(soup, mesh, result, context);
  return std::move(result.report);
}

BuiltMesh build_mesh(std::span<const Vec3> points, std::span<const Triangle> triangles,
                     std::span<const std::array<std::int32_t, 3>> neighbors, Context& context) {
  BuiltMesh result;
  build_known(points, triangles, neighbors, result.mesh, result, context);
  return result;
}

std::vector<std::uint32_t> build_mesh_into(Mesh& mesh, std::span<const Vec3> points,
                                           std::span<const Triangle> triangles,
                                           std::span<const std::array<std::int32_t, 3>> neighbors, Context& context) {
  if (mesh.n_vertices() > 0 || mesh.n_faces() > 0) throw InvalidInput("build_mesh_into: the mesh is not empty");
  BuiltMesh result;
  build_known(points, triangles, neighbors, mesh, result, context);
  return std::move(result.repairs.copied_points);
}

}  // namespace tri

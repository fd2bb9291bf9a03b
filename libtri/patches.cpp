#include "libtri/patches.hpp"

#include <fmt/core.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "libtri/patches/assemble.hpp"
#include "libtri/shell/delaunay_flips.hpp"
#include "libtri/shell/vertex_removal.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

class Clock {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// The triangles whose corners are all points, of one face each if `one_face`.
PointMesh measured_part(const EditMesh& mesh, std::span<const Foot> feet, bool one_face) {
  std::vector<std::int32_t> number(mesh.triangles.size(), -1);
  PointMesh part;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.alive(static_cast<std::int32_t>(t))) continue;
    Triangle points;
    bool taken = true;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t point = mesh.vertices[mesh.triangles[t][k]].point;
      points[k] = static_cast<std::uint32_t>(point);
      taken = taken && point >= 0 && static_cast<std::size_t>(point) < feet.size() &&
              (!one_face || feet[points[k]].face == feet[points[0]].face);
    }
    if (!taken) continue;
    number[t] = static_cast<std::int32_t>(part.triangles.size());
    part.triangles.push_back(points);
  }
  part.neighbors.resize(part.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (number[t] < 0) continue;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = mesh.neighbors[t][k];
      part.neighbors[static_cast<std::size_t>(number[t])][k] = n < 0 ? -1 : number[static_cast<std::size_t>(n)];
    }
  }
  return part;
}

// Marks the vertices around which flips may be needed: those of faces that their plane shows distorted, and the
// neighbours of auxiliary vertices. Removing one makes no triangle but of these.
std::vector<std::uint8_t> mark_loose(const AssembledPatches& assembled, std::span<const Foot> feet) {
  const EditMesh& mesh = assembled.mesh;
  std::vector<std::uint8_t> loose(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    bool near = false;
    for (const std::uint32_t v : t)
      near |= v >= feet.size() || !assembled.uniform_faces[static_cast<std::size_t>(feet[v].face)];
    if (near)
      for (const std::uint32_t v : t) loose[v] = 1;
  }
  return loose;
}

std::vector<std::int32_t> triangles_at(const EditMesh& mesh, const std::vector<std::uint8_t>& loose) {
  std::vector<std::int32_t> found;
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    const Triangle& q = mesh.triangles[t];
    if (mesh.alive(static_cast<std::int32_t>(t)) && (loose[q[0]] || loose[q[1]] || loose[q[2]]))
      found.push_back(static_cast<std::int32_t>(t));
  }
  return found;
}

}  // namespace

PatchConnection connect_by_patches(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points,
                                   const PatchesOptions& options, Context& context) {
  if (feet.size() != points.size())
    throw InvalidInput(fmt::format("connect_by_patches: {} feet for {} points", feet.size(), points.size()));
  if (!(options.edge_reach > 0) || !(options.edge_spacing > 0))
    throw InvalidInput("connect_by_patches: edge_reach and edge_spacing must be positive");
  PatchConnection result;
  Clock clock;
  const auto step = [&](const char* name) -> Report& {
    Report& report = result.reports.emplace_back();
    report.operation = name;
    report.seconds = clock.lap();
    context.checkpoint();
    return report;
  };

  context.progress("triangulate faces", 0);
  AssembledPatches assembled;
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] { assembled = assemble_patches(model, feet, points, options, context); });
  EditMesh& mesh = assembled.mesh;
  result.duplicates = std::move(assembled.duplicates);
  std::sort(result.duplicates.begin(), result.duplicates.end());
  result.failed_faces = std::move(assembled.failed_faces);
  context.progress("triangulate faces", 1);
  Report& triangulated = step("triangulate-faces");
  triangulated.faces_added = mesh.triangles.size();
  triangulated.figures["auxiliary vertices"] = static_cast<double>(assembled.on_contour.size());
  for (const int f : result.failed_faces)
    triangulated.notes.push_back(fmt::format("face {} could not be triangulated: its trimming loops cross or touch",
                                             model.faces[static_cast<std::size_t>(f)].index));

  if (options.keep_patches) {
    measure_vertex_areas(assembled.separate);
    step("separate-patches").vertices_removed = remove_model_vertices(assembled.separate, context).removed;
    result.patches = measured_part(assembled.separate, feet, true);
    assembled.separate = {};
  }

  // Seams and poles first: contour vertices count as points for that long.
  constexpr std::int32_t pinned = std::numeric_limits<std::int32_t>::max();
  for (std::size_t k = 0; k < assembled.on_contour.size(); ++k)
    if (assembled.on_contour[k]) mesh.vertices[points.size() + k].point = pinned;
  measure_vertex_areas(mesh);
  const std::vector<std::uint8_t> loose = mark_loose(assembled, feet);
  const auto remove = [&](const char* name) {
    const VertexRemoval removal = remove_model_vertices(mesh, context);
    Report& report = step(name);
    report.vertices_removed = removal.removed;
    if (removal.kept > 0) report.skipped["removal would change the topology"] = removal.kept;
  };
  remove("close-seams");
  for (EditMesh::Vertex& v : mesh.vertices)
    if (v.point == pinned) v.point = -1;
  remove("stitch-patches");

  Report& flipped = step("flip-diagonals");
  std::vector<std::int32_t> seeds = triangles_at(mesh, loose);
  flipped.figures["triangles looked at"] = static_cast<double>(seeds.size());
  if (!seeds.empty()) flipped.edges_flipped = cost_flips(mesh, std::move(seeds), context);
  flipped.seconds = clock.lap();

  result.mesh = measured_part(mesh, feet, false);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (mesh.vertex_triangle[v] >= 0 && mesh.vertices[v].point < 0) ++result.open_stars;
  return result;
}

}  // namespace tri

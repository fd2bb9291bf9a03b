#include "libtri/triangulation/patches.hpp"

#include <fmt/core.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "libtri/triangulation/patches/assemble.hpp"
#include "libtri/triangulation/shell/delaunay_flips.hpp"
#include "libtri/triangulation/shell/vertex_removal.hpp"
#include "meshops/error.hpp"
#include "meshops/select_indices.hpp"

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

// The triangles whose corners are all points of one face.
PointMesh measured_part_by_face(const EditMesh& mesh, std::span<const Foot> feet) {
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
              feet[points[k]].face == feet[points[0]].face;
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

// The same of a mesh that is used up, in place: what is left out is replaced from the end. Points come first among its
// vertices.
PointMesh measured_part(EditMesh&& mesh, std::size_t n_points) {
  PointMesh part;
  part.triangles = std::move(mesh.triangles);
  part.neighbors = std::move(mesh.neighbors);
  std::vector<std::uint32_t> gone = select_indices(part.triangles.size(), [&](std::uint32_t t) {
    const Triangle& q = part.triangles[t];
    return q[0] == q[1] || q[0] >= n_points || q[1] >= n_points || q[2] >= n_points;
  });
  const auto relink = [&](std::uint32_t t, std::int32_t to) {
    for (const std::int32_t n : part.neighbors[t])
      if (n >= 0)
        for (std::int32_t& back : part.neighbors[static_cast<std::size_t>(n)])
          if (back == static_cast<std::int32_t>(t)) back = to;
  };
  for (const std::uint32_t t : gone) relink(t, -1);
  std::size_t end = part.triangles.size(), left = gone.size();
  for (std::size_t i = 0; i < left; ++i) {
    while (left > i && gone[left - 1] == end - 1) --left, --end;
    if (left <= i) break;
    const auto last = static_cast<std::uint32_t>(--end);
    relink(last, static_cast<std::int32_t>(gone[i]));
    part.triangles[gone[i]] = part.triangles[last];
    part.neighbors[gone[i]] = part.neighbors[last];
  }
  part.triangles.resize(end);
  part.neighbors.resize(end);
  return part;
}

// Marks the vertices around which flips may be needed: those of faces that their plane shows distorted, and the
// neighbours of auxiliary vertices. Removing one makes no triangle but of these.
std::vector<std::uint8_t> mark_loose(const AssembledPatches& assembled, std::span<const Foot> feet) {
  const EditMesh& mesh = assembled.mesh;
  const auto& uniform = assembled.uniform_faces;
  const bool all_uniform = std::find(uniform.begin(), uniform.end(), 0) == uniform.end();
  std::vector<std::uint8_t> loose(mesh.vertices.size(), 0);
  const auto near = [&](std::uint32_t v) {
    return v >= feet.size() || (!all_uniform && !uniform[static_cast<std::size_t>(feet[v].face)]);
  };
  for (const std::uint32_t t : select_indices(mesh.triangles.size(), [&](std::uint32_t i) {
         const Triangle& q = mesh.triangles[i];
         return near(q[0]) || near(q[1]) || near(q[2]);
       }))
    for (const std::uint32_t v : mesh.triangles[t]) loose[v] = 1;
  return loose;
}

// Ascending.
std::vector<std::uint32_t> triangles_at(const EditMesh& mesh, const std::vector<std::uint8_t>& loose) {
  return select_indices(mesh.triangles.size(), [&](std::uint32_t t) {
    const Triangle& q = mesh.triangles[t];
    return mesh.alive(static_cast<std::int32_t>(t)) && (loose[q[0]] || loose[q[1]] || loose[q[2]]);
  });
}

// Measures the areas of all vertices that a cost can ask for: those of the triangles at loose vertices, and of some
// around them, since flips spread.
void measure_areas_around(EditMesh& mesh, const std::vector<std::uint8_t>& loose) {
  constexpr int steps = 12;
  std::vector<std::uint8_t> wanted(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> front = triangles_at(mesh, loose), next;
  for (const std::uint32_t t : front) wanted[t] = 1;
  for (int step = 0; step < steps; ++step) {
    next.clear();
    for (const std::uint32_t t : front)
      for (const std::int32_t n : mesh.neighbors[t])
        if (n >= 0 && !wanted[static_cast<std::size_t>(n)])
          wanted[static_cast<std::size_t>(n)] = 1, next.push_back(static_cast<std::uint32_t>(n));
    front.swap(next);
  }
  measure_vertex_areas(mesh, select_indices(wanted.size(), [&](std::uint32_t t) { return wanted[t] != 0; }));
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
    context.checkpoint();
    measure_vertex_areas(assembled.separate);
    step("separate-patches").vertices_removed = remove_model_vertices(assembled.separate, context).removed;
    context.checkpoint();
    result.patches = measured_part_by_face(assembled.separate, feet);
    assembled.separate = {};
  }

  // Seams and poles first: contour vertices count as points for that long.
  constexpr std::int32_t pinned = std::numeric_limits<std::int32_t>::max();
  for (std::size_t k = 0; k < assembled.on_contour.size(); ++k)
    if (assembled.on_contour[k]) mesh.vertices[points.size() + k].point = pinned;
  const std::vector<std::uint8_t> loose = mark_loose(assembled, feet);
  context.checkpoint();
  measure_areas_around(mesh, loose);
  context.checkpoint();
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
  context.checkpoint();
  const std::vector<std::uint32_t> at_loose = triangles_at(mesh, loose);
  std::vector<std::int32_t> seeds(at_loose.rbegin(), at_loose.rend());
  flipped.figures["triangles looked at"] = static_cast<double>(seeds.size());
  if (!seeds.empty()) flipped.edges_flipped = cost_flips(mesh, std::move(seeds), context);
  flipped.seconds = clock.lap();

  for (std::size_t v = points.size(); v < mesh.vertices.size(); ++v)
    if (mesh.vertex_triangle[v] >= 0) ++result.open_stars;
  context.checkpoint();
  result.mesh = measured_part(std::move(mesh), points.size());
  return result;
}

}  // namespace tri

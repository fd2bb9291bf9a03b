// Isotropic remeshing of a wavy torus to 0.7 and to twice its edge length; the peer is CGAL's isotropic_remeshing with
// as many rounds. The goals are half of its time and no worse triangles: "in_range" is the share of edges within 4/5 to
// 4/3 of the length aimed at, "angle" the smallest angle (degrees), "angle_1%" that which one triangle in a hundred is
// below, "rms" and "hausdorff" the distance to the input, both sides, as a share of that length; "crossing" pairs of
// triangles that intersect; "check" is the number of faces.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshops/build_mesh.hpp"
#include "meshops/checks/mesh_distance.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/operators/remesh.hpp"
#include "meshops/to_soup.hpp"
#include "wavy_torus.hpp"

namespace {

using namespace tri;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Peer = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr int rounds = 5;

const Soup& input() {
  static const Soup soup = wavy_torus(500, 200);
  return soup;
}

double mean_length() {
  static const double mean = [] {
    double sum = 0;
    for (const Triangle& t : input().triangles)
      for (int k = 0; k < 3; ++k) sum += (input().points[t[k]] - input().points[t[(k + 1) % 3]]).norm();
    return sum / (3 * static_cast<double>(input().triangles.size()));
  }();
  return mean;
}

void judge(benchmark::State& state, const Soup& out, double length) {
  Context context;
  const MeshDistance d = mesh_distance(input(), out, {}, context);
  state.counters["rms"] = d.rms / length;
  state.counters["hausdorff"] = d.hausdorff / length;
  state.counters["crossing"] =
      static_cast<double>(self_intersections(out.points, out.triangles, context, Neighbors::judge).size());
  state.counters["check"] = static_cast<double>(out.triangles.size());
  double in_range = 0;
  std::vector<double> angles;
  for (const Triangle& t : out.triangles) {
    double least = std::numbers::pi;
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = out.points[t[(k + 1) % 3]] - out.points[t[k]], b = out.points[t[(k + 2) % 3]] - out.points[t[k]];
      in_range += a.norm() >= 0.8 * length && a.norm() <= length * 4 / 3;
      least = std::min(least, std::atan2((a % b).norm(), a | b));
    }
    angles.push_back(least * 180 / std::numbers::pi);
  }
  std::sort(angles.begin(), angles.end());
  state.counters["in_range"] = in_range / (3 * static_cast<double>(out.triangles.size()));
  state.counters["angle"] = angles.front();
  state.counters["angle_1%"] = angles[angles.size() / 100];
}

void ours(benchmark::State& state, double factor) {
  const double length = factor * mean_length();
  Soup out;
  for (auto _ : state) {
    state.PauseTiming();
    Context context;
    Mesh mesh = build_mesh(input(), context).mesh;
    state.ResumeTiming();
    remesh(view_of(mesh), {.length = length, .iterations = rounds}, context);
    state.PauseTiming();
    out = to_soup(view_of(mesh));
    state.ResumeTiming();
  }
  judge(state, out, length);
}

void peer(benchmark::State& state, double factor) {
  const double length = factor * mean_length();
  Soup out;
  for (auto _ : state) {
    state.PauseTiming();
    Peer mesh;
    std::vector<Peer::Vertex_index> at;
    for (const Vec3& p : input().points) at.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
    for (const Triangle& t : input().triangles) mesh.add_face(at[t[0]], at[t[1]], at[t[2]]);
    state.ResumeTiming();
    CGAL::Polygon_mesh_processing::isotropic_remeshing(
        faces(mesh), length, mesh, CGAL::Polygon_mesh_processing::parameters::number_of_iterations(rounds));
    state.PauseTiming();
    mesh.collect_garbage();
    out = Soup();
    for (const auto v : mesh.vertices()) {
      const auto& p = mesh.point(v);
      out.points.emplace_back(p.x(), p.y(), p.z());
    }
    for (const auto f : mesh.faces()) {
      Triangle t;
      int k = 0;
      for (const auto v : vertices_around_face(mesh.halfedge(f), mesh)) t[static_cast<std::size_t>(k++)] = v;
      out.triangles.push_back(t);
    }
    state.ResumeTiming();
  }
  judge(state, out, length);
}

BENCHMARK_CAPTURE(ours, finer, 0.7)->Name("remesh/200k_finer")->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(peer, finer, 0.7)
    ->Name("CGAL_isotropic_remeshing/200k_finer")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(ours, coarser, 2)
    ->Name("remesh/200k_coarser")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(peer, coarser, 2)
    ->Name("CGAL_isotropic_remeshing/200k_coarser")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace

BENCHMARK_MAIN();

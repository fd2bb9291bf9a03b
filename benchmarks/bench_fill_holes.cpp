// Filling one long curved hole; the peer is CGAL's triangulate_hole with its search over the 3-D Delaunay
// triangulation. The goal is its time at 2,000 edges and half of it at 10,000. Where the Delaunay triangulation holds
// no filling CGAL searches everything, or (ragged/2000) returns a filling that crosses itself. Beside the time stands
// what both reach by the same measures: `area`, `turn` (the largest dihedral angle, degrees, with the rim), `mean_turn`
// (weighted by length) and `crossings` (pairs of new triangles that meet in more than what they share).

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/operators/fill_holes.hpp"

namespace {

using namespace tri;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Peer = CGAL::Surface_mesh<Kernel::Point_3>;
constexpr double pi = std::numbers::pi;

/// A closed surface with one hole: around it two rows of triangles, closed far below by a fan.
struct Holed {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
};

/// The rim as a curve; the surface beyond it follows `fall`.
enum Shape { saddle, noisy, ragged, sphere };

Vec3 rim(Shape shape, double t, double out) {
  const double a = 2 * pi * t;
  if (shape == noisy) {  // a saddle measured with an error of half the spacing at 10,000 edges
    const double e = 3e-4 * std::sin(1e5 * t * t + out);
    return {(1 + out + e) * std::cos(a), (1 + out + e) * std::sin(a),
            0.4 * (1 + out) * std::sin(3 * a) + 3e-4 * std::sin(7e4 * t * t)};
  }
  if (shape == saddle) return {(1 + out) * std::cos(a), (1 + out) * std::sin(a), 0.4 * (1 + out) * std::sin(3 * a)};
  // On the unit sphere, at a polar angle that wavers.
  double polar = 0.6 + 0.15 * std::sin(5 * a) + out;
  if (shape == ragged) polar += 0.08 * std::sin(61 * a) + 0.03 * std::sin(223 * a + 1);
  return {std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar)};
}

Holed holed(Shape shape, int n) {
  Holed h;
  for (const double out : {0.0, 0.3}) {
    for (int i = 0; i < n; ++i) {
      // Uneven steps, as measured rims have them.
      const double t = (i + 0.3 * std::sin(12.9898 * i)) / n;
      h.points.push_back(rim(shape, t, out));
    }
  }
  h.points.push_back({0, 0, -3});
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    h.triangles.push_back({i, n + i, n + j});
    h.triangles.push_back({i, n + j, j});
    h.triangles.push_back({n + i, 2 * n, n + j});
  }
  return h;
}

/// What the triangles from `first` on are like.
void judge(benchmark::State& state, std::span<const Vec3> points, const std::vector<Triangle>& triangles,
           std::size_t first) {
  const auto normal = [&](const Triangle& t) { return (points[t[1]] - points[t[0]]) % (points[t[2]] - points[t[0]]); };
  double area = 0, turn = 0, sum = 0, length = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> beyond;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) beyond[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  for (std::size_t t = first; t < triangles.size(); ++t) {
    area += 0.5 * normal(triangles[t]).norm();
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      const auto other = beyond.find({b, a});
      if (other == beyond.end()) continue;
      const Vec3 n = normal(triangles[t]), m = normal(triangles[other->second]);
      const double angle = std::atan2((n % m).norm(), n | m) * 180 / pi, l = (points[a] - points[b]).norm();
      turn = std::max(turn, angle);
      sum += l * angle;
      length += l;
    }
  }
  std::size_t crossings = 0;
  for (const auto& [t, u] : self_intersections(points, triangles, Context(), Neighbors::judge)) crossings += u >= first;
  state.counters["area"] = area;
  state.counters["turn"] = turn;
  state.counters["mean_turn"] = sum / length;
  state.counters["crossings"] = static_cast<double>(crossings);
  state.counters["triangles"] = static_cast<double>(triangles.size() - first);
}

void ours(benchmark::State& state, Shape shape, HoleStrategy strategy) {
  const Holed h = holed(shape, static_cast<int>(state.range(0)));
  Mesh filled;
  for (auto _ : state) {
    state.PauseTiming();
    Mesh mesh;
    for (const Vec3& p : h.points) mesh.add_vertex(p);
    for (const auto& t : h.triangles) mesh.add_face(VertexHandle(t[0]), VertexHandle(t[1]), VertexHandle(t[2]));
    state.ResumeTiming();
    Context context;
    fill_holes(view_of(mesh), {.strategy = strategy, .max_edges = 1000000}, context);
    state.PauseTiming();
    filled = mesh;
    state.ResumeTiming();
  }
  std::vector<Triangle> triangles;
  for (const FaceHandle f : filled.faces()) {
    auto it = filled.cfv_ccwbegin(f);
    Triangle t;
    for (int k = 0; k < 3; ++k, ++it) t[k] = static_cast<std::uint32_t>((*it).idx());
    triangles.push_back(t);
  }
  judge(state, h.points, triangles, h.triangles.size());
}

void peer(benchmark::State& state, Shape shape) {
  const Holed h = holed(shape, static_cast<int>(state.range(0)));
  Peer filled;
  for (auto _ : state) {
    state.PauseTiming();
    Peer mesh;
    std::vector<Peer::Vertex_index> at;
    for (const Vec3& p : h.points) at.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
    for (const auto& t : h.triangles) mesh.add_face(at[t[0]], at[t[1]], at[t[2]]);
    const auto border = mesh.halfedge(at[1], at[0]);
    const auto start = mesh.is_border(border) ? border : mesh.opposite(border);
    state.ResumeTiming();
    std::vector<Peer::Face_index> faces;
    CGAL::Polygon_mesh_processing::triangulate_hole(
        mesh, start, std::back_inserter(faces),
        CGAL::Polygon_mesh_processing::parameters::use_delaunay_triangulation(true));
    state.PauseTiming();
    filled = mesh;
    state.ResumeTiming();
  }
  std::vector<Triangle> triangles;
  for (const auto f : filled.faces()) {
    Triangle t;
    int k = 0;
    for (const auto v : filled.vertices_around_face(filled.halfedge(f))) t[k++] = static_cast<std::uint32_t>(v.idx());
    triangles.push_back(t);
  }
  judge(state, h.points, triangles, h.triangles.size());
}

const std::array<std::pair<const char*, Shape>, 4> shapes{
    {{"saddle", saddle}, {"noisy", noisy}, {"ragged", ragged}, {"sphere", sphere}}};

const bool registered = [] {
  for (const auto& [name, shape] : shapes)
    for (const int n : {100, 500, 2000, 10000}) {
      const std::string end = std::string("/") + name;
      benchmark::RegisterBenchmark(("fill_holes" + end).c_str(), ours, shape, HoleStrategy::least_bending)
          ->Arg(n)
          ->Unit(benchmark::kMillisecond);
      benchmark::RegisterBenchmark(("fill_holes_nearest_diagonal" + end).c_str(), ours, shape,
                                   HoleStrategy::nearest_diagonal)
          ->Arg(n)
          ->Unit(benchmark::kMillisecond);
      benchmark::RegisterBenchmark(("CGAL_triangulate_hole" + end).c_str(), peer, shape)
          ->Arg(n)
          ->Unit(benchmark::kMillisecond);
    }
  return true;
}();

}  // namespace

BENCHMARK_MAIN();

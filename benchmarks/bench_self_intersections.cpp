// Self-intersections of 1M triangles: all pairs, exactly, neighbours included; the peer is CGAL's does_self_intersect,
// which stops at the first pair, so both run on a surface that has none. The goal is no more than its time. `check` is
// the number of pairs.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "meshops/crossings/self_intersections.hpp"

namespace {

using namespace tri;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Peer = CGAL::Surface_mesh<Kernel::Point_3>;

/// A wavy torus of 1000 x 500 quadrilaterals.
const Soup& torus() {
  static const Soup soup = [] {
    constexpr std::uint32_t n = 1000, m = 500;
    Soup s;
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t k = 0; k < m; ++k) {
        const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * k / m, r = 10 + std::sin(20 * a);
        s.points.emplace_back((30 + r * std::cos(b)) * std::cos(a), (30 + r * std::cos(b)) * std::sin(a),
                              r * std::sin(b));
      }
    }
    const auto at = [](std::uint32_t i, std::uint32_t k) { return i % n * m + k % m; };
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t k = 0; k < m; ++k) {
        s.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
        s.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
      }
    }
    return s;
  }();
  return soup;
}

void ours(benchmark::State& state, Neighbors neighbors) {
  std::size_t pairs = 0;
  for (auto _ : state) {
    const Context context;
    pairs = self_intersections(torus().points, torus().triangles, context, neighbors).size();
  }
  state.counters["check"] = static_cast<double>(pairs);
}
BENCHMARK_CAPTURE(ours, with_neighbours, Neighbors::judge)
    ->Name("self_intersections/1M")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(ours, without_neighbours, Neighbors::skip)
    ->Name("self_intersections/1M_without_neighbours")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

void peer(benchmark::State& state) {
  Peer mesh;
  std::vector<Peer::Vertex_index> at;
  for (const Vec3& p : torus().points) at.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
  for (const Triangle& t : torus().triangles) mesh.add_face(at[t[0]], at[t[1]], at[t[2]]);
  bool found = false;
  for (auto _ : state) found = CGAL::Polygon_mesh_processing::does_self_intersect(mesh);
  state.counters["check"] = found;
}
BENCHMARK(peer)->Name("CGAL_does_self_intersect/1M")->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace

BENCHMARK_MAIN();

// A binary STL file of 2M triangles to a welded half-edge mesh: read_mesh and build_mesh; the peer is ADMesh, which
// reads and repairs (exact neighbours, then all fixes it would do by default). The goal is at most 0.7 of its time.
// `check` is the number of triangles with three neighbours.

#include <admesh/stl.h>
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "io/mesh_file.hpp"
#include "meshops/build_mesh.hpp"

namespace {

using namespace tri;

/// A wavy torus of 1000 x 1000 quadrilaterals, written once.
const std::string& file_of_two_million() {
  static const std::string path = [] {
    constexpr std::uint32_t n = 1000;
    Soup soup;
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t k = 0; k < n; ++k) {
        const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * k / n, r = 10 + std::sin(20 * a);
        soup.points.emplace_back((30 + r * std::cos(b)) * std::cos(a), (30 + r * std::cos(b)) * std::sin(a),
                                 r * std::sin(b));
      }
    }
    const auto at = [](std::uint32_t i, std::uint32_t k) { return i % n * n + k % n; };
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t k = 0; k < n; ++k) {
        soup.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
        soup.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
      }
    }
    const std::string name = (std::filesystem::temp_directory_path() / "tri-bench-2m.stl").string();
    Context context;
    write_mesh(name, soup, {}, context);
    return name;
  }();
  return path;
}

void read_and_build(benchmark::State& state) {
  const std::string& path = file_of_two_million();
  std::size_t inner = 0;
  for (auto _ : state) {
    Context context;
    const BuiltMesh built = build_mesh(read_mesh(path, context), context);
    inner = built.mesh.n_edges() * 2 == built.mesh.n_faces() * 3 ? built.mesh.n_faces() : 0;
  }
  state.counters["check"] = static_cast<double>(inner);
}
BENCHMARK(read_and_build)->Name("read_stl/2M")->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void admesh_read_and_repair(benchmark::State& state) {
  const std::string& path = file_of_two_million();
  std::size_t inner = 0;
  for (auto _ : state) {
    stl_file stl;
    stl_open(&stl, const_cast<char*>(path.c_str()));
    stl_repair(&stl, 1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0);
    inner = static_cast<std::size_t>(stl.stats.connected_facets_3_edge);
    stl_close(&stl);
  }
  state.counters["check"] = static_cast<double>(inner);
}
BENCHMARK(admesh_read_and_repair)->Name("admesh/2M")->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace

BENCHMARK_MAIN();

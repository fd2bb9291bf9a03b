// The main job on the boot lid beside CGAL's advancing front, which knows no model. Names:
// triangulate/<points>/<method> and advancing-front/<points>. 200,000 points by default; another number comes from the
// environment, as in
//   TRI_BENCH_POINTS=1000000 bench_triangulate
// The counter `triangles` is the check value. Reading the points from a text file and writing the mesh are timed as
// well, as the program does both: read-points/<points>, write-mesh/<points>.
#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "io/mesh_file.hpp"
#include "io/points_file.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "libtri/triangulation/triangulate.hpp"
#include "meshops/to_soup.hpp"

namespace {

using namespace tri;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::string temporary_file(const char* extension) {
  const auto name = "bench_triangulate." + std::to_string(getpid()) + extension;
  return (std::filesystem::temp_directory_path() / name).string();
}

void run_tri(benchmark::State& state, const CadModel& model, const std::vector<Vec3>& points, Method method,
             int threads) {
  std::size_t triangles = 0;
  for (auto _ : state) {
    Context context;
    context.threads = threads;
    triangles = triangulate(model, points, {.method = method}, context).mesh.n_faces();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}

void run_cgal(benchmark::State& state, const std::vector<Vec3>& points) {
  std::vector<Kernel::Point_3> input;
  for (const Vec3& p : points) input.emplace_back(p[0], p[1], p[2]);
  std::size_t triangles = 0;
  for (auto _ : state) {
    std::vector<std::array<std::size_t, 3>> faces;
    CGAL::advancing_front_surface_reconstruction(input.begin(), input.end(), std::back_inserter(faces));
    triangles = faces.size();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}

void run_read(benchmark::State& state, const std::vector<Vec3>& points) {
  const std::string path = temporary_file(".xyz");
  Context context;
  write_points(path, {points, {}}, context);
  for (auto _ : state) benchmark::DoNotOptimize(read_points(path, context).points.size());
  std::filesystem::remove(path);
}

void run_write(benchmark::State& state, const CadModel& model, const std::vector<Vec3>& points) {
  const std::string path = temporary_file(".ply");
  Context context;
  const TriangulateResult result = triangulate(model, points, {}, context);
  Mesh mesh = result.mesh;
  for (auto _ : state) write_mesh(path, to_soup(view_of(mesh)), {}, context);
  std::filesystem::remove(path);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const char* const asked = std::getenv("TRI_BENCH_POINTS");
  const unsigned long long n = asked ? std::strtoull(asked, nullptr, 10) : 200000;
  if (n < 3) {
    std::fprintf(stderr, "TRI_BENCH_POINTS must be a number of points, 3 or more\n");
    return 2;
  }
  const Shape shape = example_part("boot-lid");
  const CadModel model = make_cad_model(shape);
  Context context;
  const std::vector<Vec3> points = measure(shape, {.points = n, .noise = 0.02}, context).points;

  const std::string size = "/" + std::to_string(n);
  const auto add = [](const std::string& name, auto run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
  };
  using State = benchmark::State;
  const std::string own = "triangulate" + size;
  add(own + "/auto/threads:all", [&](State& s) { run_tri(s, model, points, Method::automatic, 0); });
  add(own + "/auto/threads:1", [&](State& s) { run_tri(s, model, points, Method::automatic, 1); });
  add(own + "/shell/threads:all", [&](State& s) { run_tri(s, model, points, Method::shell, 0); });
  add("read-points" + size, [&](State& s) { run_read(s, points); });
  add("write-mesh" + size, [&](State& s) { run_write(s, model, points); });
  add("advancing-front" + size, [&](State& s) { run_cgal(s, points); });
  benchmark::RunSpecifiedBenchmarks();
}

// Decimation to a tenth; the peer is OpenMesh's own decimater with the same measure (quadrics), with and
// without its guard against flipped normals. The goals are no more than its time and no more than its errors: "rms" and
// "hausdorff" to the input, both sides, in units of the mean edge length of the input; "crossing" pairs of triangles
// that intersect; "check" is the number of faces.

#include <benchmark/benchmark.h>

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <cmath>
#include <numbers>

#include "meshops/build_mesh.hpp"
#include "meshops/checks/mesh_distance.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/operators/decimate.hpp"
#include "meshops/to_soup.hpp"
#include "wavy_torus.hpp"

namespace {

using namespace tri;

/// A part: a flat block of 60 x 60 x 20 with cylindrical pockets of radius 4, all edges sharp, as a height field of n x
/// n.
Soup block(std::uint32_t n) {
  Soup s;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double x = 60.0 * i / (n - 1), y = 60.0 * k / (n - 1);
      const double u = std::fmod(x, 12) - 6, v = std::fmod(y, 12) - 6, r = std::hypot(u, v);
      s.points.emplace_back(x, y, r < 4 ? 20 - std::min(5.0, (4 - r) * 4) : 20 + 0.5 * std::sin(x / 7));
    }
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t k = 0; k + 1 < n; ++k) {
      const std::uint32_t a = i * n + k;
      s.triangles.push_back({a, a + n, a + n + 1});
      s.triangles.push_back({a, a + n + 1, a + 1});
    }
  return s;
}

struct Input {
  Soup soup;
  Mesh mesh;
  double unit = 0;

  explicit Input(Soup s) : soup(std::move(s)) {
    Context context;
    mesh = build_mesh(soup, context).mesh;
    for (const Triangle& t : soup.triangles) unit += (soup.points[t[0]] - soup.points[t[1]]).norm();
    unit /= static_cast<double>(soup.triangles.size());
  }
};

const Input& input(int which) {
  static const Input inputs[]{Input(wavy_torus(1000, 500, 0.2)), Input(block(250))};
  return inputs[which];
}

void judge(benchmark::State& state, const Input& in, Mesh& mesh) {
  Context context;
  const Soup out = to_soup(view_of(mesh));
  const MeshDistance d = mesh_distance(in.soup, out, {}, context);
  state.counters["rms"] = d.rms / in.unit;
  state.counters["hausdorff"] = d.hausdorff / in.unit;
  state.counters["crossing"] =
      static_cast<double>(self_intersections(out.points, out.triangles, context, Neighbors::judge).size());
  state.counters["check"] = static_cast<double>(out.triangles.size());
}

void ours(benchmark::State& state, int which) {
  const Input& in = input(which);
  Mesh mesh;
  for (auto _ : state) {
    state.PauseTiming();
    mesh = in.mesh;
    state.ResumeTiming();
    Context context;
    decimate(view_of(mesh), {.ratio = 0.1}, context);
  }
  judge(state, in, mesh);
}

void peer(benchmark::State& state, int which, bool guarded) {
  const Input& in = input(which);
  Mesh mesh;
  for (auto _ : state) {
    state.PauseTiming();
    mesh = in.mesh;
    mesh.request_face_normals();
    state.ResumeTiming();
    mesh.update_face_normals();
    OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
    OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
    OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();
    if (guarded) {
      decimater.add(flipping);
      decimater.module(flipping).set_max_normal_deviation(75);
    }
    decimater.initialize();
    decimater.decimate_to_faces(0, mesh.n_faces() / 10);
  }
  mesh.release_face_normals();
  judge(state, in, mesh);
}

BENCHMARK_CAPTURE(ours, torus, 0)
    ->Name("decimate/torus_1M_to_10%")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(peer, torus, 0, false)
    ->Name("OpenMesh_quadric/torus_1M_to_10%")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(peer, torus_guarded, 0, true)
    ->Name("OpenMesh_quadric_and_flipping/torus_1M_to_10%")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(ours, block, 1)
    ->Name("decimate/block_124k_to_10%")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(peer, block_guarded, 1, true)
    ->Name("OpenMesh_quadric_and_flipping/block_124k_to_10%")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace

BENCHMARK_MAIN();

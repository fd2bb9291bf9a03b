// Half-edge build of 1M vertices and 2M triangles: build_mesh with all its checks, and OpenMesh's own add_face as the
// peer. The goal is at most 0.4 of add_face's time on ordered and 0.25 on shuffled triangles. `check` is the number of
// edges.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "meshops/build_mesh.hpp"

namespace {

using namespace tri;

constexpr std::uint32_t side = 1000;

const Soup& grid(bool shuffled) {
  static const auto make = [](bool shuffle) {
    Soup soup;
    soup.points.reserve(side * side);
    for (std::uint32_t y = 0; y < side; ++y)
      for (std::uint32_t x = 0; x < side; ++x) soup.points.emplace_back(x, y, std::sin(0.01 * x) * std::cos(0.01 * y));
    for (std::uint32_t y = 0; y + 1 < side; ++y) {
      for (std::uint32_t x = 0; x + 1 < side; ++x) {
        const std::uint32_t a = y * side + x, b = a + 1, c = b + side, d = a + side;
        soup.triangles.push_back({a, b, c});
        soup.triangles.push_back({a, c, d});
      }
    }
    if (shuffle) std::shuffle(soup.triangles.begin(), soup.triangles.end(), std::mt19937(1));
    return soup;
  };
  static const Soup ordered = make(false), mixed = make(true);
  return shuffled ? mixed : ordered;
}

std::vector<std::array<std::int32_t, 3>> neighbors_of(const Soup& soup) {
  Context context;
  BuiltMesh built = build_mesh(soup, context);
  std::vector<std::array<std::int32_t, 3>> neighbors(soup.triangles.size());
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    HalfedgeHandle h = built.mesh.halfedge_handle(FaceHandle(static_cast<int>(i)));
    for (int k = 0; k < 3; ++k, h = built.mesh.next_halfedge_handle(h))
      neighbors[i][(k + 2) % 3] = built.mesh.opposite_face_handle(h).idx();
  }
  return neighbors;
}

void build_mesh_bulk(benchmark::State& state, bool shuffled) {
  const Soup& soup = grid(shuffled);
  std::size_t edges = 0;
  for (auto _ : state) {
    Context context;
    const BuiltMesh built = build_mesh(soup, context);
    edges = built.mesh.n_edges();
  }
  state.counters["check"] = static_cast<double>(edges);
}

void build_mesh_one_thread(benchmark::State& state, bool shuffled) {
  const Soup& soup = grid(shuffled);
  std::size_t edges = 0;
  for (auto _ : state) {
    Context context;
    context.threads = 1;
    const BuiltMesh built = build_mesh(soup, context);
    edges = built.mesh.n_edges();
  }
  state.counters["check"] = static_cast<double>(edges);
}

void build_mesh_known_neighbors(benchmark::State& state, bool shuffled) {
  const Soup& soup = grid(shuffled);
  const auto neighbors = neighbors_of(soup);
  std::size_t edges = 0;
  for (auto _ : state) {
    Context context;
    const BuiltMesh built = build_mesh(soup.points, soup.triangles, neighbors, context);
    edges = built.mesh.n_edges();
  }
  state.counters["check"] = static_cast<double>(edges);
}

template <class Kernel>
void add_face(benchmark::State& state, bool shuffled) {
  const Soup& soup = grid(shuffled);
  std::size_t edges = 0;
  for (auto _ : state) {
    Kernel mesh;
    mesh.reserve(soup.points.size(), soup.points.size() + soup.triangles.size(), soup.triangles.size());
    for (const Vec3& p : soup.points) mesh.add_vertex(p);
    for (const Triangle& t : soup.triangles)
      mesh.add_face(VertexHandle(static_cast<int>(t[0])), VertexHandle(static_cast<int>(t[1])),
                    VertexHandle(static_cast<int>(t[2])));
    edges = mesh.n_edges();
  }
  state.counters["check"] = static_cast<double>(edges);
}

struct BareTraits : OpenMesh::DefaultTraits {
  using Point = Vec3;
  using Normal = Vec3;
};
using BareMesh = OpenMesh::TriMesh_ArrayKernelT<BareTraits>;

#define BOTH_ORDERS(function)                 \
  BENCHMARK_CAPTURE(function, ordered, false) \
      ->Name(#function "/ordered/1M")         \
      ->Unit(benchmark::kMillisecond)         \
      ->MeasureProcessCPUTime()               \
      ->UseRealTime();                        \
  BENCHMARK_CAPTURE(function, shuffled, true) \
      ->Name(#function "/shuffled/1M")        \
      ->Unit(benchmark::kMillisecond)         \
      ->MeasureProcessCPUTime()               \
      ->UseRealTime()

void add_face_without_status(benchmark::State& state, bool shuffled) {
  add_face<BareMesh>(state, shuffled);
}
void add_face_same_mesh_type(benchmark::State& state, bool shuffled) {
  add_face<Mesh>(state, shuffled);
}

BOTH_ORDERS(build_mesh_bulk);
BOTH_ORDERS(build_mesh_one_thread);
BOTH_ORDERS(build_mesh_known_neighbors);
BOTH_ORDERS(add_face_without_status);
BOTH_ORDERS(add_face_same_mesh_type);

}  // namespace

BENCHMARK_MAIN();

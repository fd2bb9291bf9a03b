// Smoothing, flipping and subdividing a torus of 100k, 1M and 2M triangles (before subdivision: a quarter), on one
// thread like the peers: OpenMesh's JacobiLaplaceSmoother for `smooth` by laplace, CGAL's smooth_shape for one
// cotangent step (of the same time), CGAL's Delaunay flipper (the one inside of its angle_and_area_smoothing),
// OpenMesh's Loop. The time of each is to be linear: `per_face`. `check` is the mean distance that vertices moved,
// the number of edges left that are not Delaunay, the curvature left, or the number of faces.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/angle_and_area_smoothing.h>
#include <CGAL/Polygon_mesh_processing/smooth_shape.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Smoother/JacobiLaplaceSmootherT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "meshops/build_mesh.hpp"
#include "meshops/operators/flip_diagonals.hpp"
#include "meshops/operators/smooth.hpp"
#include "meshops/operators/subdivide.hpp"

namespace {

using namespace tri;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Peer = CGAL::Surface_mesh<Kernel::Point_3>;
namespace PMP = CGAL::Polygon_mesh_processing;

/// About so many triangles; vertices off their even places by up to a quarter of the spacing, and by noise of 0.05 of
/// it.
const Soup& torus(std::int64_t faces) {
  static std::map<std::int64_t, Soup> made;
  Soup& s = made[faces];
  if (!s.points.empty()) return s;
  const auto m = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(faces) / 6)), n = 3 * m;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.25, 0.25);
  std::normal_distribution<double> noise(0, 0.05 * 2 * std::numbers::pi / m);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t k = 0; k < m; ++k) {
      const double a = 2 * std::numbers::pi * (i + jitter(random)) / n,
                   b = 2 * std::numbers::pi * (k + jitter(random)) / m;
      const double r = 1 + noise(random);
      s.points.emplace_back((3 + r * std::cos(b)) * std::cos(a), (3 + r * std::cos(b)) * std::sin(a), r * std::sin(b));
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return i % n * m + k % m; };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t k = 0; k < m; ++k) {
      s.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      s.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return s;
}

Peer peer_mesh(const Soup& soup) {
  Peer mesh;
  std::vector<Peer::Vertex_index> at;
  for (const Vec3& p : soup.points) at.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
  for (const Triangle& t : soup.triangles) mesh.add_face(at[t[0]], at[t[1]], at[t[2]]);
  return mesh;
}

/// Runs `work(mesh)` on a fresh copy each time; its result is the check value.
template <class M, class Work>
void measure(benchmark::State& state, const M& start, std::size_t faces, const Work& work) {
  double check = 0;
  for (auto _ : state) {
    state.PauseTiming();
    M mesh = start;
    state.ResumeTiming();
    check = work(mesh);
    state.PauseTiming();
    mesh = M();
    state.ResumeTiming();
  }
  state.counters["check"] = check;
  state.counters["per_face"] = benchmark::Counter(
      static_cast<double>(faces), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class Work>
void ours(benchmark::State& state, const Work& work) {
  Context context;
  context.threads = 1;
  const Soup& soup = torus(state.range(0));
  const BuiltMesh built = build_mesh(soup, context);
  measure(state, built.mesh, soup.triangles.size(), [&](Mesh& mesh) { return work(mesh, context); });
}

void smooth_by(benchmark::State& state, SmoothMethod method, int iterations) {
  ours(state, [&](Mesh& mesh, Context& context) {
    const SmoothOptions options{.method = method, .iterations = iterations, .feature_angle = std::numbers::pi};
    return smooth(view_of(mesh), options, context).figures.at("mean distance");
  });
}

void flip_by(benchmark::State& state, FlipRule rule, const char* check) {
  ours(state, [&](Mesh& mesh, Context& context) {
    return flip_diagonals(view_of(mesh), {.criterion = rule}, context).figures.at(check);
  });
}

void subdivide_by(benchmark::State& state, SubdivisionScheme scheme, SubdivisionGuard guard = SubdivisionGuard::folds) {
  ours(state, [&](Mesh& mesh, Context& context) {
    subdivide(view_of(mesh), {.scheme = scheme, .guard = guard, .feature_angle = std::numbers::pi}, context);
    return static_cast<double>(mesh.n_faces());
  });
}

double mean_distance(const Soup& soup, const auto& point) {
  double sum = 0;
  for (std::size_t i = 0; i < soup.points.size(); ++i) sum += (soup.points[i] - point(i)).norm();
  return sum / static_cast<double>(soup.points.size());
}

void openmesh_laplace(benchmark::State& state) {
  const Soup& soup = torus(state.range(0));
  Context context;
  const BuiltMesh built = build_mesh(soup, context);
  measure(state, built.mesh, soup.triangles.size(), [&](Mesh& mesh) {
    mesh.request_vertex_normals();
    mesh.request_face_normals();
    mesh.update_normals();
    OpenMesh::Smoother::JacobiLaplaceSmootherT<Mesh> smoother(mesh);
    smoother.initialize(OpenMesh::Smoother::SmootherT<Mesh>::Tangential_and_Normal,
                        OpenMesh::Smoother::SmootherT<Mesh>::C0);
    smoother.smooth(10);
    return mean_distance(soup, [&](std::size_t i) { return mesh.point(VertexHandle(static_cast<int>(i))); });
  });
}

void cgal_smooth_shape(benchmark::State& state) {
  const Soup& soup = torus(state.range(0));
  measure(state, peer_mesh(soup), soup.triangles.size(), [&](Peer& mesh) {
    double length = 0;
    for (const auto e : mesh.edges())
      length += std::sqrt(CGAL::squared_distance(mesh.point(mesh.vertex(e, 0)), mesh.point(mesh.vertex(e, 1))));
    length /= static_cast<double>(mesh.number_of_edges());
    PMP::smooth_shape(mesh, length * length / 8, CGAL::parameters::number_of_iterations(1));
    return mean_distance(soup, [&](std::size_t i) {
      const auto& p = mesh.point(Peer::Vertex_index(static_cast<Peer::size_type>(i)));
      return Vec3(p.x(), p.y(), p.z());
    });
  });
}

void cgal_delaunay_flips(benchmark::State& state) {
  const Soup& soup = torus(state.range(0));
  measure(state, peer_mesh(soup), soup.triangles.size(), [&](Peer& mesh) {
    using Points = Peer::Property_map<Peer::Vertex_index, Kernel::Point_3>;
    using Constraints = CGAL::Static_boolean_property_map<Peer::Edge_index, false>;
    PMP::internal::Delaunay_edge_flipper<Peer, Points, Constraints, Kernel> flipper(mesh, mesh.points(), Constraints(),
                                                                                    Kernel());
    flipper(mesh.faces());
    std::size_t left = 0;
    for (const auto e : mesh.edges()) left += flipper.should_be_flipped(e);
    return static_cast<double>(left);
  });
}

void openmesh_loop(benchmark::State& state) {
  const Soup& soup = torus(state.range(0));
  Context context;
  const BuiltMesh built = build_mesh(soup, context);
  measure(state, built.mesh, soup.triangles.size(), [](Mesh& mesh) {
    OpenMesh::Subdivider::Uniform::LoopT<Mesh> loop;
    loop.attach(mesh);
    loop(1);
    loop.detach();
    return static_cast<double>(mesh.n_faces());
  });
}

#define TRI_SIZES(...) \
  BENCHMARK_CAPTURE(__VA_ARGS__)->Arg(100'000)->Arg(1'000'000)->Arg(2'000'000)->Unit(benchmark::kMillisecond)
#define TRI_PEER_SIZES(...) \
  BENCHMARK(__VA_ARGS__)->Arg(100'000)->Arg(1'000'000)->Arg(2'000'000)->Unit(benchmark::kMillisecond)

TRI_SIZES(smooth_by, laplace_10, SmoothMethod::laplace, 10);
TRI_PEER_SIZES(openmesh_laplace);
TRI_SIZES(smooth_by, taubin_10, SmoothMethod::taubin, 10);
TRI_SIZES(smooth_by, cotangent_1, SmoothMethod::cotangent, 1);
BENCHMARK(cgal_smooth_shape)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
TRI_SIZES(flip_by, delaunay, FlipRule::delaunay, "edges not Delaunay after");
TRI_PEER_SIZES(cgal_delaunay_flips);
TRI_SIZES(flip_by, smooth_shape, FlipRule::smooth_shape, "sharp edges after");
TRI_SIZES(flip_by, curvature, FlipRule::curvature, "total absolute mean curvature after");
BENCHMARK_CAPTURE(subdivide_by, loop, SubdivisionScheme::loop)
    ->Arg(25'000)
    ->Arg(250'000)
    ->Arg(500'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(subdivide_by, loop_unguarded, SubdivisionScheme::loop, SubdivisionGuard::none)
    ->Arg(25'000)
    ->Arg(250'000)
    ->Arg(500'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(subdivide_by, loop_crossings, SubdivisionScheme::loop, SubdivisionGuard::crossings)
    ->Arg(25'000)
    ->Arg(250'000)
    ->Arg(500'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(openmesh_loop)->Arg(25'000)->Arg(250'000)->Arg(500'000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(subdivide_by, midpoint, SubdivisionScheme::midpoint)
    ->Arg(25'000)
    ->Arg(250'000)
    ->Arg(500'000)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();

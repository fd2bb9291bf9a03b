// Closest points on a trimmed model beside OpenCASCADE's projections. Names: registration/<input>/<points>/<threads>,
// and <peer>/<points>. The counter mean_distance is the check value; per_point is seconds.
#include <benchmark/benchmark.h>

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <random>

#include "libtri/example_parts.hpp"
#include "libtri/registration.hpp"
#include "libtri/shape_occt.hpp"
#include "libtri/trim_region.hpp"

namespace {

using namespace tri;

const CadModel& lid() {
  static const CadModel model = make_cad_model(example_part("boot-lid"));
  return model;
}

// The lid's face with the largest area, as a model of its own: what the peers project on.
const CadModel& panel() {
  static const CadModel model = [] {
    const CadModel& all = lid();
    const auto largest = std::max_element(all.faces.begin(), all.faces.end(),
                                          [](const auto& a, const auto& b) { return a.area < b.area; });
    TopExp_Explorer it(occt(all.shape), TopAbs_FACE);
    for (int k = 1; k < largest->shape_face; ++k) it.Next();
    return make_cad_model(make_shape(it.Current()));
  }();
  return model;
}

// Random places on the faces by area, with 0.02 mm of noise along the normal.
std::vector<Vec3> measured(const CadModel& model, std::size_t n) {
  std::mt19937_64 random(20002);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise(0, 0.02);
  std::vector<double> area;
  std::vector<TrimRegion> regions;
  for (const CadFace& face : model.faces) {
    area.push_back((area.empty() ? 0 : area.back()) + face.area);
    regions.emplace_back(face);
  }
  std::vector<Vec3> points;
  while (points.size() < n) {
    const auto at = std::lower_bound(area.begin(), area.end(), share(random) * area.back());
    const std::size_t f = std::min<std::size_t>(at - area.begin(), area.size() - 1);
    const TrimRegion& r = regions[f];
    double u, v;
    do {
      u = r.u_min() + share(random) * (r.u_max() - r.u_min());
      v = r.v_min() + share(random) * (r.v_max() - r.v_min());
    } while (!r.contains(u, v));
    const SurfacePoint s = model.faces[f].surface->evaluate(u, v);
    points.push_back(s.p + (s.du % s.dv).normalized() * noise(random));
  }
  return points;
}

void report(benchmark::State& state, double distance, std::size_t n) {
  state.counters["mean_distance"] = distance / static_cast<double>(n);
  state.counters["per_point"] = benchmark::Counter(
      static_cast<double>(n), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void registration(benchmark::State& state, const CadModel& model, bool sorted, int threads) {
  const auto n = static_cast<std::size_t>(state.range(0));
  std::vector<Vec3> points = measured(model, n);
  if (sorted)  // lines 1 mm apart
    std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) {
      const double x = std::floor(a[0]), y = std::floor(b[0]);
      return x < y || (x == y && a[1] < b[1]);
    });
  const Registration model_registration(model);
  Context context;
  context.threads = threads;
  double distance = 0;
  for (auto _ : state) {
    const auto feet = model_registration.register_points(points, context);
    distance = 0;
    for (const Foot& foot : feet) distance += std::abs(foot.deviation);
  }
  report(state, distance, n);
}

void build(benchmark::State& state) {
  const CadModel& model = lid();
  for (auto _ : state) benchmark::DoNotOptimize(Registration(model));
}

void project(benchmark::State& state, Extrema_ExtAlgo algorithm) {
  const CadModel& model = panel();
  const auto n = static_cast<std::size_t>(state.range(0));
  const std::vector<Vec3> points = measured(model, n);
  const Handle(Geom_Surface) surface =
      BRep_Tool::Surface(TopoDS::Face(TopExp_Explorer(occt(model.shape), TopAbs_FACE).Current()));
  const CadFace& face = model.faces[0];
  double distance = 0;
  for (auto _ : state) {
    GeomAPI_ProjectPointOnSurf projection;
    projection.Init(surface, face.u_min, face.u_max, face.v_min, face.v_max, 1e-9, algorithm);
    distance = 0;
    for (const Vec3& p : points) {
      projection.Perform(gp_Pnt(p[0], p[1], p[2]));
      if (projection.NbPoints() > 0) distance += projection.LowerDistance();
    }
  }
  report(state, distance, n);
}

void vertex_to_shape(benchmark::State& state) {
  const CadModel& model = panel();
  const auto n = static_cast<std::size_t>(state.range(0));
  const std::vector<Vec3> points = measured(model, n);
  double distance = 0;
  for (auto _ : state) {
    distance = 0;
    for (const Vec3& p : points)
      distance +=
          BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(gp_Pnt(p[0], p[1], p[2])).Vertex(), occt(model.shape))
              .Value();
  }
  report(state, distance, n);
}

}  // namespace

// clang-format off
BENCHMARK_CAPTURE(registration, lid_random_1_thread, lid(), false, 1)->Arg(1000000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(registration, lid_random_2_threads, lid(), false, 2)->Arg(1000000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(registration, lid_scan_1_thread, lid(), true, 1)->Arg(1000000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(build)->Name("registration/build_lid")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(registration, panel, panel(), false, 1)->Arg(100)->Arg(1000)->Arg(100000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(project, GeomAPI_ProjectPointOnSurf, Extrema_ExtAlgo_Grad)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(project, GeomAPI_ProjectPointOnSurf_tree, Extrema_ExtAlgo_Tree)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(vertex_to_shape)->Name("BRepExtrema_DistShapeShape")->Arg(100)->Unit(benchmark::kMillisecond);
// clang-format on

BENCHMARK_MAIN();

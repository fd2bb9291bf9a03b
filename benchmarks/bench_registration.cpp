// Closest points on a trimmed model beside OpenCASCADE's projections. Names: registration/<input>/<threads>/<points>,
// and <peer>/<input>/<points>. The counter mean_distance is the check value; per_point is seconds. The hinge is
// measured when the environment variable TRI_DATA names the folder of real files.
#include <benchmark/benchmark.h>

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>

#include "io/cad/cad_file.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/model/trim_region.hpp"
#include "libtri/registration.hpp"

namespace {

using namespace tri;

const CadModel& lid() {
  static const CadModel model = make_cad_model(example_part("boot-lid"));
  return model;
}

// An assembly of 276 faces, most of them planes, cylinders and tori; null unless TRI_DATA names the folder that holds
// it.
const CadModel* hinge() {
  static const std::unique_ptr<const CadModel> model = [] {
    const char* folder = std::getenv("TRI_DATA");
    const std::string path = folder ? std::string(folder) + "/cad/13_5_hinge_R_assy.stp" : "";
    Context context;
    return folder && std::filesystem::exists(path)
               ? std::make_unique<const CadModel>(make_cad_model(read_cad(path, context).shape))
               : nullptr;
  }();
  return model.get();
}

struct Measured {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> faces;  // position of the face that each was made on
};

// Random places on the faces by area, with 0.02 mm of noise along the normal.
Measured measured(const CadModel& model, std::size_t n) {
  std::mt19937_64 random(20002);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise(0, 0.02);
  std::vector<double> area;
  std::vector<TrimRegion> regions;
  for (const CadFace& face : model.faces) {
    area.push_back((area.empty() ? 0 : area.back()) + face.area);
    regions.emplace_back(face);
  }
  Measured out;
  while (out.points.size() < n) {
    const auto at = std::lower_bound(area.begin(), area.end(), share(random) * area.back());
    const std::size_t f = std::min<std::size_t>(at - area.begin(), area.size() - 1);
    const TrimRegion& r = regions[f];
    double u, v;
    do {
      u = r.u_min() + share(random) * (r.u_max() - r.u_min());
      v = r.v_min() + share(random) * (r.v_max() - r.v_min());
    } while (!r.contains(u, v));
    const SurfacePoint s = model.faces[f].surface->evaluate(u, v);
    out.points.push_back(s.p + (s.du % s.dv).normalized() * noise(random));
    out.faces.push_back(static_cast<std::uint32_t>(f));
  }
  return out;
}

void report(benchmark::State& state, double distance, std::size_t n) {
  state.counters["mean_distance"] = distance / static_cast<double>(n);
  state.counters["per_point"] = benchmark::Counter(
      static_cast<double>(n), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void registration(benchmark::State& state, const CadModel& model, bool sorted, int threads) {
  const auto n = static_cast<std::size_t>(state.range(0));
  std::vector<Vec3> points = measured(model, n).points;
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

// The peer is handed the face that each point was made on, and knows nothing of trimming. One projection is initialised
// once for each face that has a point; that is inside the measured time, as our seeding is.
// @param nurbs  projects on the faces as NURBS instead: OpenCASCADE has closed forms for planes, cylinders and so on
void project(benchmark::State& state, const CadModel& model, Extrema_ExtAlgo algorithm, bool nurbs) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const Measured sample = measured(model, n);
  TopTools_IndexedMapOfShape shapes;
  BRepBuilderAPI_NurbsConvert convert;
  if (nurbs) convert.Perform(occt(model.shape));
  TopExp::MapShapes(nurbs ? convert.Shape() : occt(model.shape), TopAbs_FACE, shapes);
  std::vector<std::vector<gp_Pnt>> of_face(model.faces.size());
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = sample.points[i];
    of_face[sample.faces[i]].emplace_back(p[0], p[1], p[2]);
  }
  double distance = 0;
  for (auto _ : state) {
    distance = 0;
    for (std::size_t f = 0; f < of_face.size(); ++f) {
      if (of_face[f].empty()) continue;
      const CadFace& face = model.faces[f];
      GeomAPI_ProjectPointOnSurf projection;
      const Handle(Geom_Surface) surface = BRep_Tool::Surface(TopoDS::Face(shapes(face.shape_face)));
      double u0 = face.u_min, u1 = face.u_max, v0 = face.v_min, v1 = face.v_max;
      if (nurbs) surface->Bounds(u0, u1, v0, v1);
      projection.Init(surface, u0, u1, v0, v1, 1e-9, algorithm);
      for (const gp_Pnt& p : of_face[f]) {
        projection.Perform(p);
        if (projection.NbPoints() > 0) distance += projection.LowerDistance();
      }
    }
  }
  report(state, distance, n);
}

void vertex_to_shape(benchmark::State& state) {
  const CadModel& model = lid();
  const auto n = static_cast<std::size_t>(state.range(0));
  const std::vector<Vec3> points = measured(model, n).points;
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

void add_benchmarks(const std::string& name, const CadModel& model) {
  using benchmark::RegisterBenchmark;
  for (const int threads : {1, 2})
    RegisterBenchmark(("registration/" + name + "_random/threads:" + std::to_string(threads)).c_str(),
                      [&model, threads](benchmark::State& state) { registration(state, model, false, threads); })
        ->Arg(1000000)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  RegisterBenchmark(("registration/" + name + "_scan/threads:1").c_str(),
                    [&model](benchmark::State& state) { registration(state, model, true, 1); })
      ->Arg(1000000)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  RegisterBenchmark(("registration/" + name + "_build").c_str(), [&model](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(Registration(model));
  })->Unit(benchmark::kMillisecond);
  for (const bool tree : {false, true})
    for (const bool nurbs : {false, true})
      RegisterBenchmark(
          ("GeomAPI_ProjectPointOnSurf" + std::string(tree ? "_tree" : "") + (nurbs ? "_nurbs" : "") + "/" + name)
              .c_str(),
          [&model, tree, nurbs](benchmark::State& state) {
            project(state, model, tree ? Extrema_ExtAlgo_Tree : Extrema_ExtAlgo_Grad, nurbs);
          })
          ->Arg(2000)
          ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  add_benchmarks("lid", lid());
  if (hinge()) add_benchmarks("hinge", *hinge());
  benchmark::RegisterBenchmark("BRepExtrema_DistShapeShape/lid", vertex_to_shape)
      ->Arg(100)
      ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}

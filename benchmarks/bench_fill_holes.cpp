// Filling one long curved hole, by the operator with its defaults, as `tri run ! fill-holes` does; the peer is CGAL's
// triangulate_hole with its search over the 3-D Delaunay triangulation, on the same mesh. The goal is its time at 2,000
// edges and half of it at 10,000. They do not do the same: the operator also looks at the whole mesh for its loops and
// islands, goes round the rest of the mesh and itself, and tells where it cannot; CGAL is told where the hole is and
// returns fillings with crossings. Where the Delaunay triangulation holds no filling CGAL searches everything, or
// (ragged/2000) falls back on a filling that crosses itself. Beside the time stands what both reach by the same
// measures: `area`, `turn` (the largest dihedral angle, degrees, with the rim), `mean_turn` (weighted by length) and
// `crossings` (pairs of triangles, one of them new, that meet in more than what they share); `rim_crossings` are those
// of the mesh as it was given.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/operators/fill_holes.hpp"

namespace {

using namespace tri;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Peer = CGAL::Surface_mesh<Kernel::Point_3>;
constexpr double pi = std::numbers::pi;

/// A closed surface with one hole.
struct Holed {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
};

/// The rim as a curve; the surface goes on from it by `out`.
enum Curve { saddle, ragged, sphere };

struct Shape {
  const char* name;
  Curve curve;
  double noise = 0;      ///< of every vertex, by the spacing of vertices around it
  bool needles = false;  ///< two rows of long triangles instead of well-shaped ones
};

Vec3 surface_at(Curve curve, double t, double out) {
  const double a = 2 * pi * t;
  if (curve == saddle) return {(1 + out) * std::cos(a), (1 + out) * std::sin(a), 0.4 * (1 + out) * std::sin(3 * a)};
  // On the unit sphere, at a polar angle that wavers; what is ragged fades away from the rim.
  double polar = 0.6 + 0.15 * std::sin(5 * a) + out;
  if (curve == ragged) polar += std::max(0.0, 1 - out / 0.3) * (0.08 * std::sin(61 * a) + 0.03 * std::sin(223 * a + 1));
  return {std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar)};
}

/// Rows of vertices around the hole, each pair of rows of half as many as the pair before and twice as far apart, and
/// strips of triangles between them; a vertex far below closes the last.
Holed holed(const Shape& shape, int n) {
  Holed h;
  std::mt19937 random(1);
  const auto noise = [&](double spacing) {
    const auto one = [&] { return shape.noise * spacing * (2 * (static_cast<double>(random()) / 4294967295.0) - 1); };
    const double x = one(), y = one(), z = one();
    return Vec3(x, y, z);
  };
  const double length = 2 * pi * (shape.curve == saddle ? 1.3 : 0.6);
  std::vector<double> row;  // uneven steps, as measured rims have them
  for (int i = 0; i < n; ++i) row.push_back((i + 0.3 * std::sin(12.9898 * i)) / n);
  double out = 0;
  int start = -1;                // of the row before
  std::vector<double> previous;  // that row
  for (int k = 0; row.size() >= 10 && !(shape.needles && k == 2); ++k) {
    const double spacing = length / static_cast<double>(row.size());
    if (k > 0) out += shape.needles ? 0.3 : spacing;
    const int now = static_cast<int>(h.points.size());
    for (const double t : row) h.points.push_back(surface_at(shape.curve, t, out) + noise(spacing));
    for (std::size_t i = 0, j = 0; k > 0 && i + j < previous.size() + row.size();) {
      const auto p = static_cast<int>(previous.size()), r = static_cast<int>(row.size());
      const auto a = static_cast<int>(i), b = static_cast<int>(j);
      const double next_p = a + 1 < p ? previous[a + 1] : 1 + previous[0], next_r = b + 1 < r ? row[b + 1] : 1 + row[0];
      const bool inner = b == r || (a < p && next_p <= next_r);
      if (inner)
        h.triangles.push_back({start + a % p, now + b % r, start + (a + 1) % p}), ++i;
      else
        h.triangles.push_back({start + a % p, now + b % r, now + (b + 1) % r}), ++j;
    }
    start = now;
    previous = row;
    if (k % 2 == 0) continue;
    row.clear();
    for (std::size_t i = 0; i < previous.size(); i += 2) row.push_back(previous[i]);
  }
  const auto last = static_cast<int>(previous.size()), below = static_cast<int>(h.points.size());
  h.points.push_back(shape.curve == saddle ? Vec3(0, 0, -3) : Vec3(0, 0, -1));
  for (int i = 0; i < last; ++i) h.triangles.push_back({start + i, below, start + (i + 1) % last});
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
  std::size_t crossings = 0, before = 0;
  for (const auto& [t, u] : self_intersections(points, triangles, Context(), Neighbors::judge))
    u >= first ? ++crossings : ++before;
  state.counters["area"] = area;
  state.counters["turn"] = turn;
  state.counters["mean_turn"] = sum / length;
  state.counters["crossings"] = static_cast<double>(crossings);
  state.counters["rim_crossings"] = static_cast<double>(before);
  state.counters["triangles"] = static_cast<double>(triangles.size() - first);
}

void ours(benchmark::State& state, const Shape& shape, const FillHolesOptions& options) {
  const Holed h = holed(shape, static_cast<int>(state.range(0)));
  Mesh filled;
  for (auto _ : state) {
    state.PauseTiming();
    Mesh mesh;
    for (const Vec3& p : h.points) mesh.add_vertex(p);
    for (const auto& t : h.triangles) mesh.add_face(VertexHandle(t[0]), VertexHandle(t[1]), VertexHandle(t[2]));
    state.ResumeTiming();
    Context context;
    fill_holes(view_of(mesh), options, context);
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

void peer(benchmark::State& state, const Shape& shape) {
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

constexpr Shape shapes[] = {
    {"saddle", saddle},           {"ragged", ragged, 0, true},
    {"sphere", sphere},           {"noisy", saddle, 0.15},  // a saddle measured with noise
    {"rough", saddle, 0.5},                                 // so much of it that the faces at the rim cross each other
    {"needles", saddle, 0, true},
};

const bool registered = [] {
  for (const Shape& shape : shapes)
    for (const int n : {100, 500, 2000, 10000}) {
      const std::string end = std::string("/") + shape.name;
      const auto add = [&](const char* name, auto run, auto... options) {
        benchmark::RegisterBenchmark((name + end).c_str(), run, shape, options...)
            ->Arg(n)
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime();
      };
      add("fill_holes", ours, FillHolesOptions{});
      add("fill_holes_nearest_diagonal", ours, FillHolesOptions{.strategy = HoleStrategy::nearest_diagonal});
      add("CGAL_triangulate_hole", peer);
    }
  return true;
}();

}  // namespace

BENCHMARK_MAIN();

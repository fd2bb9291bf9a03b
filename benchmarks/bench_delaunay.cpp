// 2D Delaunay triangulation beside CGAL's. Names: delaunay/<input>/<points>, with the peer and one thread said.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "libtri/triangulation/delaunay.hpp"

namespace {

using tri::Vec2;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Points = std::vector<Vec2>;

std::mt19937_64 generator() {
  return std::mt19937_64(20001);
}

Points uniform(std::size_t n) {
  auto random = generator();
  std::uniform_real_distribution<double> unit(0, 1);
  Points points(n);
  for (auto& p : points) p = {unit(random), unit(random)};
  return points;
}

// Along a line the points lie twenty times closer than the lines.
Points scan_lines(std::size_t n) {
  auto random = generator();
  std::uniform_real_distribution<double> unit(0, 1);
  const double lines = std::ceil(std::sqrt(static_cast<double>(n) / 20));
  const double per_line = std::ceil(static_cast<double>(n) / lines);
  Points points;
  for (double line = 0; line < lines; ++line)
    for (double k = 0; k < per_line && points.size() < n; ++k)
      points.push_back({(k + 0.1 * unit(random)) / per_line, (line + 0.001 * unit(random)) / lines});
  return points;
}

Points grid(std::size_t n) {
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  Points points(n);
  for (std::size_t i = 0; i < n; ++i)
    points[i] = {0.1 * static_cast<double>(i % side), 0.1 * static_cast<double>(i / side)};
  std::shuffle(points.begin(), points.end(), generator());
  return points;
}

Points turned_grid(std::size_t n) {
  Points points = grid(n);
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (auto& p : points) p = {c * p[0] - s * p[1], s * p[0] + c * p[1]};
  return points;
}

Points clusters(std::size_t n) {
  auto random = generator();
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal(0, 0.001);
  Points centers(100), points(n);
  for (auto& c : centers) c = {unit(random), unit(random)};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& c = centers[i % centers.size()];
    points[i] = {c[0] + normal(random), c[1] + normal(random)};
  }
  return points;
}

void run_tri(benchmark::State& state, const Points& points, int threads) {
  std::size_t triangles = 0;
  for (auto _ : state) {
    tri::Context context;
    context.threads = threads;
    triangles = tri::delaunay(points, context).triangles.size();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}

void run_cgal(benchmark::State& state, const Points& points) {
  std::vector<Kernel::Point_2> input;
  for (const auto& p : points) input.emplace_back(p[0], p[1]);
  std::size_t triangles = 0;
  for (auto _ : state) {
    CGAL::Delaunay_triangulation_2<Kernel> triangulation;
    triangulation.insert(input.begin(), input.end());
    triangles = triangulation.number_of_faces();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}

}  // namespace

int main(int argc, char** argv) {
  const std::pair<std::string, Points (*)(std::size_t)> inputs[] = {
      {"uniform", uniform}, {"scan", scan_lines}, {"grid", grid}, {"turned-grid", turned_grid}, {"clusters", clusters}};
  for (const auto& [name, make] : inputs) {
    constexpr std::size_t n = 1000000;
    const std::string stem = "delaunay/" + name + "/" + std::to_string(n);
    const auto add = [&](const std::string& suffix, auto run) {
      benchmark::RegisterBenchmark((stem + suffix).c_str(),
                                   [make = make, run](benchmark::State& state) { run(state, make(n)); })
          ->Unit(benchmark::kMillisecond)
          ->MeasureProcessCPUTime()
          ->UseRealTime();
    };
    add("/tri/threads:1", [](benchmark::State& state, const Points& points) { run_tri(state, points, 1); });
    add("/tri/threads:all", [](benchmark::State& state, const Points& points) { run_tri(state, points, 0); });
    add("/cgal", [](benchmark::State& state, const Points& points) { run_cgal(state, points); });
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "meshops/checks/mesh_distance.hpp"
#include "meshops/error.hpp"
#include "meshops/search/closest_triangle.hpp"

using namespace tri;

namespace {

// A rectangle in z = height as a grid of cells, without those that `keep` refuses.
template <class Keep>
Soup flat_sheet(Vec2 low, Vec2 high, double height, int cells, Keep keep) {
  Soup soup;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i)
      soup.points.push_back({low[0] + (high[0] - low[0]) * i / cells, low[1] + (high[1] - low[1]) * j / cells, height});
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      if (!keep(i, j)) continue;
      const auto a = static_cast<std::uint32_t>(j * (cells + 1) + i), b = a + static_cast<std::uint32_t>(cells) + 1;
      soup.triangles.push_back({a, a + 1, b + 1});
      soup.triangles.push_back({a, b + 1, b});
    }
  return soup;
}

Soup flat_sheet(Vec2 low, Vec2 high, double height, int cells) {
  return flat_sheet(low, high, height, cells, [](int, int) { return true; });
}

Soup ring_sphere(double radius, int rings) {
  Soup soup;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < around; ++k) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * k / around;
      soup.points.push_back(Vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)) * radius);
    }
  const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * around + k % around); };
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < around; ++k) {
      soup.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      soup.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return soup;
}

MeshDistance distance(const Soup& a, const Soup& b, MeshDistanceOptions options = {}) {
  if (!options.samples) options.samples = 4000;
  Context context;
  return mesh_distance(a, b, options, context);
}

}  // namespace

TEST_CASE("closest_triangle: agrees with every triangle tried in turn, with any hint") {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(-1, 1);
  Soup soup;
  for (int i = 0; i < 900; ++i)
    soup.points.push_back(Vec3(place(random), place(random), place(random)) * (i < 450 ? 1.0 : 0.1));
  for (std::uint32_t t = 0; t < 300; ++t) soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  soup.triangles.push_back({5, 5, 5});
  const ClosestTriangle tree(soup.points, soup.triangles);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = Vec3(place(random), place(random), place(random)) * 2;
    double best = std::numeric_limits<double>::infinity();
    for (const Triangle& t : soup.triangles)
      best = std::min(best,
                      (closest_on_triangle({soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]}, p) - p).norm());
    const auto hit = tree.closest(p), hinted = tree.closest(p, static_cast<std::uint32_t>(i));
    CHECK(hit.distance == best);
    CHECK(hit.distance == doctest::Approx((hit.point - p).norm()));
    CHECK(hinted.triangle == hit.triangle);
  }
  CHECK_THROWS_AS(ClosestTriangle(soup.points, {}), InvalidInput);
}

TEST_CASE("mesh_distance: two parallel sheets are as far apart as their planes, however they are triangulated") {
  const MeshDistance d = distance(flat_sheet({0, 0}, {2, 1}, 0.25, 7), flat_sheet({0, 0}, {2, 1}, 0, 5));
  for (const double value : {d.hausdorff, d.hausdorff_bound, d.mean, d.rms, d.forward.rms, d.backward.mean})
    CHECK(value == doctest::Approx(0.25).epsilon(0.0101));
  CHECK(d.rms == doctest::Approx(0.25).epsilon(1e-9));
  CHECK(d.hausdorff <= d.hausdorff_bound);
  CHECK(d.forward.area == doctest::Approx(2));
  // The first lies on the side that the second faces, and the second behind the first.
  for (const double v : d.forward.vertices) CHECK(v == doctest::Approx(0.25).epsilon(1e-12));
  for (const double v : d.backward.vertices) CHECK(v == doctest::Approx(-0.25).epsilon(1e-12));
}

TEST_CASE("mesh_distance: a sheet that juts out is far only in its own direction") {
  // The large sheet's corners are the diagonal of the margin away from the small one's.
  const double h = 0.1, margin = 0.5;
  const MeshDistance d =
      distance(flat_sheet({0, 0}, {1, 1}, h, 4), flat_sheet({-margin, -margin}, {1 + margin, 1 + margin}, 0, 9));
  CHECK(d.forward.max == doctest::Approx(h).epsilon(1e-9));
  CHECK(d.backward.max == doctest::Approx(std::sqrt(h * h + 2 * margin * margin)).epsilon(1e-9));
  CHECK(d.hausdorff == d.backward.max);
  // Over the margin's sides the mean square is h^2 + m^2/3 and over its corners h^2 + 2 m^2/3.
  const double square = h * h + (4 * margin * margin * margin / 3 + 4 * margin * margin * 2 * margin * margin / 3) / 4;
  CHECK(d.backward.rms == doctest::Approx(std::sqrt(square)).epsilon(0.01));
  CHECK(d.rms == doctest::Approx(std::sqrt((h * h * 1 + square * 4) / 5)).epsilon(0.01));
  CHECK(d.backward.mean_error > 0);
}

TEST_CASE("mesh_distance: the farthest place is found inside a triangle, away from all vertices and samples") {
  // Two triangles over a sheet with a square hole: the middle of the hole is half its width from its rim.
  const Soup holed = flat_sheet({0, 0}, {1, 1}, 0, 10, [](int i, int j) { return i < 2 || i >= 6 || j < 5 || j >= 9; });
  MeshDistanceOptions options;
  options.samples = 1;
  options.relative_error = 1e-4;
  const MeshDistance d = distance(flat_sheet({0, 0}, {1, 1}, 0, 1), holed, options);
  CHECK(d.forward.max <= 0.2 + 1e-12);
  CHECK(d.forward.max_bound >= 0.2 - 1e-12);
  CHECK(d.forward.max_bound - d.forward.max <= 1e-4 * d.forward.max);
  CHECK((d.forward.place - Vec3(0.4, 0.7, 0)).norm() < 1e-4);
  CHECK(d.backward.max <= 1e-15);
  CHECK(d.backward.max_bound <= 2e-6);
}

TEST_CASE("mesh_distance: when the searches are used up the bounds still hold the truth") {
  const Soup holed = flat_sheet({0, 0}, {1, 1}, 0, 10, [](int i, int j) { return i < 2 || i >= 6 || j < 5 || j >= 9; });
  MeshDistanceOptions options;
  options.samples = 1;
  double gap = std::numeric_limits<double>::infinity();
  for (const std::uint64_t searches : {0, 30, 3000}) {
    options.max_searches = searches;
    options.relative_error = 1e-9;
    const OneSidedDistance d = distance(flat_sheet({0, 0}, {1, 1}, 0, 1), holed, options).forward;
    CHECK(d.max <= 0.2 + 1e-12);
    CHECK(d.max_bound >= 0.2 - 1e-12);
    CHECK(d.max_bound - d.max < gap);
    gap = d.max_bound - d.max;
  }
}

TEST_CASE("mesh_distance: concentric spheres are as far apart as their radii differ, to the depth of a facet") {
  const int rings = 24;
  const double sagitta = 1 - std::pow(std::cos(std::numbers::pi / rings), 2);  // a facet of the unit sphere dips at
                                                                               // most so deep
  const MeshDistance d = distance(ring_sphere(1.2, rings), ring_sphere(1, rings + 1));
  CHECK(d.hausdorff >= 0.2 - 1e-12);
  CHECK(d.hausdorff_bound <= 0.2 + 1.2 * sagitta + 0.01 * d.hausdorff);
  CHECK(d.rms == doctest::Approx(0.2).epsilon(1.2 * sagitta / 0.2));
  CHECK(d.forward.area == doctest::Approx(4 * std::numbers::pi * 1.44).epsilon(0.01));
}

TEST_CASE("mesh_distance: the bounds hold against a dense sampling by brute force") {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-0.3, 0.3);
  Soup a = ring_sphere(1, 5), b = ring_sphere(1, 4);
  for (Soup* soup : {&a, &b})
    for (Vec3& p : soup->points) p += Vec3(place(random), place(random), place(random));
  const MeshDistance d = distance(a, b);
  const auto greatest = [](const Soup& from, const Soup& to) {
    double most = 0;
    for (const Triangle& t : from.triangles)
      for (int i = 0; i <= 12; ++i)
        for (int j = 0; i + j <= 12; ++j) {
          const Vec3 p = (from.points[t[0]] * i + from.points[t[1]] * j + from.points[t[2]] * (12 - i - j)) / 12.0;
          double least = std::numeric_limits<double>::infinity();
          for (const Triangle& u : to.triangles)
            least = std::min(least,
                             (closest_on_triangle({to.points[u[0]], to.points[u[1]], to.points[u[2]]}, p) - p).norm());
          most = std::max(most, least);
        }
    return most;
  };
  for (const auto& [side, truth] : {std::pair{d.forward, greatest(a, b)}, std::pair{d.backward, greatest(b, a)}}) {
    CHECK(truth <= side.max_bound + 1e-12);
    CHECK(side.max >= truth - 0.01 * truth);
    CHECK(side.max_bound - side.max <= 0.01 * side.max + 1e-5);
    CHECK((side.place - side.foot).norm() == doctest::Approx(side.max));
  }
}

TEST_CASE("mesh_distance: a mesh is no distance from itself, and unused vertices are no part of it") {
  Soup a = ring_sphere(1, 8);
  a.points.push_back({9, 0, 0});
  const MeshDistance d = distance(a, a);
  CHECK(d.hausdorff <= 1e-12);
  CHECK(d.hausdorff_bound <= 1e-4);
  CHECK(d.rms <= 1e-12);
  CHECK(d.forward.vertices.back() == doctest::Approx(8).epsilon(0.01));
}

TEST_CASE("mesh_distance: the same to the last bit for any number of threads and the same seed") {
  const Soup a = ring_sphere(1, 12), b = ring_sphere(1.1, 9);
  const auto with = [&](int threads, std::uint64_t seed) {
    Context context;
    context.threads = threads;
    MeshDistanceOptions options;
    options.samples = 5000;
    options.seed = seed;
    return mesh_distance(a, b, options, context);
  };
  const MeshDistance one = with(1, 1), two = with(2, 1), other = with(2, 2);
  CHECK(one.rms == two.rms);
  CHECK(one.hausdorff == two.hausdorff);
  CHECK(one.hausdorff_bound == two.hausdorff_bound);
  CHECK(one.forward.place == two.forward.place);
  CHECK(one.rms != other.rms);
}

TEST_CASE("mesh_distance: refuses what has no surface, heeds a cancel, and takes a mesh without area by its vertices") {
  const Soup a = ring_sphere(1, 4);
  Soup points = a, infinite = a, line;
  points.triangles.clear();
  infinite.points[0][1] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(distance(a, points), InvalidInput);
  CHECK_THROWS_AS(distance(points, a), InvalidInput);
  CHECK_THROWS_AS(distance(a, infinite), InvalidInput);
  MeshDistanceOptions wrong;
  wrong.relative_error = 0;
  CHECK_THROWS_AS(distance(a, a, wrong), InvalidInput);
  Context context;
  context.cancel();
  CHECK_THROWS_AS(mesh_distance(a, a, {}, context), Cancelled);
  line.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}};
  const MeshDistance d = distance(line, flat_sheet({0, 0}, {1, 1}, 0, 2));
  CHECK(d.forward.samples == 0);
  CHECK(d.forward.mean == doctest::Approx(1.0 / 3));
  CHECK(d.forward.max == doctest::Approx(1));
}

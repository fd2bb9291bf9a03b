#include <doctest/doctest.h>

#include <random>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/operators/orient.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_orient(Soup& soup, const OrientOptions& options = {}) {
  Context context;
  return orient(soup, options, context);
}

/// Turns triangles at random, each with the given chance.
Soup shuffled(Soup soup, double chance) {
  std::mt19937_64 random(7);
  for (Triangle& t : soup.triangles)
    if (std::uniform_real_distribution<double>(0, 1)(random) < chance) std::swap(t[0], t[2]);
  return soup;
}

bool same_orientation(const Soup& a, const Soup& b) {
  const auto rotated = [](Triangle t) {
    while (t[0] != std::min({t[0], t[1], t[2]})) t = {t[1], t[2], t[0]};
    return t;
  };
  for (std::size_t i = 0; i < a.triangles.size(); ++i)
    if (rotated(a.triangles[i]) != rotated(b.triangles[i])) return false;
  return true;
}

}  // namespace

TEST_CASE("orient: a solid faces outward, however its triangles were turned") {
  const Soup right = sphere(9, 5, 2, {10, -3, 4});
  for (const double chance : {0.1, 0.5, 0.9, 1.0}) {
    Soup soup = shuffled(right, chance);
    run_orient(soup);
    CHECK(same_orientation(soup, right));
    CHECK(soup_volume(soup) > 0);
  }
}

TEST_CASE("orient: nested shells face by turns, each relative to those around it") {
  Soup right = cube({0, 0, 0}, 9);
  for (int i = 1; i < 4; ++i) {
    const Soup inner = cube(Vec3(i, i, i), 9 - 2 * i);
    right = joined(right, i % 2 == 0 ? inner : turned_around(inner));
  }
  right = joined(right, cube({20, 0, 0}, 2));                        // beside
  right = joined(right, turned_around(cube({4.2, 4.2, 4.2}, 0.1)));  // in the innermost solid: depth 4 gives outward
  Soup wanted = right;
  for (std::size_t i = wanted.triangles.size() - 12; i < wanted.triangles.size(); ++i)
    std::swap(wanted.triangles[i][1], wanted.triangles[i][2]);
  for (const double chance : {0.0, 0.3, 1.0}) {
    Soup soup = shuffled(right, chance);
    run_orient(soup);
    CHECK(same_orientation(soup, wanted));
  }
}

TEST_CASE("orient: solids whose boxes are nested but that are not face outward both") {
  const Soup shell = sphere(16, 9, 5);
  Soup corner = joined(shell, cube({3.2, 3.2, 3.2}, 0.5));  // within the box of the sphere, outside of the sphere
  Soup across = joined(shell, cube({2.5, 2.5, 2.5}, 0.8));  // crosses the sphere
  for (Soup* right : {&corner, &across}) {
    Soup soup = turned_around(*right);
    run_orient(soup);
    CHECK(same_orientation(soup, *right));
  }
}

TEST_CASE("orient: a cavity that touches the outer shell in a vertex faces inward") {
  Soup right = joined(cube({0, 0, 0}, 4), turned_around(cube({1, 1, 1}, 2)));
  right.points[8] = Vec3(0, 2, 2);  // a corner of the cavity on the outer face
  Soup soup = shuffled(right, 1);
  run_orient(soup);
  CHECK(same_orientation(soup, right));
}

TEST_CASE("orient: an open sheet keeps the direction of its majority") {
  const Soup right = sheet(5, 5);
  Soup few = shuffled(right, 0.2), many = shuffled(right, 0.8);
  CHECK(run_orient(few).faces_reversed > 0);
  CHECK(same_orientation(few, right));
  run_orient(many);
  CHECK(same_orientation(many, turned_around(right)));
}

TEST_CASE("orient: without outward a solid that is inside out stays so") {
  Soup soup = turned_around(cube());
  CHECK(run_orient(soup, {.outward = false}).unchanged());
  CHECK(run_orient(soup).faces_reversed == 12);
  CHECK(soup_volume(soup) == doctest::Approx(1));
}

TEST_CASE("orient: two solids with an edge in common are oriented each on its own") {
  Soup right = joined(cube(), cube({1, 1, 0}));
  for (Triangle& t : right.triangles)
    for (std::uint32_t& v : t) v = v == 8 ? 3 : v == 12 ? 7 : v;
  Soup soup = right;
  for (std::size_t i = 12; i < 24; ++i) std::swap(soup.triangles[i][0], soup.triangles[i][1]);
  run_orient(soup);
  CHECK(same_orientation(soup, right));
}

TEST_CASE("orient: a Moebius strip is reported") {
  Soup strip;
  const int n = 12;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n, h = a / 2;
    for (const double s : {-0.3, 0.3})
      strip.points.emplace_back((1 + s * std::cos(h)) * std::cos(a), (1 + s * std::cos(h)) * std::sin(a),
                                s * std::sin(h));
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1;
    std::uint32_t c = (a + 2) % (2 * n), d = (a + 3) % (2 * n);
    if (i == n - 1) std::swap(c, d);
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  const Report report = run_orient(strip);
  CHECK(report.skipped.at("edges of a surface with one side only") >= 1);
  CHECK(summarize(strip).misoriented_edges == report.skipped.at("edges of a surface with one side only"));
}

TEST_CASE("orient: vertex normals and corner values follow") {
  const Soup right = with_attributes(sphere(6, 3));
  Soup soup = right;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    std::swap(soup.triangles[i][1], soup.triangles[i][2]);
    std::swap(soup.corner_scalars["x"][3 * i + 1], soup.corner_scalars["x"][3 * i + 2]);
  }
  run_orient(soup);
  CHECK(soup.corner_scalars == right.corner_scalars);
  for (const Vec3& n : soup.vertex_normals) CHECK(n == Vec3(0, 0, -1));
}

// Crossing triangles are cut, or cut out and the holes filled: checked by comparing every pair, by areas, which cutting
// does not change, by the Euler characteristic and the rim, which neither changes, and by distances of samples to every
// triangle.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/operators/remove_self_intersections.hpp"
#include "sampled_distance.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

using Corners = std::array<Vec3, 3>;

Corners corners_of(const Soup& soup, const Triangle& t) {
  return {soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]};
}

/// The triangles with points in one place named as one.
std::vector<Triangle> by_place(const Soup& soup) {
  std::map<std::array<double, 3>, std::uint32_t> names;
  std::vector<Triangle> result = soup.triangles;
  for (Triangle& t : result)
    for (std::uint32_t& v : t) {
      const Vec3& p = soup.points[v];
      v = names.emplace(std::array{p[0], p[1], p[2]}, v).first->second;
    }
  return result;
}

/// Pairs of triangles that meet in more than what they share, neighbours as well.
std::size_t all_crossings(const Soup& soup) {
  const std::vector<Triangle> named = by_place(soup);
  std::size_t count = 0;
  for (std::size_t i = 0; i < named.size(); ++i)
    for (std::size_t j = i + 1; j < named.size(); ++j)
      count += triangles_meet(named[i], corners_of(soup, named[i]), named[j], corners_of(soup, named[j]));
  return count;
}

/// How many triangles are at each edge.
std::map<std::array<std::uint32_t, 2>, int> edges_of(const Soup& soup) {
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const Triangle& t : by_place(soup))
    for (std::size_t k = 0; k < 3; ++k) ++edges[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  return edges;
}

int euler(const Soup& soup) {
  std::set<std::uint32_t> vertices;
  for (const Triangle& t : by_place(soup)) vertices.insert(t.begin(), t.end());
  return static_cast<int>(vertices.size() + soup.triangles.size()) - static_cast<int>(edges_of(soup).size());
}

/// The directed sides without a neighbour, by place.
std::multiset<std::array<double, 6>> open_sides(const Soup& soup) {
  const auto edges = edges_of(soup);
  std::multiset<std::array<double, 6>> open;
  for (const Triangle& t : by_place(soup))
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const Vec3 &p = soup.points[a], &q = soup.points[b];
      if (edges.at({std::min(a, b), std::max(a, b)}) == 1) open.insert({p[0], p[1], p[2], q[0], q[1], q[2]});
    }
  return open;
}

bool manifold_edges(const Soup& soup) {
  return std::ranges::all_of(edges_of(soup), [](const auto& edge) { return edge.second <= 2; });
}

double diagonal(const Soup& soup) {
  Vec3 low = soup.points[0], high = low;
  for (const Vec3& p : soup.points) low.minimize(p), high.maximize(p);
  return (high - low).norm();
}

/// A nearly flat sheet of n x n cells in which a vertex was pulled over its neighbours, so that it is folded there.
Soup folded_sheet(int n, double waves) {
  Soup soup = sheet(n, n);
  for (Vec3& p : soup.points) p[2] = waves * std::sin(2 * p[0] + 3 * p[1]);
  soup.points[static_cast<std::size_t>(n / 2 * (n + 1) + n / 2)] += Vec3(2.5, 0.6, 0);
  return soup;
}

/// Pairs of triangles without a corner's place in common that meet.
std::size_t crossings(const Soup& soup) {
  std::size_t count = 0;
  const auto corners = [&](const Triangle& t) {
    return std::array{soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]};
  };
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (std::size_t j = i + 1; j < soup.triangles.size(); ++j) {
      const auto a = corners(soup.triangles[i]), b = corners(soup.triangles[j]);
      bool share = false;
      for (const Vec3& p : a)
        for (const Vec3& q : b) share |= p == q;
      count += !share && triangles_intersect(a, b);
    }
  return count;
}

}  // namespace

TEST_CASE("remove-self-intersections: what does not cross stays as it is") {
  Context context;
  Soup soup = with_attributes(joined(cube(), sheet(3, 3)));
  for (std::size_t i = 8; i < soup.points.size(); ++i) soup.points[i] += Vec3(3, 3, 3);
  const Soup before = soup;
  CHECK(remove_self_intersections(soup, {}, context).unchanged());
  CHECK(same_soup(soup, before));
}

TEST_CASE("remove-self-intersections: surfaces that cross are cut, vertices stay and no area is lost") {
  Context context;
  for (const double shift : {0.3, 0.5, 0.77}) {
    CAPTURE(shift);
    Soup soup = joined(sphere(16, 8), sphere(15, 9, 0.8, Vec3(shift, 0.1, 0.2)));
    const Soup before = soup;
    const Report report = remove_self_intersections(soup, {}, context);
    CHECK(report.skipped.empty());
    CHECK(report.figures.at("crossing pairs") > 0);
    CHECK(crossings(before) > 0);
    CHECK(crossings(soup) == 0);
    CHECK(soup_area(soup) == doctest::Approx(soup_area(before)).epsilon(1e-6));
    CHECK(soup_volume(soup) == doctest::Approx(soup_volume(before)).epsilon(1e-6));
    for (std::size_t i = 0; i < before.points.size(); ++i) CHECK((soup.points[i] - before.points[i]).norm() < 1e-5);
  }
}

TEST_CASE("remove-self-intersections: a point far away that no triangle uses does not count") {
  Context context;
  for (const CrossingMethod method : {CrossingMethod::automatic, CrossingMethod::split}) {
    Soup soup = joined(sphere(16, 8), sphere(15, 9, 0.8, Vec3(0.5, 0.1, 0.2)));
    const double area = soup_area(soup);
    soup.points.emplace_back(1e12, -1e12, 5);
    const Report report = remove_self_intersections(soup, {.method = method}, context);
    CHECK(report.skipped.empty());
    CHECK(crossings(soup) == 0);
    CHECK(soup_area(soup) == doctest::Approx(area).epsilon(1e-6));
  }
}

TEST_CASE("remove-self-intersections: values of vertices are interpolated and those of triangles go to their pieces") {
  Context context;
  Soup soup = joined(cube(), cube(Vec3(0.5, 0.4, 0.3)));
  for (const Vec3& p : soup.points) soup.vertex_scalars["sum"].push_back(p[0] + 2 * p[1] + 3 * p[2]);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.face_scalars["body"].push_back(t < 12 ? 0 : 1);
  remove_self_intersections(soup, {}, context);
  REQUIRE(soup.vertex_scalars["sum"].size() == soup.points.size());
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    const Vec3& p = soup.points[i];
    CHECK(soup.vertex_scalars["sum"][i] == doctest::Approx(p[0] + 2 * p[1] + 3 * p[2]).epsilon(1e-6));
  }
  double first = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const Triangle& v = soup.triangles[t];
    if (soup.face_scalars["body"][t] == 0)
      first += ((soup.points[v[1]] - soup.points[v[0]]) % (soup.points[v[2]] - soup.points[v[0]])).norm() / 2;
  }
  CHECK(first == doctest::Approx(6).epsilon(1e-6));
}

TEST_CASE("remove-self-intersections: a fold is cut out and filled; rim, Euler characteristic and bound hold") {
  Context context;
  for (const double waves : {0.0, 0.01, 0.02}) {
    CAPTURE(waves);
    const Soup before = with_attributes(folded_sheet(8, waves));
    REQUIRE(all_crossings(before) > 0);
    Soup soup = before;
    const Report report = remove_self_intersections(soup, {.max_deviation = 0.005}, context);
    CHECK(report.skipped.empty());
    CHECK(report.notes.empty());
    CHECK(report.figures.at("places refilled") == 1);
    CHECK(report.figures.count("faces cut") == 0);
    CHECK(all_crossings(soup) == 0);
    CHECK(manifold_edges(soup));
    CHECK(euler(soup) == 1);
    CHECK(open_sides(soup) == open_sides(before));
    CHECK(std::max(farthest(before, soup), farthest(soup, before)) <= 0.005 * diagonal(before));
    // The square without the fold.
    CHECK(soup_area(soup) == doctest::Approx(64).epsilon(1e-3));
    for (const Triangle& t : soup.triangles)
      CHECK(((soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]))[2] > 0);
    CHECK(soup.triangles.size() + report.faces_removed == before.triangles.size() + report.faces_added);
    CHECK(soup.points.size() + report.vertices_removed == before.points.size());
    // The scalars "x" are the coordinate, at vertices and at corners.
    REQUIRE(soup.corner_scalars.at("x").size() == 3 * soup.triangles.size());
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(soup.corner_scalars["x"][3 * t + k] == soup.points[soup.triangles[t][k]][0]);
    for (std::size_t i = 0; i < soup.points.size(); ++i) CHECK(soup.vertex_scalars["x"][i] == soup.points[i][0]);
    // Triangles far from the fold are as they were.
    CHECK(soup.triangles[0] == before.triangles[0]);
    CHECK(soup.face_scalars["id"][0] == 0);
  }
}

TEST_CASE("remove-self-intersections: a solid with folds stays closed, with the volume of a sphere") {
  Context context;
  Soup soup = sphere(32, 20);
  // Vertices that were pulled over their neighbours, along the surface.
  for (const std::size_t v : {180u, 300u, 430u}) {
    const Vec3 p = soup.points[v], q = soup.points[v + 2];
    soup.points[v] = (q * 1.2 - p * 0.2) / (q * 1.2 - p * 0.2).norm();
  }
  const Soup before = soup;
  REQUIRE(all_crossings(before) > 0);
  const Report report =
      remove_self_intersections(soup, {.method = CrossingMethod::refill, .max_deviation = 0.02}, context);
  CHECK(report.skipped.empty());
  CHECK(report.figures.at("places refilled") == 3);
  CHECK(all_crossings(soup) == 0);
  CHECK(euler(soup) == 2);
  CHECK(open_sides(soup).empty());
  CHECK(std::max(farthest(before, soup), farthest(soup, before)) <= 0.02 * diagonal(before));
  CHECK(soup_volume(soup) == doctest::Approx(soup_volume(sphere(32, 20))).epsilon(0.01));
}

TEST_CASE("remove-self-intersections: what a filling would move too far stays, and is named; splitting does it, too") {
  Context context;
  // A spike of the lower sheet goes through the upper one.
  Soup soup = sheet(6, 6);
  soup.points[3 * 7 + 3] += Vec3(0.1, 0.05, 2);
  Soup upper = sheet(6, 6);
  for (Vec3& p : upper.points) p += Vec3(0.21, 0.13, 1.5);
  soup = joined(soup, upper);
  const Soup before = soup;
  Report report = remove_self_intersections(soup, {.method = CrossingMethod::refill, .max_deviation = 0.01}, context);
  CHECK(report.unchanged());
  CHECK(same_soup(soup, before));
  CHECK(report.skipped.at("pairs that still cross") == all_crossings(before));
  REQUIRE(report.notes.size() == 2);
  CHECK(report.notes[0].find("the surface would move by more than") != std::string::npos);

  // The spike is 2 long, and its tip over 2 from what would fill its place; 9 is the diagonal.
  report = remove_self_intersections(soup, {.method = CrossingMethod::refill, .max_deviation = 0.1}, context);
  CHECK(report.unchanged());

  report = remove_self_intersections(soup, {}, context);
  CHECK(report.skipped.empty());
  CHECK(report.notes.size() == 1);
  CHECK(report.figures.at("faces cut") > 0);
  CHECK(all_crossings(soup) == 0);
  CHECK(soup_area(soup) == doctest::Approx(soup_area(before)).epsilon(1e-6));

  // A lower one is within reach: the sheet that is left alone keeps all its triangles.
  Soup low = before;
  for (Vec3& p : low.points) p[2] *= 0.2;
  const Soup low_before = low;
  report = remove_self_intersections(low, {.method = CrossingMethod::refill, .max_deviation = 0.1}, context);
  CHECK(report.figures.at("places refilled") == 1);
  CHECK(all_crossings(low) == 0);
  CHECK(open_sides(low) == open_sides(low_before));
  CHECK(std::max(farthest(low_before, low), farthest(low, low_before)) <= 0.1 * diagonal(low_before));
}

TEST_CASE("remove-self-intersections: a place that can be refilled is, where another one cannot") {
  Context context;
  Soup soup = folded_sheet(8, 0.01);
  Soup spheres = joined(sphere(12, 7), sphere(13, 6, 0.8, Vec3(0.5, 0.1, 0.2)));
  for (Vec3& p : spheres.points) p += Vec3(4, 4, 5);
  soup = joined(soup, spheres);
  const Soup before = soup;
  const Report report = remove_self_intersections(soup, {.max_deviation = 0.004}, context);
  CHECK(report.skipped.empty());
  CHECK(report.figures.at("places refilled") == 1);
  CHECK(report.figures.at("faces cut") > 0);
  REQUIRE(report.notes.size() == 1);
  CHECK(all_crossings(soup) == 0);
  CHECK(open_sides(soup) == open_sides(before));
  CHECK(soup_volume(soup) == doctest::Approx(soup_volume(before)).epsilon(1e-2));
  CHECK(soup.triangles.size() + report.faces_removed == before.triangles.size() + report.faces_added);
  // What is new is named: any other triangle was there before.
  std::set<std::array<double, 9>> known;
  const auto key = [](const Soup& s, const Triangle& t) {
    std::array<double, 9> k{};
    for (std::size_t i = 0; i < 9; ++i) k[i] = s.points[t[i / 3]][i % 3];
    return k;
  };
  for (const Triangle& t : before.triangles) known.insert(key(before, t));
  const std::set<std::uint32_t> touched(report.touched_faces.begin(), report.touched_faces.end());
  for (std::uint32_t t = 0; t < soup.triangles.size(); ++t)
    if (!touched.count(t)) CHECK(known.count(key(soup, soup.triangles[t])) == 1);
}

TEST_CASE("remove-self-intersections: noise that folds a sheet everywhere never gets worse, and the bound holds") {
  Context context;
  std::mt19937 random(7);
  const auto real = [&] { return static_cast<double>(random() % 100000) / 50000 - 1; };
  std::size_t before_in_all = 0, after_in_all = 0;
  for (int run = 0; run < 6; ++run) {
    CAPTURE(run);
    Soup soup = sheet(7, 7);
    for (Vec3& p : soup.points) p += Vec3(real(), real(), 0.1 * real()) * (0.5 + 0.06 * run);
    if (run % 3 == 1) soup = exploded(soup);
    const Soup before = soup;
    const Report report =
        remove_self_intersections(soup, {.method = CrossingMethod::refill, .max_deviation = 0.02}, context);
    const std::size_t crossing = crossings(before), left = crossings(soup);
    before_in_all += crossing;
    after_in_all += left;
    CHECK(left <= crossing);
    CHECK(open_sides(soup) == open_sides(before));
    CHECK(std::max(farthest(before, soup), farthest(soup, before)) <= 0.02 * diagonal(before));
    CHECK(euler(soup) == 1);
    CHECK(manifold_edges(soup));
    CHECK(all_crossings(soup) <= all_crossings(before));
    CHECK((all_crossings(soup) == 0) == report.skipped.empty());
    Soup split = soup;
    remove_self_intersections(split, {.method = CrossingMethod::split}, context);
    CHECK(crossings(split) == 0);
  }
  CHECK(after_in_all < before_in_all);
}

TEST_CASE("remove-self-intersections: triangles with corners of their own keep them, but where they are cut") {
  Context context;
  Soup soup = exploded(joined(sphere(10, 6), sphere(9, 5, 0.5, Vec3(1, 0.1, 0.2))));
  const Soup before = soup;
  const Report report = remove_self_intersections(soup, {.method = CrossingMethod::split}, context);
  CHECK(crossings(soup) == 0);
  CHECK(report.faces_removed < before.triangles.size() / 2);
  // Every triangle that was not cut has its three corners alone.
  std::vector<int> uses(soup.points.size(), 0);
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) ++uses[v];
  const std::set<std::uint32_t> touched(report.touched_faces.begin(), report.touched_faces.end());
  std::size_t whole = 0;
  for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
    if (touched.count(t)) continue;
    ++whole;
    CHECK(soup.triangles[t] == Triangle{soup.triangles[t][0], soup.triangles[t][0] + 1, soup.triangles[t][0] + 2});
  }
  CHECK(whole + report.faces_removed == before.triangles.size());
}

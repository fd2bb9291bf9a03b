#include <doctest/doctest.h>

#include <random>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/operators/remove_degenerate.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_remove_degenerate(Soup& soup, const RemoveDegenerateOptions& options = {}) {
  Context context;
  return remove_degenerate(soup, options, context);
}

/// Height over the longest side of the worst triangle.
double worst(const Soup& soup) {
  double least = 1;
  for (const Triangle& t : soup.triangles) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (soup.points[t[k]] - soup.points[t[(k + 1) % 3]]).norm());
    const double area = ((soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]])).norm();
    least = std::min(least, longest > 0 ? area / longest / longest : 0);
  }
  return least;
}

/// A triangle cut in three at a place, with a cap over its first side: as a T-junction closed by a sliver.
void insert_caps(Soup& soup, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = soup.triangles[i];
    const auto c = static_cast<std::uint32_t>(soup.points.size());
    soup.points.push_back((soup.points[t[0]] + soup.points[t[1]]) / 2);
    soup.triangles[i] = {t[0], c, t[2]};
    soup.triangles.push_back({c, t[1], t[2]});
    soup.triangles.push_back({t[0], t[1], c});
  }
}

}  // namespace

TEST_CASE("remove_degenerate: caps go by splitting the side that they lie on; nothing moves and nothing opens") {
  Soup soup = cube({0, 0, 0}, 4);
  insert_caps(soup, 12);
  REQUIRE(summarize(soup).closed);
  REQUIRE(worst(soup) == 0);
  const std::vector<Vec3> points = soup.points;
  const Report report = run_remove_degenerate(soup);
  const MeshSummary s = summarize(soup);
  CHECK(s.closed);
  CHECK(s.manifold);
  CHECK(s.oriented);
  CHECK(s.euler == 2);
  CHECK(s.volume == doctest::Approx(64));
  CHECK(s.area == doctest::Approx(96));
  CHECK(worst(soup) > 0.01);
  CHECK(report.skipped.empty());
  CHECK(report.vertices_moved == 0);
}

TEST_CASE("remove_degenerate: sides without length are collapsed; the topology stays") {
  Soup soup = sphere(10, 6);
  std::uint64_t split = 0;
  std::mt19937_64 random(4);
  for (int round = 0; round < 20; ++round) {
    // Split the side of a random triangle at one of its ends.
    const std::size_t i = std::uniform_int_distribution<std::size_t>(0, soup.triangles.size() - 1)(random);
    const std::uint32_t a = soup.triangles[i][0], b = soup.triangles[i][1];
    if (soup.points[a] == soup.points[b]) continue;
    ++split;
    const auto c = static_cast<std::uint32_t>(soup.points.size());
    soup.points.push_back(soup.points[a]);
    for (std::size_t k = 0, n = soup.triangles.size(); k < n; ++k) {
      Triangle& t = soup.triangles[k];
      if (std::ranges::find(t, a) == t.end() || std::ranges::find(t, b) == t.end()) continue;
      Triangle half = t;
      std::ranges::replace(half, a, c);
      std::ranges::replace(t, b, c);
      soup.triangles.push_back(half);
    }
  }
  REQUIRE(summarize(soup).closed);
  REQUIRE(worst(soup) == 0);
  const double volume = soup_volume(soup);
  const Report report = run_remove_degenerate(soup);
  const MeshSummary s = summarize(soup);
  CHECK(s.closed);
  CHECK(s.manifold);
  CHECK(s.euler == 2);
  CHECK(s.volume == doctest::Approx(volume));
  CHECK(worst(soup) > 0.01);
  CHECK(report.vertices_removed == split);
}

TEST_CASE("remove_degenerate: a chain of points on one line between two long sides is unfolded") {
  // Caps on caps: the side 0-1 of a box is filled with a fan of triangles without area.
  Soup soup = cube({0, 0, 0}, 8);
  std::vector<std::uint32_t> chain{0};
  for (int i = 1; i < 8; ++i) {
    chain.push_back(static_cast<std::uint32_t>(soup.points.size()));
    soup.points.emplace_back(i, 0, 0);
  }
  chain.push_back(1);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const Triangle t = soup.triangles[i];
    if (t != Triangle{0, 1, 5}) continue;
    // The front is cut along the chain; the bottom keeps its long side, and a fan from 0 fills between.
    soup.triangles[i] = {chain[0], chain[1], 5};
    for (std::size_t k = 1; k + 1 < chain.size(); ++k) {
      soup.triangles.push_back({chain[k], chain[k + 1], 5});
      soup.triangles.push_back({chain[0], chain[k + 1], chain[k]});
    }
    break;
  }
  REQUIRE(summarize(soup).closed);
  const Report report = run_remove_degenerate(soup);
  CHECK(report.skipped.empty());
  const MeshSummary s = summarize(soup);
  CHECK(s.closed);
  CHECK(s.manifold);
  CHECK(s.volume == doctest::Approx(512));
  CHECK(worst(soup) > 0.01);
}

TEST_CASE("remove_degenerate: a cap on the rim of a sheet just goes") {
  Soup soup = sheet(2, 2);
  soup.points.emplace_back(0.5, 0, 0);
  soup.triangles[0] = {0, 9, 4};
  soup.triangles.push_back({9, 1, 4});
  soup.triangles.push_back({0, 1, 9});
  const double area = soup_area(soup);
  CHECK(run_remove_degenerate(soup).faces_removed == 1);
  CHECK(soup_area(soup) == doctest::Approx(area));
  CHECK(summarize(soup).boundary_loops == 1);
  CHECK(summarize(soup).boundary_edges == 9);
}

TEST_CASE("remove_degenerate: triangles that are slim by right stay; the thresholds say where right ends") {
  Soup soup = box({0, 0, 0}, {1000, 1, 1});
  CHECK(run_remove_degenerate(soup).unchanged());
  Soup flat = box({0, 0, 0}, {1, 1, 1e-3});
  CHECK(run_remove_degenerate(flat, {.flatness = 1e-4}).unchanged());
  CHECK(run_remove_degenerate(flat, {.shortest_edge = 1e-4}).unchanged());
}

TEST_CASE("remove_degenerate: what no move can remove is counted, not forced") {
  // A tetrahedron without a volume: every collapse would leave a pillow.
  Soup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  soup.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  const Report report = run_remove_degenerate(soup);
  const std::uint64_t left =
      report.skipped.contains("no move that does no harm") ? report.skipped.at("no move that does no harm") : 0;
  CHECK(left == soup.triangles.size());
}

TEST_CASE("remove_degenerate: a deviation that is not allowed is not made") {
  Soup soup = sphere(8, 4);
  for (int i = 1; i <= 8; i += 2)
    soup.points[static_cast<std::size_t>(i)] = soup.points[static_cast<std::size_t>(i + 1)] + Vec3(1e-5, 2e-5, 1e-5);
  Soup strict = soup;
  const std::size_t triangles = soup.triangles.size();
  CHECK(run_remove_degenerate(soup, {.shortest_edge = 1e-4}).skipped.empty());
  CHECK(soup.triangles.size() == triangles - 8);
  CHECK(summarize(soup).closed);
  CHECK(run_remove_degenerate(strict, {.shortest_edge = 1e-4, .max_deviation = 1e-9})
            .skipped.at("no move that does no harm") == 8);
}

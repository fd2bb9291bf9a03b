#include <doctest/doctest.h>

#include <cmath>

#include "meshops/checks/mesh_summary.hpp"

using namespace tri;

namespace {

Soup tetrahedron(const Vec3& at = {0, 0, 0}) {
  Soup soup;
  soup.points = {at, at + Vec3(1, 0, 0), at + Vec3(0, 1, 0), at + Vec3(0, 0, 1)};
  soup.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return soup;
}

void append(Soup& soup, const Soup& other) {
  const auto n = static_cast<std::uint32_t>(soup.points.size());
  soup.points.insert(soup.points.end(), other.points.begin(), other.points.end());
  for (const Triangle& t : other.triangles) soup.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
}

// A grid of n x n squares in two triangles each; joined at both pairs of sides it is a torus, at none a sheet.
Soup torus_or_sheet(std::uint32_t n, bool torus) {
  Soup soup;
  const std::uint32_t rows = torus ? n : n + 1;
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t k = 0; k < rows; ++k) soup.points.push_back({double(i), double(k), double(i * k % 3)});
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return i % rows * rows + k % rows; };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      soup.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      soup.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return soup;
}

}  // namespace

TEST_CASE("summarize: an empty soup has nothing") {
  const MeshSummary s = summarize(Soup{});
  CHECK(s.triangles == 0);
  CHECK(s.components == 0);
  CHECK(s.euler == 0);
  CHECK_FALSE(s.closed);
}

TEST_CASE("summarize: a tetrahedron is closed, oriented, and has its area and volume") {
  const MeshSummary s = summarize(tetrahedron({1e5, 0, 0}));
  CHECK(s.edges == 6);
  CHECK(s.euler == 2);
  CHECK(s.components == 1);
  CHECK(s.boundary_loops == 0);
  CHECK((s.manifold && s.oriented && s.closed));
  CHECK(s.area == doctest::Approx(1.5 + std::sqrt(3.0) / 2));
  CHECK(s.volume == doctest::Approx(1.0 / 6));
  CHECK(s.shortest_edge == doctest::Approx(1));
  CHECK(s.longest_edge == doctest::Approx(std::sqrt(2.0)));
}

TEST_CASE("summarize: loops and Euler characteristic of a sheet, a sheet with holes and a torus") {
  MeshSummary s = summarize(torus_or_sheet(6, false));
  CHECK(s.boundary_loops == 1);
  CHECK(s.euler == 1);
  CHECK(s.boundary_edges == 24);
  Soup holed = torus_or_sheet(6, false);
  // Squares (1,1) and (3,4) share no vertex.
  holed.triangles.erase(holed.triangles.begin() + 2 * (3 * 6 + 4), holed.triangles.begin() + 2 * (3 * 6 + 4) + 2);
  holed.triangles.erase(holed.triangles.begin() + 2 * (1 * 6 + 1), holed.triangles.begin() + 2 * (1 * 6 + 1) + 2);
  s = summarize(holed);
  CHECK(s.boundary_loops == 3);
  CHECK(s.euler == -1);
  CHECK(s.components == 1);
  s = summarize(torus_or_sheet(6, true));
  CHECK(s.closed);
  CHECK(s.euler == 0);
  CHECK((s.manifold && s.oriented));
}

TEST_CASE("summarize: two parts that touch in a vertex are two components and a non-manifold vertex") {
  Soup soup = tetrahedron();
  append(soup, tetrahedron({5, 0, 0}));
  CHECK(summarize(soup).components == 2);
  CHECK(summarize(soup).manifold);
  for (std::size_t t = 4; t < 8; ++t)
    for (std::uint32_t& v : soup.triangles[t])
      if (v == 4) v = 0;
  const MeshSummary s = summarize(soup);
  CHECK(s.components == 2);
  CHECK(s.nonmanifold_vertices == 1);
  CHECK(s.unused_vertices == 1);
  CHECK_FALSE(s.manifold);
}

TEST_CASE("summarize: two holes that touch in a vertex have one chain around both") {
  Soup soup = torus_or_sheet(6, false);
  soup.triangles.erase(soup.triangles.begin() + 2 * (2 * 6 + 2), soup.triangles.begin() + 2 * (2 * 6 + 2) + 2);
  soup.triangles.erase(soup.triangles.begin() + 2 * (1 * 6 + 1), soup.triangles.begin() + 2 * (1 * 6 + 1) + 2);
  const MeshSummary s = summarize(soup);
  CHECK(s.nonmanifold_vertices == 1);
  CHECK(s.boundary_loops == 2);  // the other is the sheet's rim
}

TEST_CASE("summarize: finds what is wrong") {
  Soup soup = tetrahedron();
  std::swap(soup.triangles[2][0], soup.triangles[2][1]);
  CHECK(summarize(soup).misoriented_edges == 3);
  CHECK_FALSE(summarize(soup).oriented);
  soup = tetrahedron();
  soup.points.push_back({1, 1, -1});
  soup.triangles.push_back({0, 1, 4});
  CHECK(summarize(soup).nonmanifold_edges == 1);
  soup.triangles.push_back({1, 4, 0});
  CHECK(summarize(soup).duplicate_triangles == 1);
  soup.triangles.push_back({1, 1, 0});
  CHECK(summarize(soup).repeated_corners == 1);
  CHECK_FALSE(summarize(soup).manifold);
  soup.points.push_back({0.5, 0, 0});
  soup.triangles.push_back({0, 5, 1});
  CHECK(summarize(soup).zero_area == 1);
}

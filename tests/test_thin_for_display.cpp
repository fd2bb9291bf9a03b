#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "meshops/error.hpp"
#include "meshops/points/thin_for_display.hpp"

using namespace tri;

namespace {

// A wavy sheet of cells x cells squares with its height as a scalar.
Soup wave(int cells) {
  Soup soup;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const double x = 10.0 * i / cells, y = 10.0 * j / cells;
      soup.points.push_back({x, y, std::sin(x)});
      soup.vertex_scalars["height"].push_back(std::sin(x));
      soup.vertex_colors.push_back({1, 2, 3});
    }
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (cells + 1) + i), b = a + static_cast<std::uint32_t>(cells) + 1;
      soup.triangles.push_back({a, a + 1, b + 1});
      soup.triangles.push_back({a, b + 1, b});
    }
  return soup;
}

}  // namespace

TEST_CASE("thin_for_display: a soup that is light enough is returned as it is") {
  const Soup soup = wave(10);
  const Soup same = thin_for_display(soup, 200);
  CHECK(same.triangles == soup.triangles);
  CHECK(same.points.size() == soup.points.size());
  CHECK_THROWS_AS(thin_for_display(soup, 0), InvalidInput);
}

TEST_CASE("thin_for_display: fewer triangles on vertices of the original, with their attributes, over the same area") {
  const Soup soup = wave(100);
  const Soup thin = thin_for_display(soup, 2000);
  CHECK(thin.triangles.size() <= 2000);
  CHECK(thin.triangles.size() >= 600);
  REQUIRE(thin.vertex_scalars.at("height").size() == thin.points.size());
  CHECK(thin.vertex_colors.size() == thin.points.size());
  std::set<Vec3> originals(soup.points.begin(), soup.points.end());
  double projected = 0;
  for (std::size_t v = 0; v < thin.points.size(); ++v) {
    CHECK(originals.count(thin.points[v]) == 1);
    CHECK(thin.vertex_scalars.at("height")[v] == thin.points[v][2]);
  }
  for (const Triangle& t : thin.triangles) {
    for (const std::uint32_t v : t) REQUIRE(v < thin.points.size());
    const Vec3 n = (thin.points[t[1]] - thin.points[t[0]]) % (thin.points[t[2]] - thin.points[t[0]]);
    projected += 0.5 * n[2];
  }
  CHECK(projected == doctest::Approx(100).epsilon(0.1));
}

TEST_CASE("thin_for_display: points are thinned to the number asked for, evenly in their order") {
  Soup soup = wave(50);
  soup.triangles.clear();
  const Soup thin = thin_for_display(soup, 100);
  REQUIRE(thin.points.size() == 100);
  CHECK(thin.points[0] == soup.points[0]);
  CHECK(thin.points[99] == soup.points[99 * 2601 / 100]);
  CHECK(thin.vertex_scalars.at("height")[99] == thin.points[99][2]);
}

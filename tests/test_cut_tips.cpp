#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "meshops/crossings/arrangement/cut_tips.hpp"
#include "meshops/crossings/triangle_pair.hpp"

using namespace tri;

namespace {

constexpr std::int64_t cells_in_unit = 1 << 20;

/// A closed boundary out of triangles; vertices are those of equal numbers.
struct Shape {
  std::vector<GridPoint> points;
  std::vector<Triangle> triangles;
};

Shape grid_tetrahedron(const std::array<GridPoint, 4>& p) {
  Shape s{{p.begin(), p.end()}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  if (volume6(p[0], p[1], p[2], p[3]) < 0)
    for (Triangle& t : s.triangles) std::swap(t[0], t[1]);
  return s;
}

PlacedBoundary together(const std::vector<Shape>& shapes) {
  PlacedBoundary all;
  for (const Shape& s : shapes) {
    const auto first = static_cast<std::uint32_t>(all.points.size());
    for (const GridPoint& p : s.points) all.points.push_back(p);
    for (const Triangle& t : s.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  for (std::uint32_t t = 0; t < all.triangles.size(); ++t) all.face.push_back(t);
  for (std::uint32_t v = 0; v < all.points.size(); ++v) all.point.push_back(v);
  all.moved.assign(all.points.size(), 0);
  return all;
}

Vec3 place(const GridPoint& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

double boundary_volume(const PlacedBoundary& b) {
  double sum = 0;
  for (const Triangle& t : b.triangles) sum += place(b.points[t[0]]) | (place(b.points[t[1]]) % place(b.points[t[2]]));
  return sum / 6;
}

double boundary_area(const PlacedBoundary& b) {
  double sum = 0;
  for (const Triangle& t : b.triangles)
    sum +=
        ((place(b.points[t[1]]) - place(b.points[t[0]])) % (place(b.points[t[2]]) - place(b.points[t[0]]))).norm() / 2;
  return sum;
}

/// Every side, by the places of its ends, once each way.
bool closed_by_place(const PlacedBoundary& b) {
  std::map<std::array<GridPoint, 2>, int> sides;
  for (const Triangle& t : b.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++sides[{b.points[t[k]], b.points[t[(k + 1) % 3]]}];
  for (const auto& [side, count] : sides)
    if (count != 1 || !sides.contains({side[1], side[0]})) return false;
  return true;
}

/// Whether vertices that triangles use have places of their own.
bool apart(const PlacedBoundary& b) {
  std::map<GridPoint, std::uint32_t> at;
  for (const Triangle& t : b.triangles)
    for (const std::uint32_t v : t)
      if (at.emplace(b.points[v], v).first->second != v) return false;
  return true;
}

std::size_t boundary_crossings(const PlacedBoundary& b) {
  const auto corners = [&](const Triangle& t) {
    return std::array{place(b.points[t[0]]), place(b.points[t[1]]), place(b.points[t[2]])};
  };
  std::size_t count = 0;
  for (std::size_t i = 0; i < b.triangles.size(); ++i)
    for (std::size_t j = i + 1; j < b.triangles.size(); ++j) {
      std::set<GridPoint> places;
      for (const std::size_t t : {i, j})
        for (const std::uint32_t v : b.triangles[t]) places.insert(b.points[v]);
      if (places.size() == 6) count += triangles_intersect(corners(b.triangles[i]), corners(b.triangles[j]));
    }
  return count;
}

/// A cone over a polygon, from its tip down to a place below.
Shape spindle(const std::vector<GridPoint>& around, const GridPoint& tip, const GridPoint& below) {
  Shape s{around, {}};
  const auto n = static_cast<std::uint32_t>(around.size());
  s.points.push_back(tip);
  s.points.push_back(below);
  for (std::uint32_t i = 0; i < n; ++i) {
    s.triangles.push_back({i, (i + 1) % n, n});
    s.triangles.push_back({(i + 1) % n, i, n + 1});
  }
  return s;
}

}  // namespace

TEST_CASE("cut_tips: solids that touch in a point come apart, whatever their corners look like") {
  const GridPoint o{cells_in_unit, cells_in_unit, cells_in_unit};
  const auto at = [&](double x, double y, double z) {
    return GridPoint{o[0] + std::llround(x * cells_in_unit / 4), o[1] + std::llround(y * cells_in_unit / 4),
                     o[2] + std::llround(z * cells_in_unit / 4)};
  };
  const Shape corner = grid_tetrahedron({o, at(1, 0.2, 1), at(-0.5, 0.9, 1), at(-0.4, -0.8, 1)});
  const Shape opposite = grid_tetrahedron({o, at(1, 0, -1), at(-0.5, 0.9, -1.1), at(-0.5, -0.9, -1)});
  const Shape needle = grid_tetrahedron({o, at(0.001, 0, -1), at(-0.001, 0.001, -1), at(0, -0.001, -1)});
  // A tip whose sides go up and down by turns, so that no direction leans into all of them.
  std::vector<GridPoint> saddle;
  for (int i = 0; i < 8; ++i)
    saddle.push_back(at(std::cos(i * std::numbers::pi / 4), std::sin(i * std::numbers::pi / 4),
                        i % 4 == 0   ? 0.5
                        : i % 4 == 2 ? -0.5
                                     : 0));
  const Shape rider = grid_tetrahedron({o, at(0.1, 0.1, 1), at(-0.1, 0.1, 1), at(0, -0.1, 1)});
  const double height = 200;
  const std::vector<std::pair<const char*, std::vector<Shape>>> cases{
      {"corners", {corner, opposite}},
      {"a corner and a needle", {corner, needle}},
      {"a saddle and a corner on it", {spindle(saddle, o, at(0, 0, -2)), rider}},
  };
  for (const auto& [name, shapes] : cases) {
    CAPTURE(name);
    PlacedBoundary b = together(shapes);
    const PlacedBoundary before = b;
    REQUIRE(boundary_volume(before) > 0);
    REQUIRE_FALSE(apart(before));
    Context context;
    CHECK(cut_tips(b, height, context) == 0);
    CHECK(apart(b));
    CHECK(closed_by_place(b));
    CHECK(boundary_crossings(b) == 0);
    CHECK(std::abs(boundary_volume(b) - boundary_volume(before)) < boundary_area(before) * height);
    CHECK(b.face.size() == b.triangles.size());
    CHECK(b.point.size() == b.points.size());
    CHECK(b.moved.size() == b.points.size());
    for (std::size_t v = 0; v < before.points.size(); ++v) CHECK(b.points[v] == before.points[v]);
    // New vertices are near to where the tips were.
    for (std::size_t v = before.points.size(); v < b.points.size(); ++v)
      CHECK((place(b.points[v]) - place(o)).norm() < 30 * height);
  }
}

TEST_CASE("cut_tips: what does not touch stays as it is, and what has no room is counted") {
  Context context;
  const Shape one =
      grid_tetrahedron({GridPoint{0, 0, 0}, GridPoint{100, 0, 0}, GridPoint{0, 100, 0}, GridPoint{0, 0, 100}});
  PlacedBoundary alone = together({one});
  const PlacedBoundary before = alone;
  CHECK(cut_tips(alone, 10, context) == 0);
  CHECK(alone.triangles == before.triangles);
  CHECK(alone.points == before.points);
  // Edges of a step or two leave nothing to cut.
  const Shape tiny =
      grid_tetrahedron({GridPoint{0, 0, 0}, GridPoint{-2, 0, 0}, GridPoint{0, -2, 0}, GridPoint{0, 0, -2}});
  const Shape small =
      grid_tetrahedron({GridPoint{0, 0, 0}, GridPoint{2, 0, 0}, GridPoint{0, 2, 0}, GridPoint{0, 0, 2}});
  PlacedBoundary stuck = together({tiny, small});
  CHECK(cut_tips(stuck, 10, context) == 1);
}

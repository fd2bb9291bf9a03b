#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "meshops/crossings/surface_side.hpp"

using namespace tri;

namespace {

// A box whose sides do not share vertices, as an STL file would give it, with an L cut out: not convex, so that closest
// points lie on faces, convex and hollow edges, and corners of every kind. Seen from above: the square [0,2]^2 without
// [1,2]^2, from z = 0 to 1.
struct Bracket {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;

  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    for (const std::array<Vec3, 3>& t : {std::array<Vec3, 3>{a, b, c}, std::array<Vec3, 3>{a, c, d}}) {
      const auto first = static_cast<std::uint32_t>(points.size());
      points.insert(points.end(), t.begin(), t.end());
      triangles.push_back({first, first + 1, first + 2});
    }
  }
  Bracket() {
    const std::array<Vec3, 6> outline{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0),
                                      Vec3(1, 1, 0), Vec3(1, 2, 0), Vec3(0, 2, 0)};
    const Vec3 up(0, 0, 1);
    for (std::size_t i = 0; i < 6; ++i) {
      const Vec3 &a = outline[i], &b = outline[(i + 1) % 6];
      quad(a, b, b + up, a + up);
    }
    for (const bool top : {true, false})
      for (const auto& [low, high] :
           {std::pair{Vec3(0, 0, 0), Vec3(2, 1, 0)}, std::pair{Vec3(0, 1, 0), Vec3(1, 2, 0)}}) {
        const Vec3 a = low, b(high[0], low[1], 0), c = high, d(low[0], high[1], 0);
        if (top)
          quad(a + up, b + up, c + up, d + up);
        else
          quad(d, c, b, a);
      }
  }
  static bool holds(const Vec3& p) {
    const bool in_l = p[0] > 0 && p[1] > 0 && ((p[0] < 2 && p[1] < 1) || (p[0] < 1 && p[1] < 2));
    return in_l && p[2] > 0 && p[2] < 1;
  }
};

}  // namespace

TEST_CASE("surface_side: inside and outside of a solid with hollow and sharp edges, wherever the closest point lies") {
  const Bracket solid;
  const ClosestTriangle tree(solid.points, solid.triangles);
  const SurfaceSide sides(solid.points, solid.triangles);
  std::mt19937 random(10);
  std::uniform_real_distribution<double> place(-1.5, 3.5);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p(place(random), place(random), place(random) * 0.6);
    const double side = sides.side(p, tree.closest(p));
    CHECK(side == (Bracket::holds(p) ? -1 : 1));
    inside += side < 0;
  }
  CHECK(inside > 200);
}

TEST_CASE("surface_side: turned around, a surface changes sides; a triangle without area does no harm") {
  Bracket solid;
  for (Triangle& t : solid.triangles) std::swap(t[1], t[2]);
  solid.triangles.push_back({0, 0, 0});
  solid.triangles.push_back({0, 1, 1});
  const ClosestTriangle tree(solid.points, solid.triangles);
  const SurfaceSide sides(solid.points, solid.triangles);
  for (const Vec3& p : {Vec3(0.5, 0.5, 0.5), Vec3(0.9, 1.9, 0.9)}) CHECK(sides.side(p, tree.closest(p)) == 1);
  for (const Vec3& p : {Vec3(1.5, 1.5, 0.5), Vec3(-1, -1, -1), Vec3(3, 0.5, 0.5)})
    CHECK(sides.side(p, tree.closest(p)) == -1);
}

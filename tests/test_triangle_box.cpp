#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "meshops/search/overlap_tree.hpp"
#include "meshops/search/triangle_box.hpp"

using namespace tri;

namespace {

/// The triangle clipped at the six planes of a box, one after another.
std::vector<Vec3> clipped(const std::array<Vec3, 3>& triangle, const Vec3& low, const Vec3& high) {
  std::vector<Vec3> polygon(triangle.begin(), triangle.end());
  for (int k = 0; k < 3; ++k)
    for (const double side : {1.0, -1.0}) {
      const double limit = side > 0 ? high[k] : -low[k];
      std::vector<Vec3> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double at_p = limit - side * p[k], at_q = limit - side * q[k];
        if (at_p >= 0) kept.push_back(p);
        if ((at_p < 0) != (at_q < 0)) kept.push_back(p + (q - p) * (at_p / (at_p - at_q)));
      }
      polygon = kept;
    }
  return polygon;
}

std::array<Vec3, 3> random_triangle(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto place = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  const Vec3 a = place(), b = place();
  // Some are needles.
  return {a, b, random() % 2 ? place() : a + 0.01 * place()};
}

}  // namespace

TEST_CASE("TriangleBox: agrees with clipping the triangle by the box") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-2, 1), size(0, 2);
  int met = 0, apart = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto t = random_triangle(random);
    const Vec3 low(place(random), place(random), place(random));
    const Vec3 high = low + Vec3(size(random), size(random), size(random));
    const bool meets = !clipped(t, low, high).empty();
    CHECK(TriangleBox(t).may_meet(low, high) == meets);
    (meets ? met : apart) += 1;
  }
  CHECK(met > 1000);
  CHECK(apart > 1000);
}

TEST_CASE("TriangleBox: touching counts, far from the origin and for triangles without area as well") {
  const Vec3 far(1e6, -3e5, 7e5);
  for (const Vec3& shift : {Vec3(0, 0, 0), far}) {
    const std::array<Vec3, 3> t{shift, shift + Vec3(4, 0, 0), shift + Vec3(0, 4, 0)};
    CHECK(TriangleBox(t).may_meet(shift + Vec3(2, 2, 0), shift + Vec3(3, 3, 1)));       // at its long side
    CHECK(TriangleBox(t).may_meet(shift + Vec3(4, 0, 0), shift + Vec3(5, 1, 0)));       // at a corner
    CHECK(!TriangleBox(t).may_meet(shift + Vec3(2.5, 2.5, 0), shift + Vec3(3, 3, 1)));  // within its box
    const std::array<Vec3, 3> segment{shift, shift + Vec3(2, 2, 2), shift + Vec3(1, 1, 1)};
    CHECK(TriangleBox(segment).may_meet(shift + Vec3(1, 1, 1), shift + Vec3(2, 2, 1.5)));
    CHECK(!TriangleBox(segment).may_meet(shift + Vec3(1, 0, 0), shift + Vec3(2, 0.5, 0.5)));
  }
}

TEST_CASE("TriangleBox: beside its plane are places on one side of it") {
  std::mt19937 random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const auto t = random_triangle(random), u = random_triangle(random);
    const Vec3 n = (t[1] - t[0]) % (t[2] - t[0]);
    int above = 0, below = 0;
    for (const Vec3& p : u) ((n | (p - t[0])) > 0 ? above : below) += 1;
    CHECK(TriangleBox(t).beside(u) == (above == 3 || below == 3));
    CHECK(!TriangleBox(t).beside({t[0], u[1], u[2]}));  // one of the places is a corner
  }
}

TEST_CASE("OverlapTree: the boxes that a triangle meets are those found one by one") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-2, 2);
  std::vector<OverlapTree::Box> boxes(500);
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const Vec3 p(place(random), place(random), place(random));
    boxes[i].grow(p);
    boxes[i].grow(p + 0.2 * Vec3(place(random), place(random), place(random)));
    if (i % 5 != 0) items.push_back(i);
  }
  const OverlapTree tree(boxes, items);
  for (int trial = 0; trial < 200; ++trial) {
    const TriangleBox t(random_triangle(random));
    std::vector<std::uint32_t> found, expected;
    tree.meeting(t, [&](std::uint32_t i) { found.push_back(i); });
    for (const std::uint32_t i : items)
      if (t.may_meet(boxes[i].lo, boxes[i].hi)) expected.push_back(i);
    std::sort(found.begin(), found.end());
    CHECK(found == expected);
  }
}

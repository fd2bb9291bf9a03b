#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "meshops/search/moving_boxes.hpp"

using namespace tri;

namespace {

using Corners = std::array<Vec3, 3>;

struct Random {
  std::mt19937 engine{7};
  double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  Corners triangle(double size) {
    const Vec3 at((*this)(900, 1000), (*this)(-50, 50), (*this)(0, 3));
    Corners t;
    for (Vec3& p : t) p = at + Vec3((*this)(0, size), (*this)(0, size), (*this)(0, size));
    return t;
  }
};

bool boxes_overlap(const Corners& a, const Corners& b) {
  for (int k = 0; k < 3; ++k) {
    const auto [al, ah] = std::minmax({a[0][k], a[1][k], a[2][k]});
    const auto [bl, bh] = std::minmax({b[0][k], b[1][k], b[2][k]});
    if (al > bh || bl > ah) return false;
  }
  return true;
}

/// All that overlap by brute force are found, each once; and of the others only those that are next to touching.
void check_queries(const MovingBoxes& boxes, const std::vector<Corners>& items, const std::vector<char>& there,
                   Random& random) {
  for (int query = 0; query < 50; ++query) {
    const Corners t = random.triangle(query % 5 == 0 ? 30 : 3);
    std::vector<std::uint32_t> found;
    boxes.overlapping(boxes.box_of(t), [&](std::uint32_t i) { found.push_back(i); });
    std::sort(found.begin(), found.end());
    REQUIRE(std::adjacent_find(found.begin(), found.end()) == found.end());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      const bool hit = std::binary_search(found.begin(), found.end(), i);
      if (!there[i]) REQUIRE_FALSE(hit);
      if (there[i] && boxes_overlap(items[i], t)) REQUIRE(hit);
      Vec3 low = t[0], high = t[0];
      for (const Vec3& p : t) low.minimize(p), high.maximize(p);
      const Vec3 more(1e-4, 1e-4, 1e-4);
      if (there[i] && !boxes_overlap(items[i], {low - more, high + more, low})) REQUIRE_FALSE(hit);
    }
  }
}

}  // namespace

TEST_CASE("MovingBoxes: finds what overlaps, while items move, come and go") {
  Random random;
  for (const std::size_t count : {0u, 1u, 4u, 5u, 300u}) {
    CAPTURE(count);
    std::vector<Corners> items;
    for (std::size_t i = 0; i < count; ++i) items.push_back(random.triangle(i % 50 == 0 ? 40 : 2));
    std::vector<char> there(count, 1);
    MovingBoxes boxes;
    boxes.build(items, Context());
    REQUIRE(boxes.size() == count);
    check_queries(boxes, items, there, random);
    if (count == 0) continue;
    for (int step = 0; step < 400; ++step) {
      const auto i = static_cast<std::uint32_t>(random(0, static_cast<double>(items.size()) - 0.5));
      const Corners t = random.triangle(3);
      switch (step % 3) {
        case 0:
          items[i] = t, there[i] = 1;
          boxes.set(i, boxes.box_of(t));
          break;
        case 1:
          there[i] = 0;
          boxes.set(i, MovingBoxes::Box());
          break;
        default:
          items.push_back(t), there.push_back(1);
          boxes.add(i, boxes.box_of(t));
      }
      if (step % 100 == 99) check_queries(boxes, items, there, random);
    }
  }
}

TEST_CASE("MovingBoxes: what is not finite is not there, until it is") {
  constexpr double none = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const Corners unit{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const std::vector<Corners> items{
      unit, {Vec3(none, 0, 0), unit[1], unit[2]}, {Vec3(0, infinite, 0), unit[1], unit[2]}};
  MovingBoxes boxes;
  boxes.build(items, Context());
  std::vector<std::uint32_t> found;
  const auto look = [&] {
    found.clear();
    boxes.overlapping(boxes.box_of(unit), [&](std::uint32_t i) { found.push_back(i); });
    std::sort(found.begin(), found.end());
  };
  look();
  CHECK(found == std::vector<std::uint32_t>{0});
  boxes.set(1, boxes.box_of(unit));
  look();
  CHECK(found == std::vector<std::uint32_t>{0, 1});
}

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "meshops/search/box_tree.hpp"

using namespace tri;

TEST_CASE("box tree: visits every box that is nearer than the limit, as brute force does") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-100, 100), size(0, 5);
  for (const int n : {1, 3, 4, 5, 17, 1000}) {
    std::vector<Box> boxes(n);
    for (Box& b : boxes) {
      b.low = Vec3(place(random), place(random), place(random));
      b.high = b.low + Vec3(size(random), size(random), size(random));
    }
    const BoxTree tree(boxes);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p(2 * place(random), 2 * place(random), 2 * place(random));
      const double limit = 0.3 * (place(random) + 100);
      std::vector<int> visits(n, 0);
      tree.search(
          p, [&] { return limit; }, [&](std::uint32_t item) { ++visits[item]; });
      for (int k = 0; k < n; ++k) {
        Vec3 d;
        for (int c = 0; c < 3; ++c) d[c] = std::max({0.0, boxes[k].low[c] - p[c], p[c] - boxes[k].high[c]});
        CHECK(visits[k] <= 1);
        if (d.norm() <= limit) CHECK(visits[k] == 1);
        if (d.norm() > limit + 0.01) CHECK(visits[k] == 0);
      }
    }
  }
}

TEST_CASE("box tree: without boxes nothing is visited, without a limit everything") {
  BoxTree().search(
      Vec3(0, 0, 0), [] { return 1.0; }, [](std::uint32_t) { CHECK(false); });
  const BoxTree tree(std::vector<Box>(3, Box{Vec3(0, 0, 0), Vec3(1, 1, 1)}));
  int visits = 0;
  tree.search(
      Vec3(5, 5, 5), [] { return std::numeric_limits<double>::infinity(); }, [&](std::uint32_t) { ++visits; });
  CHECK(visits == 3);
}

TEST_CASE("box tree: a ray visits every box that it meets, along axes too, until it is told to stop") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-100, 100), size(0, 20);
  std::vector<Box> boxes(500);
  for (Box& b : boxes) {
    b.low = Vec3(place(random), place(random), place(random));
    b.high = b.low + Vec3(size(random), size(random), size(random));
  }
  const BoxTree tree(boxes);
  for (int i = 0; i < 300; ++i) {
    const Vec3 origin(place(random), place(random), place(random));
    Vec3 direction(place(random), place(random), place(random));
    if (i % 3 > 0) direction[i % 3] = 0;
    if (i % 5 == 0) direction[0] = 0;
    std::vector<int> visits(boxes.size(), 0);
    CHECK(!tree.along_ray(origin, direction, [&](std::uint32_t item) {
      ++visits[item];
      return false;
    }));
    bool any = false;
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      // Does a plane of the box, or the origin inside it, meet the ray? Slightly shrunk and grown, for rounding.
      const auto meets = [&](double grow) {
        double enter = 0, leave = std::numeric_limits<double>::infinity();
        for (int c = 0; c < 3; ++c) {
          const double low = boxes[k].low[c] - grow - origin[c], high = boxes[k].high[c] + grow - origin[c];
          if (direction[c] == 0 && (low > 0 || high < 0)) return false;
          if (direction[c] == 0) continue;
          enter = std::max(enter, std::min(low / direction[c], high / direction[c]));
          leave = std::min(leave, std::max(low / direction[c], high / direction[c]));
        }
        return enter <= leave;
      };
      CHECK(visits[k] <= 1);
      if (meets(0)) CHECK(visits[k] == 1);
      if (!meets(1e-3)) CHECK(visits[k] == 0);
      any = any || visits[k] > 0;
    }
    int calls = 0;
    CHECK(tree.along_ray(origin, direction, [&](std::uint32_t) { return ++calls > 0; }) == any);
    CHECK(calls == (any ? 1 : 0));
  }
  CHECK(!BoxTree().along_ray(Vec3(0, 0, 0), Vec3(1, 0, 0), [](std::uint32_t) { return true; }));
}

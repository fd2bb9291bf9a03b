// `RepairOptions::max_deviation` bounds how far the surface moves: checked by samples of both surfaces against every
// triangle of the other, with a distance of its own.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "meshops/checks/surface_reach.hpp"
#include "meshops/operators/remove_degenerate.hpp"
#include "meshops/repair.hpp"
#include "sampled_distance.hpp"

using namespace tri;
using namespace tri::test;

namespace {

double extent(const Soup& soup) {
  Vec3 low = soup.points[0], high = low;
  for (const Vec3& p : soup.points) low.minimize(p), high.maximize(p);
  return (high - low).norm();
}

void append_box(Soup& soup, const Vec3& low, const Vec3& high, double angle) {
  const auto first = static_cast<std::uint32_t>(soup.points.size());
  for (int i = 0; i < 8; ++i) {
    const Vec3 p(i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
    soup.points.push_back({p[0] * std::cos(angle) - p[1] * std::sin(angle),
                           p[0] * std::sin(angle) + p[1] * std::cos(angle), p[2] + 0.1 * p[0]});
  }
  for (const Triangle t : {Triangle{0, 2, 1},
                           {1, 2, 3},
                           {4, 5, 6},
                           {5, 7, 6},
                           {0, 1, 4},
                           {1, 5, 4},
                           {2, 6, 3},
                           {3, 6, 7},
                           {0, 4, 2},
                           {2, 4, 6},
                           {1, 3, 5},
                           {3, 7, 5}})
    soup.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

Soup square(double z, double size = 1) {
  Soup soup;
  soup.points = {Vec3(0, 0, z), Vec3(size, 0, z), Vec3(size, size, z), Vec3(0, size, z)};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}};
  return soup;
}

/// Two squares through each other, at places that no grid of a power of two holds.
Soup crossing_squares() {
  Soup soup = square(0.1);
  for (const Vec3& p :
       {Vec3(0.3, 0.21, -1.0 / 3), Vec3(0.31, 0.83, -0.7), Vec3(0.32, 0.81, 0.9), Vec3(0.33, 0.22, 1.0 / 7)})
    soup.points.push_back(p);
  soup.triangles.push_back({4, 5, 6});
  soup.triangles.push_back({4, 6, 7});
  return soup;
}

}  // namespace

TEST_CASE("places_beyond: finds what is farther than the reach, and only that") {
  Context context;
  const Soup one = square(0), other = square(0.25);
  const PlacesBeyond far = places_beyond(one, {}, other, 0.24, context),
                     near = places_beyond(one, {}, other, 0.26, context);
  REQUIRE(far.places.size() == 2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    CHECK(far.places[i].triangle == i);
    CHECK(far.places[i].distance == doctest::Approx(0.25));
    CHECK(far.places[i].at[2] == 0);
  }
  CHECK(near.places.empty());
  CHECK(near.undecided == 0);
  const std::vector<std::uint32_t> first{0};
  CHECK(places_beyond(one, first, other, 0.24, context).places.size() == 1);
  // A corner that sticks out is found, and triangles that are in both are no matter even for a reach of 0.
  CHECK(places_beyond(square(0, 1.5), {}, one, 0.3, context).places.size() == 2);
  CHECK(places_beyond(one, {}, one, 0, context).places.empty());
}

TEST_CASE(
    "repair: no place of the input ends farther than the bound from the result, nor of the result from a closed "
    "input") {
  std::mt19937 random(5);
  const auto real = [&] { return static_cast<double>(random() % 100000) / 100000; };
  Context context;
  for (const double bound : {1e-6, 1e-4, 1e-2, 0.1})
    for (int i = 0; i < 6; ++i) {
      CAPTURE(bound);
      CAPTURE(i);
      Soup before;
      append_box(before, Vec3(0, 0, 0), Vec3(1, 1, 1), real());
      append_box(before, Vec3(real(), real(), -real()), Vec3(1 + real(), 1 + real(), 1.5), real());
      if (i % 3 == 1)
        append_box(before, Vec3(0, 0, 0.02 * real()), Vec3(1, 1, 1 + 0.02 * real()), real());  // near to the first
      if (i % 3 == 2) before.triangles.resize(before.triangles.size() - 1);                    // a hole
      const double allowed = bound * extent(before) * (1 + 1e-9);
      for (const RepairGoal goal : {RepairGoal::solid, RepairGoal::surface}) {
        Soup soup = before;
        const RepairResult result = repair(soup, {.goal = goal, .max_deviation = bound}, context);
        CHECK(farthest(before, soup) <= allowed);
        if (i % 3 != 2 || goal == RepairGoal::surface) CHECK(farthest(soup, before) <= allowed);
        if (bound >= 1e-4) CHECK(result.left == 0);
      }
    }
}

TEST_CASE("repair: a step that would go beyond the bound is undone, named with its place, and counts as left") {
  Context context;
  const Soup before = crossing_squares();
  for (const RepairGoal goal : {RepairGoal::surface, RepairGoal::solid}) {
    // Where the squares cross, new vertices lie where doubles do not: with a bound of 0 there can be none.
    Soup soup = before;
    const RepairResult strict = repair(soup, {.goal = goal, .max_deviation = 0}, context);
    CHECK(strict.left > 0);
    CHECK(soup.points == before.points);
    CHECK(soup.triangles == before.triangles);
    const auto undone = std::ranges::find_if(
        strict.steps, [](const Report& r) { return r.skipped.contains("beyond max-deviation, undone"); });
    REQUIRE(undone != strict.steps.end());
    CHECK(undone->unchanged());
    REQUIRE_FALSE(undone->notes.empty());
    CHECK(undone->notes[0].find("are allowed") != std::string::npos);
    const RepairResult free = repair(soup, {.goal = goal, .max_deviation = 1e-3}, context);
    CHECK(free.left == 0);
    CHECK(free.changed);
  }
}

TEST_CASE("remove_degenerate: what collapses displace one after another stays within the bound") {
  // A strip of short edges along a rising curve: each collapse moves little, all of them together much.
  Soup before;
  constexpr std::uint32_t steps = 60;
  for (std::uint32_t i = 0; i <= steps; ++i)
    for (int k = 0; k < 3; ++k) before.points.push_back(Vec3(0.01 * i, k, k == 1 ? 1e-5 * i * i : 0));
  for (std::uint32_t i = 0; i < steps; ++i)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t a = 3 * i + k, b = a + 3;
      before.triangles.push_back({a, b, b + 1});
      before.triangles.push_back({a, b + 1, a + 1});
    }
  Context context;
  std::size_t fewest = before.triangles.size();
  for (const double bound : {1e-5, 1e-3, 1e-1}) {
    CAPTURE(bound);
    Soup soup = before;
    remove_degenerate(soup, {.shortest_edge = 0.05, .max_deviation = bound}, context);
    CHECK(farthest(before, soup) <= bound * (1 + 1e-9));
    CHECK(farthest(soup, before) <= bound * (1 + 1e-9));
    CHECK(soup.triangles.size() <= fewest);
    fewest = soup.triangles.size();
  }
  CHECK(fewest < before.triangles.size());
}

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "meshops/shape/quadric.hpp"

using namespace tri;

namespace {

/// The sum of squared distances to planes, by its definition.
struct Planes {
  std::vector<std::pair<Vec3, Vec3>> planes;  // place, normal times root of the weight

  double value(const Vec3& x) const {
    double sum = 0;
    for (const auto& [p, n] : planes) sum += std::pow(n | (x - p), 2);
    return sum;
  }
};

}  // namespace

TEST_CASE("quadric: the value is the sum of squared distances, wherever the origin is moved") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3(number(random), number(random), number(random)); };
  for (int run = 0; run < 20; ++run) {
    Planes planes;
    const Vec3 a = vector(), b = vector(), c = vector();
    Quadric qa, qb;
    for (int k = 0; k < 4; ++k) {
      planes.planes.push_back({a, vector()});
      qa.add_plane(planes.planes.back().second);
      planes.planes.push_back({b, vector()});
      qb.add_plane(planes.planes.back().second);
    }
    Quadric q = qa;
    q.move_origin(c - a);
    q.add_from(qb, c - b);
    for (int k = 0; k < 5; ++k) {
      const Vec3 x = vector();
      CHECK(q.value(x - c) == doctest::Approx(planes.value(x)));
    }
    const Vec3 least = q.least(1e-9);
    for (int k = 0; k < 20; ++k) CHECK(q.value(least) <= q.value(least + vector() * 0.01) + 1e-12);
  }
}

TEST_CASE("quadric: a corner is found; on a plane and along a crease the place does not move where it need not") {
  Quadric plane;
  plane.add_plane({0, 0, 2});
  plane.move_origin({0.5, 0.25, 3});
  CHECK((plane.least() - Vec3(0, 0, -3)).norm() < 1e-15);
  Quadric crease = plane;
  Quadric upright;
  upright.add_plane({1, 0, 0});
  crease.add_from(upright, {2, 0, 0});
  CHECK((crease.least() - Vec3(-2, 0, -3)).norm() < 1e-15);
  Quadric corner = crease;
  Quadric third;
  third.add_plane({0, 1, 1});
  corner.add_from(third, {0, 1, 0});
  CHECK(corner.value(corner.least()) == doctest::Approx(0));
  CHECK((corner.least() - Vec3(-2, 2, -3)).norm() < 1e-12);
  CHECK(Quadric().least() == Vec3(0, 0, 0));
}

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "libtri/model/triangle_tree.hpp"
#include "meshops/random_stream.hpp"

using namespace tri;

namespace {

struct Scene {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
};

Vec3 anywhere(RandomStream& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

Scene random_scene(int count) {
  Scene scene;
  RandomStream random(11);
  for (int i = 0; i < count; ++i) {
    const Vec3 centre = anywhere(random);
    for (int k = 0; k < 3; ++k) scene.points.push_back(centre + random.direction() * random.uniform(0, 0.2));
    const auto n = static_cast<std::uint32_t>(3 * i);
    scene.triangles.push_back({n, n + 1, n + 2});
  }
  return scene;
}

double to_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const double t = std::clamp(((x - a) | (b - a)) / (b - a).sqrnorm(), 0.0, 1.0);
  return (x - a - (b - a) * t).norm();
}

// Signs of the three sub-triangles' areas, seen along the triangle's normal.
bool above(const std::array<Vec3, 3>& t, const Vec3& x) {
  const Vec3 normal = (t[1] - t[0]) % (t[2] - t[0]);
  for (int k = 0; k < 3; ++k) {
    if ((((t[(k + 1) % 3] - t[k]) % (x - t[k])) | normal) < 0) return false;
  }
  return true;
}

double triangle_distance(const std::array<Vec3, 3>& t, const Vec3& x) {
  const Vec3 normal = ((t[1] - t[0]) % (t[2] - t[0])).normalize();
  if (above(t, x)) return std::abs((x - t[0]) | normal);
  return std::min({to_segment(t[0], t[1], x), to_segment(t[1], t[2], x), to_segment(t[2], t[0], x)});
}

bool ray_hits(const std::array<Vec3, 3>& t, const Vec3& origin, const Vec3& direction) {
  const Vec3 normal = (t[1] - t[0]) % (t[2] - t[0]);
  const double along = ((t[0] - origin) | normal) / (direction | normal);
  return along > 0 && above(t, origin + direction * along);
}

}  // namespace

TEST_CASE("TriangleTree: answers as asking every triangle does") {
  const Scene scene = random_scene(300);
  const TriangleTree tree(scene.points, scene.triangles);
  RandomStream random(12);
  int hits = 0, near = 0;
  constexpr int questions = 2000;
  for (int i = 0; i < questions; ++i) {
    const Vec3 origin = anywhere(random) * 2.0, direction = random.direction();
    const double radius = random.uniform(0.01, 0.4);
    bool hit = false, nearer = false;
    for (const Triangle& t : scene.triangles) {
      const std::array<Vec3, 3> corners = {scene.points[t[0]], scene.points[t[1]], scene.points[t[2]]};
      hit = hit || ray_hits(corners, origin, direction);
      nearer = nearer || triangle_distance(corners, origin) < radius;
    }
    CHECK(tree.hit(origin, direction) == hit);
    CHECK(tree.nearer_than(origin, radius) == nearer);
    hits += hit;
    near += nearer;
  }
  // Both answers occurred.
  CHECK(hits > 20);
  CHECK(hits < questions - 20);
  CHECK(near > 20);
  CHECK(near < questions - 20);
}

TEST_CASE("TriangleTree: an empty tree is hit by nothing, a ray along an axis meets what is in its way") {
  CHECK_FALSE(TriangleTree({}, {}).hit({0, 0, 0}, {0, 0, 1}));
  CHECK_FALSE(TriangleTree({}, {}).nearer_than({0, 0, 0}, 1e9));
  const std::vector<Vec3> points = {{-1, -1, 2}, {2, -1, 2}, {-1, 2, 2}};
  const std::vector<Triangle> one = {{0, 1, 2}};
  const TriangleTree tree(points, one);
  CHECK(tree.hit({0, 0, 0}, {0, 0, 1}));
  CHECK(tree.hit({0, 0, 5}, {0, 0, -3}));
  CHECK_FALSE(tree.hit({0, 0, 0}, {0, 0, -1}));
  CHECK_FALSE(tree.hit({3, 0, 0}, {0, 0, 1}));
}

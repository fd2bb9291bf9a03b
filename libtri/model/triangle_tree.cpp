#include "libtri/model/triangle_tree.hpp"

#include "meshops/search/closest_on_triangle.hpp"

namespace tri {
namespace {

// Moeller & Trumbore 1997, both sides.
bool ray_meets(const std::array<Vec3, 3>& t, const Vec3& origin, const Vec3& direction) {
  const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = direction % e2;
  const double det = e1 | p;
  if (det == 0) return false;
  const Vec3 s = origin - t[0];
  const double u = (s | p) / det;
  if (u < 0 || u > 1) return false;
  const Vec3 q = s % e1;
  const double v = (direction | q) / det;
  return v >= 0 && u + v <= 1 && (e2 | q) / det > 0;
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  std::vector<Box> boxes;
  corners_.reserve(triangles.size());
  boxes.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    corners_.push_back({points[t[0]], points[t[1]], points[t[2]]});
    Box box{points[t[0]], points[t[0]]};
    for (const Vec3& p : corners_.back()) {
      box.low.minimize(p);
      box.high.maximize(p);
    }
    boxes.push_back(box);
  }
  tree_ = BoxTree(boxes);
}

bool TriangleTree::hit(const Vec3& origin, const Vec3& direction) const {
  return tree_.along_ray(origin, direction, [&](std::uint32_t t) { return ray_meets(corners_[t], origin, direction); });
}

bool TriangleTree::nearer_than(const Vec3& point, double distance) const {
  bool found = false;
  tree_.search(
      point, [&] { return found ? 0 : distance; },
      [&](std::uint32_t t) {
        found = found || (closest_on_triangle(corners_[t], point) - point).sqrnorm() < distance * distance;
      });
  return found;
}

}  // namespace tri

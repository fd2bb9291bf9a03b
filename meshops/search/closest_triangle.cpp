#include "meshops/search/closest_triangle.hpp"

#include <cmath>
#include <string>

#include "meshops/error.hpp"

namespace tri {

ClosestTriangle::ClosestTriangle(std::span<const Vec3> points, std::span<const Triangle> triangles,
                                 const Context* context) {
  Pace pace(context);
  if (triangles.empty()) throw InvalidInput("a surface without triangles has no closest point");
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  corners_.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    pace();
    for (const std::uint32_t v : t)
      if (!std::isfinite(points[v].norm()))
        throw InvalidInput("vertex " + std::to_string(v) + " has a coordinate that is not finite");
    corners_.push_back({points[t[0]], points[t[1]], points[t[2]]});
    Box box{points[t[0]], points[t[0]]};
    for (const std::uint32_t v : t) {
      box.low.minimize(points[v]);
      box.high.maximize(points[v]);
    }
    boxes.push_back(box);
  }
  tree_ = BoxTree(boxes, context);
}

ClosestTriangle::Hit ClosestTriangle::closest(const Vec3& p, std::uint32_t hint) const {
  Hit best{0, closest_on_triangle(corners_[hint], p), hint};
  best.distance = (best.point - p).norm();
  tree_.search(
      p, [&] { return best.distance; },
      [&](std::uint32_t t) {
        const Vec3 point = closest_on_triangle(corners_[t], p);
        const double distance = (point - p).norm();
        // The lower index of two equally near: the answer does not depend on the hint.
        if (distance < best.distance || (distance == best.distance && t < best.triangle)) best = {distance, point, t};
      });
  return best;
}

}  // namespace tri

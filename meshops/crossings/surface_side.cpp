#include "meshops/crossings/surface_side.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/joining/joined_points.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/cancellable_sort.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

constexpr double on_edge = 1e-10;  // share of the triangle within which a point lies on its edge

std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
}

}  // namespace

SurfaceSide::SurfaceSide(std::span<const Vec3> points, std::span<const Triangle> triangles, const Context* context)
    : points_(points.begin(), points.end()), triangles_(triangles.begin(), triangles.end()),
      vertex_normals_(points.size(), Vec3(0, 0, 0)) {
  Pace pace(context);
  const std::vector<std::uint32_t> lowest = points_at_same_place(points_, context);
  struct Side {
    std::uint64_t key;
    std::uint32_t triangle;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles_.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    pace();
    Triangle& corners = triangles_[t];
    for (std::uint32_t& v : corners) v = lowest[v];
    const Vec3 normal =
        unit_or_zero((points_[corners[1]] - points_[corners[0]]) % (points_[corners[2]] - points_[corners[0]]));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = unit_or_zero(points_[corners[(k + 1) % 3]] - points_[corners[k]]);
      const Vec3 b = unit_or_zero(points_[corners[(k + 2) % 3]] - points_[corners[k]]);
      vertex_normals_[corners[k]] += normal * std::atan2((a % b).norm(), a | b);
      sides.push_back({key_of(corners[k], corners[(k + 1) % 3]), t});
    }
  }
  cancellable_sort(sides.begin(), sides.end(), context, [](const Side& a, const Side& b) {
    return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
  });
  for (const Side& side : sides) {
    pace();
    const Triangle& t = triangles_[side.triangle];
    const Vec3 normal = unit_or_zero((points_[t[1]] - points_[t[0]]) % (points_[t[2]] - points_[t[0]]));
    if (edges_.empty() || edges_.back().key != side.key)
      edges_.push_back({side.key, normal});
    else
      edges_.back().normal += normal;
  }
}

Vec3 SurfaceSide::normal(const ClosestTriangle::Hit& hit) const {
  const Triangle& t = triangles_[hit.triangle];
  for (const std::uint32_t v : t)
    if (points_[v] == hit.point) return vertex_normals_[v];
  const Vec3 area = (points_[t[1]] - points_[t[0]]) % (points_[t[2]] - points_[t[0]]);
  const double whole = area | area;
  std::size_t nearest = 0;
  double least = 2;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = points_[t[k]], &b = points_[t[(k + 1) % 3]];
    const double share = whole > 0 ? (((a - hit.point) % (b - hit.point)) | area) / whole : 0;
    if (share < least) least = share, nearest = k;
  }
  if (least > on_edge) return area;
  const std::uint64_t key = key_of(t[nearest], t[(nearest + 1) % 3]);
  const auto edge = std::lower_bound(edges_.begin(), edges_.end(), key,
                                     [](const Edge& e, std::uint64_t wanted) { return e.key < wanted; });
  return edge->normal;
}

double SurfaceSide::side(const Vec3& place, const ClosestTriangle::Hit& hit) const {
  return ((place - hit.point) | normal(hit)) < 0 ? -1 : 1;
}

}  // namespace tri

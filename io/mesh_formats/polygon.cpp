#include "io/mesh_formats/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/mesh_formats/mesh_formats.hpp"

namespace tri::io_detail {
namespace {

// Ear clipping takes quadratic time, and cubic time on outlines made to that end: beyond so many looks at a corner any
// ear will do.
constexpr std::size_t max_ear_clipping = 2000;
constexpr std::size_t max_looks = 20'000'000;

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

class EarClipper {
 public:
  enum class Result {
    fan,       // convex or degenerate: nothing was written
    clipped,   // size-2 triangles were written
    forced,    // as well, but some of them overlap or lie outside
    too_large  // nothing was written
  };

  Result run(std::span<const std::uint32_t> corners, const std::vector<Vec3>& points, Triangle* out) {
    const std::size_t n = corners.size();
    if (!project(corners, points)) return Result::fan;
    previous_.resize(n);
    next_.resize(n);
    bool convex = true;
    for (std::size_t i = 0; i < n; ++i) {
      previous_[i] = (i + n - 1) % n;
      next_[i] = (i + 1) % n;
      convex = convex && turn(flat_[previous_[i]], flat_[i], flat_[next_[i]]) >= 0;
    }
    // Turning left everywhere is convex only if the outline goes round once; a fan that nowhere turns right proves it.
    for (std::size_t i = 1; convex && i + 1 < n; ++i) convex = turn(flat_[0], flat_[i], flat_[i + 1]) >= 0;
    if (convex) return Result::fan;
    if (n > max_ear_clipping) return Result::too_large;

    std::size_t left = n;
    std::size_t at = 0;
    std::size_t tried = 0;
    bool forced = false;
    looks_ = 0;
    while (left > 3) {
      // After a full round without an ear (the outline crosses itself) any corner has to do.
      const bool force = tried >= left || looks_ > max_looks;
      if (force || is_ear(at)) {
        forced = forced || force;
        *out++ = {corners[previous_[at]], corners[at], corners[next_[at]]};
        next_[previous_[at]] = next_[at];
        previous_[next_[at]] = previous_[at];
        --left;
        tried = 0;
      } else {
        ++tried;
      }
      at = next_[at];
    }
    *out = {corners[previous_[at]], corners[at], corners[next_[at]]};
    forced = forced || turn(flat_[previous_[at]], flat_[at], flat_[next_[at]]) < 0;
    return forced ? Result::forced : Result::clipped;
  }

 private:
  bool project(std::span<const std::uint32_t> corners, const std::vector<Vec3>& points) {
    const std::size_t n = corners.size();
    const Vec3 origin = points[corners[0]];
    Vec3 normal(0, 0, 0);
    for (std::size_t i = 1; i + 1 < n; ++i) normal += (points[corners[i]] - origin) % (points[corners[i + 1]] - origin);
    // Dropping the axis along which the polygon is thinnest keeps every sign of turn that the mean plane gives.
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    if (!(std::abs(normal[axis]) > 0) || !std::isfinite(normal[axis])) return false;
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    const double sign = normal[axis] > 0 ? 1 : -1;
    flat_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 d = points[corners[i]] - origin;
      flat_[i] = Vec2(sign * d[u], d[v]);
    }
    return true;
  }

  bool is_ear(std::size_t at) {
    const Vec2& a = flat_[previous_[at]];
    const Vec2& b = flat_[at];
    const Vec2& c = flat_[next_[at]];
    if (!(turn(a, b, c) > 0)) return false;
    for (std::size_t i = next_[next_[at]]; i != previous_[at]; i = next_[i]) {
      const Vec2& p = flat_[i];
      ++looks_;
      if (p == a || p == b || p == c) continue;  // the two sides of a slit share points
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::vector<Vec2> flat_;
  std::vector<std::size_t> previous_, next_;
  std::size_t looks_ = 0;
};

}  // namespace

std::size_t PolygonCollector::add(std::span<const std::uint32_t> corners) {
  const std::size_t n = corners.size();
  if (n < 3) {
    ++too_small_;
    return 0;
  }
  ++faces_;
  if (n > 3) {
    polygons_.push_back({triangles_.size(), corners_.size(), n});
    corners_.insert(corners_.end(), corners.begin(), corners.end());
  }
  for (std::size_t i = 1; i + 1 < n; ++i) triangles_.push_back({corners[0], corners[i], corners[i + 1]});
  return n - 2;
}

std::size_t PolygonCollector::add(std::span<const std::uint32_t> corners, std::span<const double> values,
                                  std::size_t columns) {
  const std::size_t first_triangle = triangles_.size(), first_corner = corners_.size();
  const std::size_t made = add(corners);
  if (made == 0 || values.empty()) return made;
  columns_ = columns;
  valued_.push_back({first_triangle, first_corner, corners.size(), values_.size()});
  values_.insert(values_.end(), values.begin(), values.end());
  return made;
}

void PolygonCollector::place_corner_values(Soup& soup) const {
  if (valued_.empty() || names_.empty()) return;
  std::vector<std::vector<double>*> lists;
  for (const std::string& name : names_) {
    lists.push_back(&soup.corner_scalars[name]);
    lists.back()->assign(3 * soup.triangles.size(), std::numeric_limits<double>::quiet_NaN());
  }
  for (const Valued& face : valued_) {
    for (std::size_t i = 0; i + 2 < face.size; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        std::size_t place = k;
        if (face.size > 3) {
          const auto begin = corners_.begin() + static_cast<std::ptrdiff_t>(face.first_corner);
          place = static_cast<std::size_t>(std::find(begin, begin + static_cast<std::ptrdiff_t>(face.size),
                                                     soup.triangles[face.first_triangle + i][k]) -
                                           begin);
        }
        for (std::size_t c = 0; c < lists.size(); ++c)
          (*lists[c])[3 * (face.first_triangle + i) + k] = values_[face.first_value + place * columns_ + c];
      }
    }
  }
}

void PolygonCollector::finish(Soup& soup, MeshFileInfo& info, Context& context) {
  EarClipper clipper;
  std::uint64_t large = 0, forced = 0;
  for (std::size_t i = 0; i < polygons_.size(); ++i) {
    if (i % 1024 == 0) context.checkpoint();
    const Polygon& polygon = polygons_[i];
    const auto result = clipper.run({corners_.data() + polygon.first_corner, polygon.size}, soup.points,
                                    triangles_.data() + polygon.first_triangle);
    large += result == EarClipper::Result::too_large;
    forced += result == EarClipper::Result::forced;
  }
  soup.triangles = std::move(triangles_);
  place_corner_values(soup);
  info.polygons = faces_;
  info.polygons_split = polygons_.size();
  if (large > 0)
    info.notes.push_back(fmt::format("{} concave polygons of more than {} corners were cut into fans, which overlap",
                                     large, max_ear_clipping));
  if (forced > 0)
    info.notes.push_back(
        fmt::format("{} polygons whose outline crosses itself were cut into triangles that overlap", forced));
  if (too_small_ > 0)
    info.notes.push_back(fmt::format("{} faces of fewer than three corners (points, edges) were left out", too_small_));
}

}  // namespace tri::io_detail

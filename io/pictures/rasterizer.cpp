#include "io/pictures/rasterizer.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr double margin = 0.04;                           // of the image, left free on each side
constexpr double distance_in_radii = 3.8637033051562732;  // 1 / sin(15 degrees): a view of 30 degrees across

struct Box2 {
  double min_x = std::numeric_limits<double>::infinity(), max_x = -min_x;
  double min_y = min_x, max_y = -min_x;
  void add(double x, double y) {
    min_x = std::min(min_x, x), max_x = std::max(max_x, x);
    min_y = std::min(min_y, y), max_y = std::max(max_y, y);
  }
};

double cross(const ScreenPoint& a, const ScreenPoint& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

// The samples whose middles lie in [low, high], cut to [begin, end).
struct Span {
  int begin, end;
};
Span span(double low, double high, int begin, int end) {
  const double first = std::clamp(std::ceil(low - 0.5), double(begin), double(end));
  const double last = std::clamp(std::floor(high - 0.5) + 1, double(begin), double(end));
  return {static_cast<int>(first), static_cast<int>(last)};
}

// One tile: the nearest element at each of its samples.
class Tile {
 public:
  Tile(int left, int top, int right, int bottom)
      : left_(left), top_(top), right_(right), bottom_(bottom),
        closest_(std::size_t(right - left) * std::size_t(bottom - top), -std::numeric_limits<double>::infinity()),
        id_(closest_.size(), Sample::nothing) {}

  void triangle(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, std::uint32_t id) {
    const double area = cross(a, b, c.x, c.y);
    if (area == 0) return;
    const Span rows = span(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), top_, bottom_);
    const Span columns = span(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), left_, right_);
    for (int row = rows.begin; row < rows.end; ++row) {
      const double y = row + 0.5;
      for (int column = columns.begin; column < columns.end; ++column) {
        const double x = column + 0.5;
        const double u = cross(b, c, x, y) / area, v = cross(c, a, x, y) / area, w = cross(a, b, x, y) / area;
        if (u >= 0 && v >= 0 && w >= 0) offer(column, row, u * a.closeness + v * b.closeness + w * c.closeness, id);
      }
    }
  }

  void dot(const ScreenPoint& p, double radius, std::uint32_t id) {
    const Span rows = span(p.y - radius, p.y + radius, top_, bottom_);
    const Span columns = span(p.x - radius, p.x + radius, left_, right_);
    for (int row = rows.begin; row < rows.end; ++row)
      for (int column = columns.begin; column < columns.end; ++column)
        if (std::hypot(column + 0.5 - p.x, row + 0.5 - p.y) <= radius) offer(column, row, p.closeness, id);
  }

  template <class Visit>
  void visit(const Visit& visitor) const {
    std::size_t i = 0;
    for (int row = top_; row < bottom_; ++row)
      for (int column = left_; column < right_; ++column, ++i)
        if (id_[i] != Sample::nothing) visitor(column, row, id_[i]);
  }

 private:
  void offer(int column, int row, double closeness, std::uint32_t id) {
    const std::size_t i = std::size_t(row - top_) * std::size_t(right_ - left_) + std::size_t(column - left_);
    if (closeness > closest_[i]) closest_[i] = closeness, id_[i] = id;
  }

  int left_, top_, right_, bottom_;
  std::vector<double> closest_;
  std::vector<std::uint32_t> id_;
};

// Which elements may show in which tile, in ascending order within each tile.
struct Bins {
  std::vector<std::size_t> offset;  // tiles + 1
  std::vector<std::uint32_t> elements;
};

template <class BoundsOf>
Bins sort_into_tiles(std::size_t count, int columns, int rows, int tile, const BoundsOf& bounds_of) {
  const auto each_tile = [&](std::size_t i, const auto& visit) {
    const Box2 box = bounds_of(i);
    const auto cell = [&](double v, int cells) { return int(std::clamp(std::floor(v / tile), -1.0, double(cells))); };
    const int left = std::max(cell(box.min_x, columns), 0), right = std::min(cell(box.max_x, columns), columns - 1);
    const int top = std::max(cell(box.min_y, rows), 0), bottom = std::min(cell(box.max_y, rows), rows - 1);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) visit(std::size_t(y) * std::size_t(columns) + std::size_t(x));
  };
  Bins bins;
  bins.offset.assign(std::size_t(columns) * std::size_t(rows) + 1, 0);
  for (std::size_t i = 0; i < count; ++i) each_tile(i, [&](std::size_t t) { ++bins.offset[t + 1]; });
  for (std::size_t t = 1; t < bins.offset.size(); ++t) bins.offset[t] += bins.offset[t - 1];
  bins.elements.resize(bins.offset.back());
  std::vector<std::size_t> next(bins.offset.begin(), bins.offset.end() - 1);
  for (std::size_t i = 0; i < count; ++i)
    each_tile(i, [&](std::size_t t) { bins.elements[next[t]++] = static_cast<std::uint32_t>(i); });
  return bins;
}

}  // namespace

Camera::Camera(const CameraSettings& settings, const std::vector<Vec3>& points,
               const std::vector<std::uint32_t>& framed)
    : perspective_(settings.perspective) {
  if (framed.empty()) throw InvalidInput("there is nothing to draw");
  const double length = settings.view.norm();
  if (!(length > 0) || !std::isfinite(length)) throw InvalidInput("the view has no direction");
  z_ = settings.view / length;
  x_ = settings.up % z_;
  if (!(x_.norm() > 1e-6 * settings.up.norm())) x_ = Vec3(0, 1, 0) % z_;
  if (x_.norm() < 1e-6) x_ = Vec3(1, 0, 0) % z_;
  x_.normalize();
  y_ = z_ % x_;

  Vec3 low = points[framed[0]], high = low;
  for (const std::uint32_t i : framed) {
    low.minimize(points[i]);
    high.maximize(points[i]);
  }
  origin_ = low * 0.5 + high * 0.5;
  const double radius = (high - low).norm() / 2;
  distance_ = radius > 0 ? distance_in_radii * radius : 1;

  Box2 box;
  for (const std::uint32_t i : framed) {
    const Vec3 p = in_view(points[i]);
    box.add(p[0], p[1]);
  }
  const double usable = 1 - 2 * margin;
  const double wide = box.max_x - box.min_x, tall = box.max_y - box.min_y;
  const double fit = std::min(wide > 0 ? usable * settings.width / wide : std::numeric_limits<double>::infinity(),
                              tall > 0 ? usable * settings.height / tall : std::numeric_limits<double>::infinity());
  scale_ = settings.zoom * (std::isfinite(fit) ? fit : 1);
  Vec3 middle((box.min_x + box.max_x) / 2, (box.min_y + box.max_y) / 2, 0);
  if (settings.center) middle = in_view(*settings.center);
  shift_x_ = settings.width / 2.0 - scale_ * middle[0];
  shift_y_ = settings.height / 2.0 + scale_ * middle[1];
  if (!std::isfinite(shift_x_) || !std::isfinite(shift_y_) || !std::isfinite(scale_))
    throw InvalidInput("the view cannot be framed: zoom or center is too large");
}

Vec3 Camera::in_view(const Vec3& point) const {
  const Vec3 d = point - origin_;
  const double depth = d | z_;
  const double shrink = perspective_ ? distance_ / (distance_ - depth) : 1;
  return {(d | x_) * shrink, (d | y_) * shrink, depth};
}

ScreenPoint Camera::project(const Vec3& point) const {
  const Vec3 p = in_view(point);
  const double weight = perspective_ ? 1 / (distance_ - p[2]) : 1;
  return {shift_x_ + scale_ * p[0], shift_y_ - scale_ * p[1], perspective_ ? weight : p[2], weight};
}

Vec3 Camera::toward_camera(const Vec3& point) const {
  if (!perspective_) return z_;
  return (origin_ + z_ * distance_ - point).normalized();
}

void rasterize(const std::vector<ScreenPoint>& points, const std::vector<Triangle>& triangles, int width, int height,
               int tile, double dot_radius, Context& context,
               const std::function<void(int column, int row, const Sample& sample)>& paint) {
  const bool dots = triangles.empty();
  const int columns = (width + tile - 1) / tile, rows = (height + tile - 1) / tile;
  const Bins bins = sort_into_tiles(dots ? points.size() : triangles.size(), columns, rows, tile, [&](std::size_t i) {
    Box2 box;
    if (dots) {
      box.add(points[i].x - dot_radius, points[i].y - dot_radius);
      box.add(points[i].x + dot_radius, points[i].y + dot_radius);
    } else {
      for (const std::uint32_t v : triangles[i]) box.add(points[v].x, points[v].y);
    }
    return box;
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bins.offset.size() - 1, 1), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      context.checkpoint();
      if (bins.offset[t] == bins.offset[t + 1]) continue;
      const int left = int(t % std::size_t(columns)) * tile, top = int(t / std::size_t(columns)) * tile;
      Tile samples(left, top, std::min(left + tile, width), std::min(top + tile, height));
      for (std::size_t k = bins.offset[t]; k < bins.offset[t + 1]; ++k) {
        const std::uint32_t id = bins.elements[k];
        if (dots) {
          samples.dot(points[id], dot_radius, id);
        } else {
          const Triangle& corners = triangles[id];
          samples.triangle(points[corners[0]], points[corners[1]], points[corners[2]], id);
        }
      }
      samples.visit([&](int column, int row, std::uint32_t id) {
        Sample sample{id, {1, 0, 0}, column + 0.5, row + 0.5};
        if (!dots) {
          const ScreenPoint& a = points[triangles[id][0]];
          const ScreenPoint& b = points[triangles[id][1]];
          const ScreenPoint& c = points[triangles[id][2]];
          const double u = cross(b, c, sample.x, sample.y) * a.weight, v = cross(c, a, sample.x, sample.y) * b.weight,
                       w = cross(a, b, sample.x, sample.y) * c.weight;
          sample.barycentric[0] = u / (u + v + w);
          sample.barycentric[1] = v / (u + v + w);
          sample.barycentric[2] = w / (u + v + w);
        }
        paint(column, row, sample);
      });
    }
  });
}

}  // namespace tri

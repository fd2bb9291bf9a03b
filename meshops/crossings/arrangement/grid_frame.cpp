#include "meshops/crossings/arrangement/grid_frame.hpp"

#include <algorithm>
#include <cmath>

namespace tri {

GridFrame::GridFrame(const Soup& soup, int finest) {
  if (soup.triangles.empty()) return;
  Vec3 low = soup.points[soup.triangles[0][0]], high = low;
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) low.minimize(soup.points[v]), high.maximize(soup.points[v]);
  const Vec3 size = high - low;
  const double extent = extent_ = std::max({size[0], size[1], size[2]});
  double farthest = 0;
  for (int k = 0; k < 3; ++k) farthest = std::max({farthest, std::abs(low[k]), std::abs(high[k])});
  if (farthest == 0) return;
  int exponent = std::ilogb(farthest) - finest;  // two steps of room for the rounding below
  if (extent > 0) exponent = std::max(exponent, std::ilogb(extent * (1 + 0x1p-26)) + 1 - grid_bits);
  exponent = std::max(exponent, -1000);
  step_ = std::ldexp(1.0, exponent);
  for (int k = 0; k < 3; ++k) origin_[k] = std::floor(low[k] / step_) * step_;
}

double GridFrame::steps_in(double share) const {
  return extent_ > 0 ? std::max(2.0, share * std::ldexp(1, std::ilogb(extent_) + 1) / step_) : 2;
}

GridPoint GridFrame::to_grid(const Vec3& p) const {
  GridPoint g;
  for (int k = 0; k < 3; ++k) g[k] = static_cast<std::int64_t>(std::floor((p[k] - origin_[k]) / step_ + 0.5));
  return g;
}

Vec3 GridFrame::to_space(const GridPoint& p) const {
  Vec3 x;
  for (int k = 0; k < 3; ++k) x[k] = origin_[k] + static_cast<double>(p[k]) * step_;
  return x;
}

}  // namespace tri

#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "meshops/vec.hpp"

namespace tri {

/// One triangle, to be compared with many boxes: separating axes [Gottschalk, Lin & Manocha 1996; Akenine-Möller 2001],
/// of which all that depends on the triangle is computed once.
class TriangleBox {
 public:
  /// @param corners  finite; the triangle may be degenerate
  explicit TriangleBox(const std::array<Vec3, 3>& corners) {
    low_ = high_ = corners[0];
    for (const Vec3& p : corners) low_.minimize(p), high_.maximize(p);
    for (int k = 0; k < 3; ++k) reach_ = std::max({reach_, std::abs(low_[k]), std::abs(high_[k])});
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 edge = corners[(i + 1) % 3] - corners[i];
      for (std::size_t k = 0; k < 3; ++k) {
        Axis& axis = axes_[3 * i + k];
        axis = {edge[(k + 1) % 3], edge[(k + 2) % 3], 0, 0};
        // The product of the edge with direction k, which no coordinate k enters.
        const auto along = [&](const Vec3& p) { return axis.x * p[(k + 2) % 3] - axis.y * p[(k + 1) % 3]; };
        axis.low = std::min({along(corners[0]), along(corners[1]), along(corners[2])});
        axis.high = std::max({along(corners[0]), along(corners[1]), along(corners[2])});
        const double slack = 1e-14 * reach_ * (std::abs(axis.x) + std::abs(axis.y)) + underflow;
        axis.low -= slack;
        axis.high += slack;
      }
    }
    const Vec3 size = high_ - low_;
    square_ = (size[0] + size[1] + size[2]) * (size[0] + size[1] + size[2]);
    normal_ = (corners[1] - corners[0]) % (corners[2] - corners[0]);
    level_ = normal_ | corners[0];
    slack_ =
        1e-14 * reach_ * (std::abs(normal_[0]) + std::abs(normal_[1]) + std::abs(normal_[2]) + square_) + underflow;
  }

  /// False only if the box and the triangle have no point in common; true also where they are apart by less than the
  /// rounding of a few operations.
  bool may_meet(const Vec3& low, const Vec3& high) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > high_[k] || high[k] < low_[k]) return false;
    // What of the box is within the triangle's own: as good, and no larger than what the slack below is for.
    Vec3 center, half;
    for (int k = 0; k < 3; ++k) {
      const double l = std::max(low[k], low_[k]), h = std::min(high[k], high_[k]);
      center[k] = 0.5 * (l + h);
      half[k] = 0.5 * (h - l);
    }
    if (std::abs((normal_ | center) - level_) >
        std::abs(normal_[0]) * half[0] + std::abs(normal_[1]) * half[1] + std::abs(normal_[2]) * half[2] + slack_)
      return false;
    for (std::size_t i = 0; i < 9; ++i) {
      const Axis& axis = axes_[i];
      const std::size_t k = i % 3, u = (k + 1) % 3, v = (k + 2) % 3;
      const double at = axis.x * center[v] - axis.y * center[u];
      const double r = std::abs(axis.x) * half[v] + std::abs(axis.y) * half[u];
      if (at + r < axis.low || at - r > axis.high) return false;
    }
    return true;
  }

  /// True only if the three places are strictly on one side of the triangle's plane; false as well where that is not
  /// sure.
  bool beside(const std::array<Vec3, 3>& places) const {
    double reach = reach_, least = 0, most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double at = (normal_ | places[i]) - level_;
      least = i == 0 ? at : std::min(least, at);
      most = i == 0 ? at : std::max(most, at);
      for (int k = 0; k < 3; ++k) reach = std::max(reach, std::abs(places[i][k]));
    }
    const double slack =
        1e-14 * reach * (std::abs(normal_[0]) + std::abs(normal_[1]) + std::abs(normal_[2]) + square_) + underflow;
    return least > slack || most < -slack;
  }

 private:
  static constexpr double underflow = 1e-290;  ///< far above what products lose that are too small for a double
  struct Axis {
    double x, y, low, high;
  };
  Vec3 low_, high_, normal_;
  double reach_ = 0, level_ = 0, slack_ = 0;
  double square_ = 0;  ///< of its extent: the normal's coordinates are wrong by a rounding of that
  std::array<Axis, 9> axes_;
};

}  // namespace tri

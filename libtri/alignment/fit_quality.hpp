#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libtri/alignment/exact_fit.hpp"

namespace tri {

/// How well points lie on the model at one pose.
struct FitQuality {
  double sigma = 0;         ///< mm, 1.4826 times the median distance
  double median = 0;        ///< mm, of the distances
  double rms = 0;           ///< mm, of the inliers
  double inlier_share = 0;  ///< of the points within 4.685 sigma
  double near_share = 0;    ///< of the points within 0.5% of the size
  /// Share of the points that lie farther off than 4.685 sigma and 5e-4 of the size together with most of their
  /// neighbours, on the same side. Single wild points are not counted: this is a wrong pose, a bent part or something
  /// that is not on the model.
  double coherent_share = 0;
  /// mm: rms of what neighbours deviate in common; noise cancels.
  double systematic = 0;
  /// Of an inlier's deviation with its neighbours', in [0, 1): 0 for noise; near 1 the deviations are the part's form.
  double correlation = 0;
};

/// For each point its four nearest others; itself in place of those that are missing or much farther away than usual.
using Neighbourhood = std::vector<std::array<std::uint32_t, 4>>;
/// The neighbourhood of each of `points`, in their order. @throws Cancelled
Neighbourhood neighbourhood(std::span<const Vec3> points, const Context& context);

/// What shares like 0.5% below are taken of: the model's diagonal, or three times a small scan's radius.
inline double fit_size(double diagonal, double scan_radius) {
  return std::min(diagonal, 3 * scan_radius);
}

/// @param residuals  one a point; @param size mm, as `fit_size`
FitQuality fit_quality(std::span<const PointResidual> residuals, const Neighbourhood& neighbours, double size);

}  // namespace tri

#pragma once

#include <span>
#include <vector>

#include "libtri/alignment/exact_fit.hpp"
#include "libtri/alignment/fit_quality.hpp"
#include "libtri/alignment/pose_search.hpp"

namespace tri {

/// Some of the points, for comparing poses.
struct PointSample {
  std::vector<Vec3> points, normals;  ///< normals may be empty
};

/// At most `count` of the points in their order. @param normals may be empty
PointSample sample_points(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t count,
                          std::uint64_t seed);

/// A pose refined on the exact model and judged.
struct Candidate {
  Pose pose;
  bool start = false;  ///< came from a start and not from the search
  int steps = 0;
  double loss = 0;  ///< in [0, 1], mean over the points; the share of outliers where the rest fits
  double z = 0;     ///< standard errors by which the loss is above the best one's, point by point
  FitQuality quality;
  std::vector<PointResidual> residuals;
};

/// Refines coarse poses on the exact model, drops those clearly worse, and compares the others on the same points. The
/// best is tried again from poses beside it, along the motions that the points fix least.
///
/// @param starts  poses that stay to the end, whatever their fit
/// @return best first, no two of them the same pose; the loss of each point is (value / 3 sigma)^2, at most 1, with the
///         least sigma of all
std::vector<Candidate> refine_candidates(const FitTarget& target, std::span<const CoarsePose> coarse,
                                         std::span<const Pose> starts, const PointSample& sample, const Vec3& centre,
                                         double radius, const Context& context);

}  // namespace tri

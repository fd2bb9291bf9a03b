#pragma once

#include "libtri/alignment/candidates.hpp"
#include "libtri/alignment/information.hpp"
#include "libtri/alignment/rim.hpp"

namespace tri {

struct RimFit {
  Pose pose;
  int motions = 0;   ///< that the rim stops on both sides
  double moved = 0;  ///< mm, rms over the points
};

/// Moves points along the motions that their distances to the surface fix badly or not at all, to where the rim of the
/// model lets them: no point of a face lies beyond its rim. First those that hang over are drawn in; then, where the
/// rim stops a motion on both sides, the pose goes to the middle of what is left, the mean of the posterior under the
/// assumption that measured points are spread evenly and lie inside the faces. With n points along a rim that is nearer
/// to the truth than any place at the border, by a factor of about the square root of n [cf. the midrange of uniform
/// samples]. A point far over the rim counts as wild and costs no more than a limit.
///
/// @param equations  of the points at `start`, without those on edges @param sigma  mm, of the noise
/// @param limit      mm: motions with a larger standard deviation are badly fixed
RimFit fit_to_rim(const Rim& rim, const FitTarget& target, const PointSample& sample, const Pose& start,
                  const NormalEquations& equations, double sigma, double limit, Context& context);

}  // namespace tri

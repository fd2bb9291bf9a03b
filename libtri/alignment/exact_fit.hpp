#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libtri/alignment/pose.hpp"
#include "libtri/registration.hpp"
#include "meshops/context.hpp"

namespace tri {

/// How far one posed point is off, and which way.
struct PointResidual {
  Vec3 at{0, 0, 0};         ///< the point, posed
  Vec3 foot{0, 0, 0};       ///< nearest place on the model
  Vec3 direction{0, 0, 0};  ///< unit, the gradient of `value`: outward
  double value = 0;         ///< mm, signed distance to the model, or to its offset by the probe's radius
  std::int32_t face = -1;   ///< 0-based position in CadModel::faces; -1 if the point is not finite
  bool on_edge = false;     ///< the foot lies on a trimming curve
  bool opposed = false;     ///< the point's normal faces away from the foot's
};

/// What the residuals are measured against.
struct FitTarget {
  const Registration& registration;  ///< of the model; outlives this
  double diagonal = 1;               ///< mm, of the model
  double probe_radius = 0;           ///< mm, >= 0: the points are centres of a ball that touched the part

  /// Closest points on the exact trimmed model. With a probe radius, the side of the surface is the one most points lie
  /// on.
  /// @param normals  of the points, before the pose; empty, or one each ((0,0,0): unknown). They count only if four
  ///                 fifths of them agree on which side is outside, or on its opposite.
  std::vector<PointResidual> residuals(std::span<const Vec3> points, std::span<const Vec3> normals, const Pose& pose,
                                       Context& context) const;
};

/// 1.4826 times the median of |value|: the standard deviation where errors are Gaussian. Opposed points count as far.
/// @param diagonal  mm; the result is not below 1e-9 of it
double robust_sigma(std::span<const PointResidual> residuals, double diagonal);

/// Tukey's biweight at 4.685 `sigma`: 95% as efficient as least squares where errors are Gaussian [Huber 1981].
double tukey_weight(double value, double sigma);

/// What is minimised.
enum class Metric {
  plane,  ///< squared distance along the surface's normal [Chen & Medioni 1992]: a few steps
  point,  ///< squared distance to the closest point, solved by SVD [Ristic et al. 2000; Besl & McKay 1992]: many steps
};

/// How a pose is refined: kernels from wide to narrow, then Tukey's weights until it stands still.
struct RefineOptions {
  Metric metric = Metric::plane;  ///< what is least
  double first_kernel = 0;        ///< mm: scale of a Geman-McClure kernel in the first step; 0: Tukey from the start
  double last_kernel = 0;         ///< mm: its scale in the last of the kernel's steps
  int kernel_steps = 0;           ///< steps in which the kernel shrinks from the first to the last scale; 0: none
  int max_steps = 30;             ///< with Tukey's weights
  double tolerance = 0;           ///< mm: a step that moves the points less (rms) is the last
  double keep = 1;                ///< share of the points that count, those with the least residuals, in (0, 1]
};

/// A pose, and what is left of the distances.
struct Refined {
  Pose pose;                             ///< takes the points to the model
  int steps = 0;                         ///< that were taken
  bool converged = false;                ///< the last step moved the points by less than the tolerance
  std::vector<PointResidual> residuals;  ///< before the last step, which was below the tolerance if converged
};

/// Iterated closest points on the exact trimmed model from `start` on.
///
/// Weights are Geman & McClure's with a shrinking kernel, then Tukey's with a robust standard deviation. Motions that
/// the points do not fix are left as they are. The same for any number of threads. @throws Cancelled after every step
Refined refine_pose(const FitTarget& target, std::span<const Vec3> points, std::span<const Vec3> normals,
                    const Pose& start, const RefineOptions& options, Context& context);

}  // namespace tri

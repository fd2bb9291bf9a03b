#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libtri/alignment/pose.hpp"
#include "libtri/alignment/sample_field.hpp"
#include "libtri/alignment/scan_normals.hpp"

namespace tri {

/// A pose found on samples of the model.
struct CoarsePose {
  Pose pose;
  int orientation = 0;  ///< as PairPose
  double score = 0;     ///< in [0, 1]: share of the points that lie on the samples, softly
};

struct PoseSearchOptions {
  double diagonal = 1;      ///< mm, of the model
  double probe_radius = 0;  ///< mm: the points lie so far beside the model
  std::size_t count = 16;   ///< poses returned, at most
  std::uint64_t seed = 1;
};

/// Poses of a scan from nothing, best first.
///
/// Poses from pairs of points are scored by the share of points near samples of the model with like normals, in three
/// rounds with more points and fewer poses; those left that differ are refined with a Geman-McClure kernel whose scale
/// anneals from 0.05 to 0.004 of the diagonal, then again from jittered copies, since a thin wall holds a pose on its
/// wrong side. `starts` are refined beside them whatever their score.
std::vector<CoarsePose> search_poses(const ScanSubset& scan, const SurfaceSamples& samples,
                                     std::span<const Pose> starts, const PoseSearchOptions& options,
                                     const Context& context);

/// The largest distance (mm) between where two poses take the corners of a box of half size `radius` about `centre`.
double pose_distance(const Pose& a, const Pose& b, const Vec3& centre, double radius);

}  // namespace tri

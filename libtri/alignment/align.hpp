#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libtri/alignment/fit_quality.hpp"
#include "libtri/alignment/information.hpp"
#include "libtri/alignment/pose.hpp"
#include "libtri/model/cad_model.hpp"
#include "libtri/registration.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Where the search for a pose begins.
enum class AlignMode {
  automatic,  ///< from nothing, unless the points already lie on the model or a start is given
  icp,        ///< refinement from the start, or from the points as they are
  none,       ///< the start, or the points as they are; only measured
};

/// "auto", "icp" or "none". @throws InvalidInput for any other name.
AlignMode align_mode(std::string_view name);

/// How a pose is sought, and how residuals are weighed.
struct AlignOptions {
  AlignMode mode = AlignMode::automatic;  ///< where the search begins
  std::optional<Pose> start;              ///< where refinement begins; nothing is searched then
  Metric metric = Metric::plane;          ///< what is least in the refinement
  double keep = 1;          ///< share of the points that count in each step, in (0, 1]; Tukey's weights act in any case
  double probe_radius = 0;  ///< mm, >= 0: the points are centres of a ball of this radius that touched the part
  std::uint64_t seed = 1;   ///< of every random choice
  /// The last steps use at most so many points, >= 1000, drawn at random: the pose's standard deviation falls with the
  /// square root of their number, and with 200,000 is below 1% of the noise in every direction that the points fix.
  std::size_t most_points = 200000;
};

/// How far the pose can be relied on.
enum class AlignStatus {
  good,       ///< one pose, clearly better than all others found
  ambiguous,  ///< it fits, but other poses fit as well, or a motion is not fixed, or part of the points does not lie on
              ///< it
  failed,     ///< the points do not fit the model
};
/// "good", "ambiguous" or "failed", as in reports.
const char* name_of(AlignStatus status);

/// A pose that fits as well as the one chosen, within the noise.
struct Alternative {
  Pose pose;            ///< takes the points to the model
  Pose motion;          ///< of the model, from the chosen pose to this one
  std::string words;    ///< the motion, for a person
  FitQuality quality;   ///< of this pose
  double coverage = 0;  ///< share of the model's area near which there are points in this pose
};

/// The pose that was found, how well it fits, and what else would.
struct AlignResult {
  Pose pose;                                 ///< takes the points to the model; the identity bit for bit if `kept`
  AlignStatus status = AlignStatus::failed;  ///< failed unless the points fit
  std::vector<std::string> reasons;          ///< why it is not good, one sentence each, with numbers
  std::vector<std::string> notes;            ///< what else a person should know
  bool kept = false;            ///< the points already lay on the model, and refinement is no better by more than noise
  bool searched = false;        ///< poses from nothing were tried
  int iterations = 0;           ///< of the refinement of the chosen pose
  FitQuality quality;           ///< of the chosen pose
  double coverage = 0;          ///< share of the model's area near which there are points
  PoseInformation information;  ///< what the points fix of the chosen pose
  std::vector<Alternative> alternatives;  ///< fit as well, best first; free motions are not repeated here
  double unit_factor = 1;                 ///< not 1: the points fit when multiplied by this, so their unit is another
  std::uint64_t points_used = 0;          ///< in the last steps
  std::vector<std::pair<std::string, double>> seconds;  ///< per step, in order
};

/// The rigid motion that takes measured points to a model [Ristic et al. 2000, step (a)].
///
/// Automatic: if the points as they are lie on the model, they are refined from there and nothing else is tried; by
/// chance points do not lie on a model. Otherwise poses are searched from nothing (pose_search.hpp), refined on the
/// exact trimmed faces and compared point by point; those that noise cannot tell apart are listed, and the motions that
/// the points do not fix named. A small residual alone proves nothing: the pose is good only if no other found explains
/// the points as well, and those far off are single ones and no regions.
///
/// Where the distances fix a motion badly or not at all, points are drawn back from over the rim of the model, and if
/// the rim stops the motion on both sides, the pose goes to the middle of what it allows (rim_fit.hpp): the motion is
/// still named as not fixed by the surface.
///
/// Where the points were already on the model and refinement lowers the mean squared distance by less than a twentieth
/// or by what chance gives (chi-squared of six degrees, 1e-5; deviations that neighbours share count as fewer points),
/// the identity is kept exactly.
///
/// The same seed gives the same pose for any number of threads.
/// @param points   mm, at least 3
/// @param normals  of the points, any side outward; empty, or one each ((0,0,0): unknown)
/// @return also where the points do not fit: `status` says so. The pose is then the best found.
/// @throws InvalidInput if an option is out of range, a coordinate is not finite, or there are fewer than 3 distinct
/// points.
/// @throws Cancelled within a fraction of a second after `context.cancel()`
AlignResult align(const CadModel& model, const Registration& registration, std::span<const Vec3> points,
                  std::span<const Vec3> normals, const AlignOptions& options, Context& context);

}  // namespace tri

#include "libtri/alignment/align.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libtri/alignment/candidates.hpp"
#include "libtri/alignment/pose_search.hpp"
#include "libtri/alignment/rim_fit.hpp"
#include "libtri/alignment/verdict.hpp"
#include "libtri/quiet_context.hpp"
#include "meshops/error.hpp"
#include "meshops/search/nearest_points.hpp"

namespace tri {
namespace {

constexpr std::size_t model_samples = 20000, coverage_samples = 2000;
constexpr std::size_t subset_size = 4000;  // measured points for the search
constexpr std::size_t sample_size = 5000;  // measured points for the comparison of poses
// Points lie on the model as they are: median distance, and how much worse than refined.
constexpr double in_place_distance = 5e-3;   // of the diagonal
constexpr double in_place_ratio = 3;         // of sigma, as they are over refined
constexpr double in_place_move = 0.01;       // of the diagonal
constexpr std::size_t in_place_points = 50;  // fewer may lie on a model by chance
// Standard deviation, of the diagonal: a motion that is named as badly fixed, and one that the rim may fix better. What
// the points near edges do to a pose is not in the standard deviation, and was seen to be four times as large.
constexpr double weak_motion = 6e-5, loose_motion = 1e-4;
constexpr double no_gain = 0.05;          // of the mean squared distance
constexpr double chance_gain = 35;        // chi-squared of six degrees of freedom, 1e-5: 33.1
constexpr double no_move = 1e-6;          // of the diagonal
constexpr double final_tolerance = 1e-6;  // of the diagonal
constexpr int final_steps = 12, point_steps = 400, settle_steps = 2;
constexpr double equal_z = 4;  // standard errors
constexpr std::size_t most_alternatives = 12;
constexpr double too_large = 1.3, too_small = 0.2, unit_low = 0.35, unit_high = 1.2;  // scan over model, by radius
constexpr double unit_factors[] = {25.4, 1 / 25.4, 1000, 1e-3, 10, 0.1, 100, 0.01, 304.8, 1 / 304.8};

void validate(std::span<const Vec3> points, std::span<const Vec3> normals, const AlignOptions& o) {
  if (!(o.keep > 0 && o.keep <= 1))
    throw InvalidInput(fmt::format("align: keep is {}; allowed: above 0, at most 1", o.keep));
  if (!(o.probe_radius >= 0 && std::isfinite(o.probe_radius)))
    throw InvalidInput(fmt::format("align: the probe's radius is {}; allowed: 0 or more mm", o.probe_radius));
  if (o.most_points < 1000)
    throw InvalidInput(fmt::format("align: most_points is {}; allowed: 1000 or more", o.most_points));
  if (!normals.empty() && normals.size() != points.size())
    throw InvalidInput(fmt::format("align: {} normals for {} points", normals.size(), points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::isfinite(points[i].sqrnorm()))
      throw InvalidInput(fmt::format("point {} has a coordinate that is not finite", i));
  std::size_t distinct = points.empty() ? 0 : 1;
  Vec3 other = points.empty() ? Vec3(0, 0, 0) : points[0];
  for (const Vec3& p : points) {
    if (distinct >= 3) break;
    if (p == points[0] || p == other) continue;
    other = p;
    ++distinct;
  }
  if (distinct < 3)
    throw InvalidInput(fmt::format("{} distinct points are too few for a pose: 3 are needed", distinct));
}

class Alignment {
 public:
  Alignment(const CadModel& model, const Registration& registration, std::span<const Vec3> points,
            std::span<const Vec3> normals, const AlignOptions& options, Context& context)
      : model_(model), points_(points), normals_(normals), options_(options), context_(context),
        quiet_(context, context.threads), target_{registration, model.diagonal, options.probe_radius},
        centre_((model.box_min + model.box_max) * 0.5) {}

  AlignResult run() {
    context_.progress("align", 0);
    sample_ = sample_points(points_, normals_, sample_size, options_.seed);
    neighbours_ = neighbourhood(sample_.points, context_);
    const bool automatic = options_.mode == AlignMode::automatic && !options_.start;
    if (options_.mode == AlignMode::none) {
      result_.pose = options_.start.value_or(Pose());
      measure(sample_);
      if (!fits(result_.quality, size())) seek_unit_at(result_.pose);
    } else if (!automatic) {
      const Pose start = options_.start.value_or(Pose());
      // What is larger than the model fits nowhere.
      if (!too_large_for_model() || !seek_unit_at(start)) refine_from(start);
      if (result_.reasons.empty() && !fits(result_.quality, size())) seek_unit_at(start);
    } else if (!in_place()) {
      from_nothing();
    }
    if (result_.reasons.empty()) {
      result_.coverage = coverage(result_.pose);
      judge(result_, points_.size(), size());
    }
    lap("judge");
    context_.progress("align", 1);
    return std::move(result_);
  }

 private:
  double diagonal() const { return model_.diagonal; }
  double radius() const { return 0.5 * model_.diagonal; }
  // What misfits are measured by: the smaller of model and scan.
  double size() { return fit_size(diagonal(), subset().radius); }

  void lap(const char* step) {
    const auto now = std::chrono::steady_clock::now();
    result_.seconds.emplace_back(step, std::chrono::duration<double>(now - start_).count());
    start_ = now;
  }

  const SurfaceSamples& samples() {
    if (samples_.points.empty()) {
      samples_ = sample_surface(model_, model_samples, options_.seed, context_);
      if (samples_.points.empty()) throw CadError("align: no face of the model has an area");
      lap("sample model");
    }
    return samples_;
  }

  const ScanSubset& subset() {
    if (subset_.points.empty()) subset_ = scan_subset(points_, normals_, subset_size, options_.seed, context_);
    return subset_;
  }

  // The same measure of size for the model as for the scan.
  double model_radius() {
    if (!(model_radius_ > 0)) model_radius_ = extent_of(samples().points).radius;
    return model_radius_;
  }

  RefineOptions last_options() const {
    RefineOptions o;
    o.metric = options_.metric;
    o.keep = options_.keep;
    o.max_steps = options_.metric == Metric::plane ? final_steps : point_steps;
    o.tolerance = final_tolerance * diagonal();
    return o;
  }

  // How the points lie at the result's pose.
  void measure(const PointSample& sample) {
    const auto residuals = target_.residuals(sample.points, sample.normals, result_.pose, quiet_);
    set_quality(residuals, sample.points.size());
  }

  void set_quality(const std::vector<PointResidual>& residuals, std::size_t used) {
    const bool same = residuals.size() == sample_.points.size();
    std::vector<Vec3> at;
    if (!same)
      for (const PointResidual& r : residuals) at.push_back(r.at);
    result_.quality = fit_quality(residuals, same ? neighbours_ : neighbourhood(at, context_), size());
    result_.information = information_of(equations_of(residuals), result_.quality.sigma, weak_motion * diagonal());
    result_.points_used = used;
  }

  // Without the points on edges: these fix a motion from one side only, and that by noise.
  NormalEquations equations_of(std::span<const PointResidual> residuals) const {
    const double sigma = std::max(robust_sigma(residuals, diagonal()), 1e-7 * diagonal());
    std::vector<double> weights;
    weights.reserve(residuals.size());
    for (const PointResidual& r : residuals)
      weights.push_back(r.face < 0 || r.opposed || r.on_edge ? 0 : tukey_weight(r.value, sigma));
    return NormalEquations(residuals, weights);
  }

  // By how much the mean squared distance falls from the points as they are to `pose`, as a multiple of its size after,
  // to second order; and that times the number of points: chi-squared.
  bool no_better_than_identity(const Pose& pose, std::span<const PointResidual> at_pose, const FitQuality& q) const {
    if (pose_distance(pose, Pose(), centre_, radius()) <= no_move * diagonal()) return true;
    const NormalEquations equations = equations_of(at_pose);
    const MotionParts back = parts_of(pose.inverse(), to_vec(equations.centre));
    Vector6 x;
    x << back.axis * (back.angle * equations.radius), back.shift;
    const double gain = x.dot(equations.matrix * x) / (q.rms * q.rms + 1e-300);
    // Deviations that neighbours share are as good as fewer points (the effective size of a correlated sample).
    const double independent = equations.weight * (1 - q.correlation) / (1 + q.correlation);
    return gain <= no_gain || gain * independent <= chance_gain;
  }

  // As they are the points are nowhere near the model, whose closest points would take long to find from there.
  bool far_away(const ScanSubset& scan, double factor) {
    return (scan.centre - centre_).norm() > diagonal() ||
           factor * subset().half_radius > too_large * extent_of(samples().points).half_radius;
  }

  // True if the points lie on the model as they are; then the result is set.
  bool in_place() {
    if (points_.size() < in_place_points) return false;
    if (far_away(subset(), 1)) return false;
    const auto before = target_.residuals(sample_.points, sample_.normals, Pose(), quiet_);
    const FitQuality first = fit_quality(before, neighbours_, size());
    if (!(first.median <= in_place_distance * diagonal())) return false;
    // A scan in metres or inches shrinks to a spot, which may well lie on the model.
    if (subset().radius < too_small * model_radius()) return false;
    RefineOptions o = last_options();
    Refined refined = refine_pose(target_, sample_.points, sample_.normals, Pose(), o, quiet_);
    const auto after = target_.residuals(sample_.points, sample_.normals, refined.pose, quiet_);
    const FitQuality second = fit_quality(after, neighbours_, size());
    lap("refine from the points as they are");
    if (first.sigma > in_place_ratio * second.sigma + 1e-5 * diagonal()) return false;
    if (!fits(second, size())) return false;
    const bool no_better = no_better_than_identity(refined.pose, after, second);
    // Along a motion that the points do not fix the refinement may go far, and the points lie as well as before.
    if (!near_start(refined.pose) && !(no_better && fits(first, size()))) return false;
    result_.iterations = refined.steps;
    if (no_better) {
      result_.kept = true;
      set_quality(before, before.size());
    } else {
      refine_last(refined.pose);
    }
    return true;
  }

  // From far off to the last steps.
  RefineOptions start_options(const PointSample& sample, const Pose& start) {
    const auto before = target_.residuals(sample.points, sample.normals, start, quiet_);
    const double median = robust_sigma(before, diagonal()) / 1.4826;
    RefineOptions o = last_options();
    o.first_kernel = std::clamp(3 * median, 2e-3 * diagonal(), 0.2 * diagonal());
    o.last_kernel = 1e-3 * diagonal();
    o.kernel_steps = 12;
    return o;
  }

  void refine_from(const Pose& start) {
    const RefineOptions o = start_options(sample_, start);
    const Refined refined = refine_pose(target_, sample_.points, sample_.normals, start, o, quiet_);
    result_.iterations = refined.steps;
    lap("refine from the start");
    refine_last(refined.pose);
  }

  // On all the points, or as many as matter.
  void refine_last(const Pose& pose) {
    context_.progress("align", 0.8);
    const PointSample all = sample_points(points_, normals_, options_.most_points, options_.seed);
    Refined refined = refine_pose(target_, all.points, all.normals, pose, last_options(), quiet_);
    result_.pose = refined.pose;
    result_.iterations += refined.steps;
    if (!refined.converged)
      result_.notes.push_back(
          fmt::format("the last step still moved the points by more than {:.3g} mm", final_tolerance * diagonal()));
    if (all.points.size() <= sample_size)
      measure(all);
    else
      set_quality(refined.residuals, all.points.size());
    lap("refine");
    const auto loose = [&](const PoseInformation::Weak& weak) {
      return weak.standard_deviation > loose_motion * diagonal();
    };
    const PoseInformation& known = result_.information;
    if (options_.probe_radius == 0 &&
        (!known.freedoms.empty() || std::any_of(known.weak.begin(), known.weak.end(), loose))) {
      settle(all);
      lap("settle in the rim");
    }
  }

  // Where the surface leaves the pose a motion, the rim of the model may not.
  void settle(const PointSample& all) {
    const Rim rim(model_, target_.registration, context_);
    if (rim.empty()) return;
    const auto residuals = target_.residuals(sample_.points, sample_.normals, result_.pose, quiet_);
    NormalEquations equations = equations_of(residuals);
    const RimFit fit = fit_to_rim(rim, target_, all, result_.pose, equations, result_.quality.sigma,
                                  loose_motion * diagonal(), quiet_);
    if (fit.moved == 0) return;
    if (fit.motions > 0)
      result_.notes.push_back(fmt::format(
          "{} of the motions that the surface leaves free {} stopped by the rim of the model: the pose is in "
          "the middle of what it allows",
          fit.motions, fit.motions > 1 ? "are" : "is"));
    result_.pose = fit.pose;
    // The way there was straight to first order only: the motions that the surface fixes are set right again.
    for (int step = 0; step < settle_steps; ++step)
      result_.pose = firm_step(equations_of(target_.residuals(all.points, all.normals, result_.pose, quiet_)),
                               result_.quality.sigma, loose_motion * diagonal()) *
                     result_.pose;
    result_.pose = pose_of(result_.pose.matrix());
    measure(sample_);
    result_.points_used = all.points.size();
  }

  std::vector<Candidate> search(double factor) {
    ScanSubset scan = subset();
    PointSample sample = sample_;
    if (factor != 1) {
      for (auto* list : {&scan.points, &sample.points})
        for (Vec3& p : *list) p *= factor;
      scan.centre *= factor;
      scan.radius *= factor;
    }
    PoseSearchOptions o;
    o.diagonal = diagonal();
    o.probe_radius = options_.probe_radius;
    o.seed = options_.seed;
    std::vector<Pose> starts;
    if (!far_away(scan, factor)) starts.emplace_back();
    const auto coarse = search_poses(scan, samples(), starts, o, context_);
    lap("search");
    auto candidates = refine_candidates(target_, coarse, starts, sample, scan.centre, scan.radius, context_);
    lap("compare poses");
    result_.searched = true;
    return candidates;
  }

  double size_ratio() { return subset().radius / model_radius(); }

  bool too_large_for_model() {
    return size_ratio() > too_large && subset().half_radius > too_large * extent_of(samples().points).half_radius;
  }

  // Factors between units that would give the points the model's size, the likeliest first.
  std::vector<double> likely_units() {
    std::vector<double> units;
    for (const double f : unit_factors)
      if (size_ratio() * f > unit_low && size_ratio() * f < unit_high) units.push_back(f);
    std::sort(units.begin(), units.end(), [&](double a, double b) {
      return std::abs(std::log(size_ratio() * a)) < std::abs(std::log(size_ratio() * b));
    });
    return units;
  }

  void set_unit(double factor, const Pose& pose, const FitQuality& quality) {
    result_.unit_factor = factor;
    result_.pose = pose;
    result_.quality = quality;
    result_.reasons.push_back(fmt::format(
        "the points are {} the model: their radius is {:.4g}, the model's {:.4g} mm; multiplied by {:.6g} "
        "they fit, with a median distance of {:.3g} mm",
        size_ratio() > 1 ? "too large for" : "too small for", subset().radius, model_radius(), factor, quality.median));
  }

  void say_too_large() {
    const double theirs = subset().half_radius, models = extent_of(samples().points).half_radius;
    result_.reasons.push_back(
        fmt::format("the points are too large for the model: half of them are farther than {:.4g} mm from their "
                    "middle, of the model {:.4g} mm: about {:.3g} times as large",
                    theirs, models, theirs / models));
  }

  // Where the points are taken about where they are: the unit in which they lie there, or that they are too large in
  // any. True if there is a reason why they do not fit.
  bool seek_unit_at(const Pose& start) {
    if (size_ratio() >= too_small && size_ratio() <= too_large) return false;
    for (const double factor : likely_units()) {
      PointSample sample = sample_;
      for (Vec3& p : sample.points) p *= factor;
      Pose pose = start;
      if (options_.mode != AlignMode::none)
        pose = refine_pose(target_, sample.points, sample.normals, start, start_options(sample, start), quiet_).pose;
      const auto residuals = target_.residuals(sample.points, sample.normals, pose, quiet_);
      const FitQuality quality = fit_quality(residuals, neighbours_, fit_size(diagonal(), factor * subset().radius));
      if (!fits(quality, fit_size(diagonal(), factor * subset().radius))) continue;
      set_unit(factor, pose, quality);
      return true;
    }
    if (!too_large_for_model()) return false;
    say_too_large();
    return true;
  }

  void from_nothing() {
    const double ratio = size_ratio();
    context_.progress("align", 0.1);
    const auto other_unit = [&] {
      for (const double factor : likely_units()) {
        const auto found = search(factor);
        if (found.empty() || !fits(found.front().quality, fit_size(diagonal(), factor * subset().radius))) continue;
        set_unit(factor, found.front().pose, found.front().quality);
        return true;
      }
      return false;
    };
    if ((ratio > too_large || ratio < too_small) && other_unit()) return;
    if (too_large_for_model()) {
      say_too_large();
      return;
    }
    std::vector<Candidate> found = search(1);
    if (ratio >= too_small && ratio <= too_large && (found.empty() || !fits(found.front().quality, size())) &&
        other_unit())
      return;
    if (found.empty()) {
      result_.reasons.push_back(
          fmt::format("no pose brings the points near the model: their middle is {:.4g} mm from the model's, their "
                      "radius {:.4g} mm, "
                      "the model's {:.4g} mm",
                      (subset().centre - centre_).norm(), subset().radius, model_radius()));
      return;
    }
    choose(found);
    refine_last(result_.pose);
    describe_alternatives(found);
  }

  bool near_start(const Pose& pose) {
    return pose_distance(pose, Pose(), subset().centre, subset().radius) <= in_place_move * diagonal();
  }

  // The best, or among equals the one that leaves the points about where they are.
  void choose(std::vector<Candidate>& found) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < found.size(); ++i)
      if (found[i].z < equal_z && near_start(found[i].pose) && fits(found[i].quality, size())) best = i;
    std::swap(found[0], found[best]);
    result_.pose = found[0].pose;
    result_.iterations = found[0].steps;
    context_.progress("align", 0.7);
  }

  void describe_alternatives(const std::vector<Candidate>& found) {
    const double tolerance = 5e-3 * diagonal();
    std::vector<Pose> known;
    const Pose back = found[0].pose.inverse();
    for (std::size_t i = 1; i < found.size() && result_.alternatives.size() < most_alternatives; ++i) {
      const Candidate& c = found[i];
      if (std::abs(c.z) >= equal_z) continue;
      const Pose relative = c.pose * back;
      const Vec3 middle = result_.pose(subset().centre);
      // With a motion that is free, poses that differ by it only are one.
      const auto& freedoms = result_.information.freedoms;
      if (!freedoms.empty()) {
        if (is_free(relative, freedoms, middle, subset().radius, tolerance)) continue;
        const bool repeated = std::any_of(known.begin(), known.end(), [&](const Pose& k) {
          return is_free(k.inverse() * relative, freedoms, middle, subset().radius, tolerance);
        });
        if (repeated) continue;
      }
      known.push_back(relative);
      Alternative a;
      a.motion = relative;
      a.pose = relative * result_.pose;
      a.words = in_words(relative, centre_, diagonal());
      a.quality = c.quality;
      a.coverage = coverage(a.pose);
      result_.alternatives.push_back(std::move(a));
    }
  }

  double coverage(const Pose& pose) {
    if (!tree_) {
      tree_.emplace(subset().points);
      std::vector<NearestPoints::Neighbor> near;
      std::vector<double> spacing;
      for (const Vec3& p : subset().points) {
        tree_->nearest(p, 7, near);
        spacing.push_back(std::sqrt(near.back().squared_distance));
      }
      std::nth_element(spacing.begin(), spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2),
                       spacing.end());
      reach_ = 2 * spacing[spacing.size() / 2] + options_.probe_radius;
    }
    const Pose back = pose.inverse();
    std::vector<NearestPoints::Neighbor> near;
    std::size_t covered = 0, count = 0;
    for (const std::uint32_t i : random_indices(samples().points.size(), coverage_samples, options_.seed)) {
      tree_->nearest(back(samples().points[i]), 1, near);
      covered += near[0].squared_distance <= reach_ * reach_;
      ++count;
    }
    return static_cast<double>(covered) / static_cast<double>(count);
  }

  const CadModel& model_;
  std::span<const Vec3> points_, normals_;
  const AlignOptions& options_;
  Context& context_;
  QuietContext quiet_;
  FitTarget target_;
  Vec3 centre_;
  AlignResult result_;
  PointSample sample_;
  Neighbourhood neighbours_;
  SurfaceSamples samples_;
  ScanSubset subset_;
  double model_radius_ = 0, reach_ = 0;
  std::optional<NearestPoints> tree_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

AlignMode align_mode(std::string_view name) {
  if (name == "auto") return AlignMode::automatic;
  if (name == "icp") return AlignMode::icp;
  if (name == "none") return AlignMode::none;
  throw InvalidInput(fmt::format("no alignment is called '{}'; known: auto, icp, none", name));
}

const char* name_of(AlignStatus status) {
  switch (status) {
    case AlignStatus::good:
      return "good";
    case AlignStatus::ambiguous:
      return "ambiguous";
    case AlignStatus::failed:
      return "failed";
  }
  return "";
}

AlignResult align(const CadModel& model, const Registration& registration, std::span<const Vec3> points,
                  std::span<const Vec3> normals, const AlignOptions& options, Context& context) {
  validate(points, normals, options);
  return Alignment(model, registration, points, normals, options, context).run();
}

}  // namespace tri

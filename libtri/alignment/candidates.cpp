#include "libtri/alignment/candidates.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libtri/alignment/information.hpp"
#include "libtri/quiet_context.hpp"
#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t first_points = 400, second_points = 1500;
constexpr double first_kernel = 8e-3, middle_kernel = 2e-3, last_kernel = 7e-4;  // of the diagonal
constexpr int first_steps = 4, second_steps = 2, tukey_steps = 20;
constexpr double tolerance = 1e-5;     // of the diagonal
constexpr double clearly_worse = 0.2;  // of the first loss
constexpr std::size_t most_candidates = 10;
constexpr double same_pose = 1e-3;    // of the diagonal
constexpr double least_scale = 3e-5;  // of the diagonal: finer differences are those of the tolerance

// The best pose is tried again from poses beside it, along the motions that the points fix least: there other minima
// are near.
constexpr double nudges[] = {-0.045, -0.018, -0.007, 0.007, 0.018, 0.045};  // of the diagonal
constexpr int nudged_motions = 3, nudge_rounds = 3;
constexpr double nudged_worse = 0.05;  // of the first loss
constexpr std::size_t most_nudged = 6;

struct Scored {
  Pose pose;
  bool start;
  int steps = 0;
  double loss = 0;
};

double mean_loss(std::span<const PointResidual> residuals, double kernel) {
  double sum = 0;
  for (const PointResidual& r : residuals)
    sum += r.face < 0 || r.opposed ? 1 : r.value * r.value / (kernel * kernel + r.value * r.value);
  return residuals.empty() ? 1 : sum / static_cast<double>(residuals.size());
}

// Runs `body(i, context)` for each index, each on one thread.
template <class Body>
void for_each_index(std::size_t count, const Context& context, const Body& body) {
  for_each_block(context, "", count, 1, [&](std::size_t i, std::size_t, std::size_t) {
    QuietContext quiet(context, 1);
    body(i, quiet);
  });
}

class Comparison {
 public:
  Comparison(const FitTarget& target, const PointSample& sample, const Vec3& centre, double radius,
             const Context& context)
      : target_(target), sample_(sample), first_(sample_points(sample.points, sample.normals, first_points, 1)),
        second_(sample_points(sample.points, sample.normals, second_points, 2)),
        neighbours_(neighbourhood(sample.points, context)), centre_(centre), radius_(radius), context_(context) {}

  std::vector<Candidate> run(std::vector<Scored> items) {
    refine_first(items);
    refine_second(different(items, items.empty() ? 1 : items.front().loss + clearly_worse, most_candidates));
    compare();
    for (int round = 0; round < nudge_rounds && !candidates_.empty(); ++round) {
      const Pose best = candidates_.front().pose;
      QuietContext quiet(context_, context_.threads);
      const double loss = first_loss(best, quiet);
      items = beside(candidates_.front());
      refine_first(items);
      std::erase_if(items, [&](const Scored& item) {
        return std::any_of(candidates_.begin(), candidates_.end(),
                           [&](const Candidate& c) { return distance(c.pose, item.pose) < same_pose * diagonal(); });
      });
      refine_second(different(items, loss + nudged_worse, most_nudged));
      compare();
      if (distance(candidates_.front().pose, best) < same_pose * diagonal()) break;
    }
    return std::move(candidates_);
  }

 private:
  double diagonal() const { return target_.diagonal; }
  double distance(const Pose& a, const Pose& b) const { return pose_distance(a, b, centre_, radius_); }
  double first_loss(const Pose& pose, Context& quiet) const {
    return mean_loss(target_.residuals(first_.points, first_.normals, pose, quiet), middle_kernel * diagonal());
  }

  // A few steps with few points; best first afterwards.
  void refine_first(std::vector<Scored>& items) const {
    for_each_index(items.size(), context_, [&](std::size_t i, Context& quiet) {
      RefineOptions options;
      options.first_kernel = first_kernel * diagonal();
      options.last_kernel = middle_kernel * diagonal();
      options.kernel_steps = first_steps;
      options.max_steps = 0;
      const Refined refined = refine_pose(target_, first_.points, first_.normals, items[i].pose, options, quiet);
      items[i].pose = refined.pose;
      items[i].steps = refined.steps;
      items[i].loss = first_loss(refined.pose, quiet);
    });
    std::stable_sort(items.begin(), items.end(), [](const Scored& a, const Scored& b) { return a.loss < b.loss; });
  }

  // One of each group of equal poses; starts always.
  std::vector<Scored> different(const std::vector<Scored>& items, double worst, std::size_t most) const {
    std::vector<Scored> kept;
    for (const Scored& item : items) {
      const bool same = std::any_of(kept.begin(), kept.end(), [&](const Scored& k) {
        return distance(k.pose, item.pose) < same_pose * diagonal() && (k.start || !item.start);
      });
      if (!same && (item.start || (kept.size() < most && item.loss <= worst))) kept.push_back(item);
    }
    return kept;
  }

  // To convergence; adds them to the candidates.
  void refine_second(const std::vector<Scored>& items) {
    const std::size_t known = candidates_.size();
    candidates_.resize(known + items.size());
    for_each_index(items.size(), context_, [&](std::size_t i, Context& quiet) {
      RefineOptions options;
      options.first_kernel = middle_kernel * diagonal();
      options.last_kernel = last_kernel * diagonal();
      options.kernel_steps = second_steps;
      options.max_steps = tukey_steps;
      options.tolerance = tolerance * diagonal();
      const Refined refined = refine_pose(target_, second_.points, second_.normals, items[i].pose, options, quiet);
      Candidate& c = candidates_[known + i];
      c.pose = refined.pose;
      c.start = items[i].start;
      c.steps = items[i].steps + refined.steps;
      c.residuals = target_.residuals(sample_.points, sample_.normals, c.pose, quiet);
      c.quality = fit_quality(c.residuals, neighbours_, fit_size(diagonal(), radius_));
    });
  }

  // Best first, without repetitions.
  void compare() {
    double sigma = std::numeric_limits<double>::infinity();
    for (const Candidate& c : candidates_) sigma = std::min(sigma, c.quality.sigma);
    const double scale = std::max(3 * sigma, least_scale * diagonal());
    const auto loss = [&](const PointResidual& r) {
      const double x = r.value / scale;
      return r.face < 0 || r.opposed ? 1.0 : std::min(1.0, x * x);
    };
    for (Candidate& c : candidates_) {
      c.loss = 0;
      for (const PointResidual& r : c.residuals) c.loss += loss(r);
      c.loss /= static_cast<double>(c.residuals.size());
    }
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.loss < b.loss; });
    std::vector<Candidate> kept;
    for (Candidate& c : candidates_) {
      const auto same = std::find_if(kept.begin(), kept.end(), [&](const Candidate& d) {
        return distance(d.pose, c.pose) < same_pose * diagonal() + 3 * sigma;
      });
      if (same != kept.end())
        same->start = same->start || c.start;
      else
        kept.push_back(std::move(c));
    }
    candidates_.swap(kept);
    for (Candidate& c : candidates_) {
      const auto n = static_cast<double>(c.residuals.size());
      double sum = 0, squares = 0;
      for (std::size_t i = 0; i < c.residuals.size(); ++i) {
        const double d = loss(c.residuals[i]) - loss(candidates_.front().residuals[i]);
        sum += d;
        squares += d * d;
      }
      const double mean = sum / n, variance = std::max(0.0, squares / n - mean * mean);
      c.z = mean > 0 ? mean / std::sqrt(variance / n + 1e-300) : 0;
    }
  }

  std::vector<Scored> beside(const Candidate& best) const {
    std::vector<double> weights;
    for (const PointResidual& r : best.residuals)
      weights.push_back(r.face < 0 || r.opposed ? 0 : tukey_weight(r.value, best.quality.sigma));
    const NormalEquations equations(best.residuals, weights);
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.matrix);
    std::vector<Scored> items;
    for (int k = 0; k < nudged_motions; ++k) {
      for (const double nudge : nudges) {
        const Vector6 x = solver.eigenvectors().col(k) * (nudge * diagonal());
        items.push_back({motion(x.head<3>() / equations.radius, x.tail<3>(), equations.centre) * best.pose, false});
      }
    }
    return items;
  }

  const FitTarget& target_;
  const PointSample& sample_;
  PointSample first_, second_;
  Neighbourhood neighbours_;
  Vec3 centre_;
  double radius_;
  const Context& context_;
  std::vector<Candidate> candidates_;
};

}  // namespace

PointSample sample_points(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t count,
                          std::uint64_t seed) {
  PointSample sample;
  for (const std::uint32_t i : random_indices(points.size(), count, seed)) {
    sample.points.push_back(points[i]);
    if (!normals.empty()) sample.normals.push_back(normals[i]);
  }
  return sample;
}

std::vector<Candidate> refine_candidates(const FitTarget& target, std::span<const CoarsePose> coarse,
                                         std::span<const Pose> starts, const PointSample& sample, const Vec3& centre,
                                         double radius, const Context& context) {
  std::vector<Scored> items;
  for (const Pose& p : starts) items.push_back({p, true});
  for (const CoarsePose& c : coarse) items.push_back({c.pose, false});
  return Comparison(target, sample, centre, radius, context).run(std::move(items));
}

}  // namespace tri

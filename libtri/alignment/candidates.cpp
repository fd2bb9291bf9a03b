#include "libtri/alignment/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libtri/alignment/quiet_context.hpp"
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

struct Item {
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
  const double diagonal = target.diagonal;
  std::vector<Item> items;
  for (const Pose& p : starts) items.push_back({p, true});
  for (const CoarsePose& c : coarse) items.push_back({c.pose, false});

  const PointSample first = sample_points(sample.points, sample.normals, first_points, 1);
  for_each_index(items.size(), context, [&](std::size_t i, Context& quiet) {
    RefineOptions options;
    options.first_kernel = first_kernel * diagonal;
    options.last_kernel = middle_kernel * diagonal;
    options.kernel_steps = first_steps;
    options.max_steps = 0;
    Refined refined = refine_pose(target, first.points, first.normals, items[i].pose, options, quiet);
    items[i].pose = refined.pose;
    items[i].steps = refined.steps;
    items[i].loss =
        mean_loss(target.residuals(first.points, first.normals, refined.pose, quiet), middle_kernel * diagonal);
  });
  std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.loss < b.loss; });
  std::vector<Item> kept;
  for (const Item& item : items) {
    const bool same = std::any_of(kept.begin(), kept.end(), [&](const Item& k) {
      return pose_distance(k.pose, item.pose, centre, radius) < same_pose * diagonal && (k.start || !item.start);
    });
    if (same) continue;
    if (item.start || (kept.size() < most_candidates && item.loss <= items.front().loss + clearly_worse))
      kept.push_back(item);
  }

  const PointSample second = sample_points(sample.points, sample.normals, second_points, 2);
  std::vector<Candidate> candidates(kept.size());
  const Neighbourhood neighbours = neighbourhood(sample.points, context);
  for_each_index(kept.size(), context, [&](std::size_t i, Context& quiet) {
    RefineOptions options;
    options.first_kernel = middle_kernel * diagonal;
    options.last_kernel = last_kernel * diagonal;
    options.kernel_steps = second_steps;
    options.max_steps = tukey_steps;
    options.tolerance = tolerance * diagonal;
    const Refined refined = refine_pose(target, second.points, second.normals, kept[i].pose, options, quiet);
    Candidate& c = candidates[i];
    c.pose = refined.pose;
    c.start = kept[i].start;
    c.steps = kept[i].steps + refined.steps;
    c.residuals = target.residuals(sample.points, sample.normals, c.pose, quiet);
    c.quality = fit_quality(c.residuals, neighbours, diagonal);
  });

  double sigma = std::numeric_limits<double>::infinity();
  for (const Candidate& c : candidates) sigma = std::min(sigma, c.quality.sigma);
  const double scale = std::max(3 * sigma, least_scale * diagonal);
  const auto loss = [&](const PointResidual& r) {
    const double x = r.value / scale;
    return r.face < 0 || r.opposed ? 1.0 : std::min(1.0, x * x);
  };
  for (Candidate& c : candidates) {
    for (const PointResidual& r : c.residuals) c.loss += loss(r);
    c.loss /= static_cast<double>(c.residuals.size());
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.loss < b.loss; });
  std::vector<Candidate> different;
  for (Candidate& c : candidates) {
    const auto same = std::find_if(different.begin(), different.end(), [&](const Candidate& d) {
      return pose_distance(d.pose, c.pose, centre, radius) < same_pose * diagonal + 3 * sigma;
    });
    if (same != different.end())
      same->start = same->start || c.start;
    else
      different.push_back(std::move(c));
  }
  for (Candidate& c : different) {
    const auto n = static_cast<double>(c.residuals.size());
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < c.residuals.size(); ++i) {
      const double d = loss(c.residuals[i]) - loss(different.front().residuals[i]);
      sum += d;
      squares += d * d;
    }
    const double mean = sum / n, variance = std::max(0.0, squares / n - mean * mean);
    c.z = mean > 0 ? mean / std::sqrt(variance / n + 1e-300) : 0;
  }
  return different;
}

}  // namespace tri

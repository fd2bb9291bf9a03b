#include "libtri/alignment/exact_fit.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libtri/alignment/information.hpp"
#include "libtri/alignment/probe.hpp"

namespace tri {
namespace {

constexpr double tukey = 4.685;
constexpr double least_sigma = 1e-9;     // of the diagonal
constexpr double contact = 1e-8;         // of the diagonal: nearer, the direction is the normal
constexpr double normals_agree = 0.8;    // share that must agree before normals count
constexpr double opposed_cosine = -0.2;  // normals that differ by more than 100 degrees
constexpr double unfixed_share = 1e-9;   // of the largest eigenvalue: no step along motions with less information
constexpr std::size_t normal_equations_block = 4096;

// Over the points, in fixed blocks, so that the sum does not depend on anything but their order.
template <class Term>
double block_sum(std::size_t count, const Term& term) {
  double sum = 0;
  for (std::size_t begin = 0; begin < count; begin += normal_equations_block) {
    double part = 0;
    for (std::size_t i = begin; i < std::min(count, begin + normal_equations_block); ++i) part += term(i);
    sum += part;
  }
  return sum;
}

// Weight of each residual; the largest (1 - keep) of them get none.
std::vector<double> weights_of(std::span<const PointResidual> residuals, double kernel, double sigma, double keep) {
  double limit = std::numeric_limits<double>::infinity();
  if (keep < 1 && !residuals.empty()) {
    std::vector<double> x;
    x.reserve(residuals.size());
    for (const PointResidual& r : residuals) x.push_back(std::abs(r.value));
    const auto at = x.begin() + static_cast<std::ptrdiff_t>(keep * static_cast<double>(x.size() - 1));
    std::nth_element(x.begin(), at, x.end());
    limit = *at;
  }
  std::vector<double> weights(residuals.size(), 0);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const PointResidual& r = residuals[i];
    if (r.face < 0 || r.opposed || std::abs(r.value) > limit) continue;
    if (kernel > 0) {
      const double k = kernel * kernel / (kernel * kernel + r.value * r.value);
      weights[i] = k * k;
    } else {
      weights[i] = tukey_weight(r.value, sigma);
    }
  }
  return weights;
}

// The step of Gauss and Newton. Motions without information are not made: their eigenvalues are rounding.
Pose plane_step(std::span<const PointResidual> residuals, std::span<const double> weights) {
  const NormalEquations equations(residuals, weights);
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.matrix);
  const Vector6 along = solver.eigenvectors().transpose() * equations.right_side;
  const double least = unfixed_share * solver.eigenvalues()[5];
  Vector6 x = Vector6::Zero();
  for (int k = 0; k < 6; ++k)
    if (solver.eigenvalues()[k] > least) x += solver.eigenvectors().col(k) * (along[k] / solver.eigenvalues()[k]);
  Eigen::Vector3d turn = x.head<3>() / equations.radius;
  constexpr double most = 0.3;  // rad: linear no farther
  if (turn.norm() > most) turn *= most / turn.norm();
  return motion(turn, x.tail<3>(), equations.centre);
}

Pose point_step(std::span<const PointResidual> residuals, std::span<const double> weights) {
  std::vector<Vec3> from, to;
  std::vector<double> used;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!(weights[i] > 0)) continue;
    from.push_back(residuals[i].at);
    to.push_back(residuals[i].at - residuals[i].direction * residuals[i].value);
    used.push_back(weights[i]);
  }
  return fit_pose(from, to, used);
}

}  // namespace

std::vector<PointResidual> FitTarget::residuals(std::span<const Vec3> points, std::span<const Vec3> normals,
                                                const Pose& pose, Context& context) const {
  std::vector<Vec3> posed;
  posed.reserve(points.size());
  for (const Vec3& p : points) posed.push_back(pose(p));
  const std::vector<Foot> feet = registration.register_points(posed, context);
  std::vector<PointResidual> residuals(points.size());
  std::size_t agree = 0, known = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Foot& foot = feet[i];
    PointResidual& r = residuals[i];
    r.at = posed[i];
    r.face = foot.face;
    if (foot.face < 0) continue;
    r.foot = foot.point;
    r.on_edge = foot.edge >= 0;
    r.value = foot.deviation;
    const Vec3 normal(foot.normal[0], foot.normal[1], foot.normal[2]);
    r.direction = std::abs(foot.deviation) > contact * diagonal ? (posed[i] - foot.point) / foot.deviation : normal;
    if (normals.empty() || normals[i].sqrnorm() < 0.5) continue;
    const double cosine = pose.turn(normals[i]) | normal;
    ++known;
    agree += cosine > 0;
    // For now the cosine; what it means is known once all are counted.
    r.opposed = cosine < opposed_cosine;
  }
  if (known > 0) {
    const double share = static_cast<double>(agree) / static_cast<double>(known);
    if (share < 1 - normals_agree) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (residuals[i].face < 0 || normals[i].sqrnorm() < 0.5) continue;
        const Vec3 normal(feet[i].normal[0], feet[i].normal[1], feet[i].normal[2]);
        residuals[i].opposed = -(pose.turn(normals[i]) | normal) < opposed_cosine;
      }
    } else if (share < normals_agree) {
      for (PointResidual& r : residuals) r.opposed = false;
    }
  }
  if (probe_radius > 0) {
    const double offset = probe_offset(feet, probe_radius);
    for (PointResidual& r : residuals) r.value -= offset;
  }
  return residuals;
}

double robust_sigma(std::span<const PointResidual> residuals, double diagonal) {
  std::vector<double> x;
  x.reserve(residuals.size());
  for (const PointResidual& r : residuals)
    if (r.face >= 0) x.push_back(r.opposed ? std::numeric_limits<double>::max() : std::abs(r.value));
  if (x.empty()) return least_sigma * diagonal;
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return std::max(1.4826 * std::min(*middle, diagonal), least_sigma * diagonal);
}

double tukey_weight(double value, double sigma) {
  const double x = value / (tukey * sigma), y = 1 - x * x;
  return y > 0 ? y * y : 0;
}

Refined refine_pose(const FitTarget& target, std::span<const Vec3> points, std::span<const Vec3> normals,
                    const Pose& start, const RefineOptions& options, Context& context) {
  Refined result;
  result.pose = start;
  const int steps = options.kernel_steps + options.max_steps;
  for (int step = 0; step < steps && !result.converged; ++step) {
    context.checkpoint();
    result.residuals = target.residuals(points, normals, result.pose, context);
    double kernel = 0;
    if (step < options.kernel_steps) {
      const double share = options.kernel_steps > 1 ? static_cast<double>(step) / (options.kernel_steps - 1) : 0;
      kernel = options.first_kernel * std::pow(options.last_kernel / options.first_kernel, share);
    }
    const double sigma = robust_sigma(result.residuals, target.diagonal);
    const std::vector<double> weights = weights_of(result.residuals, kernel, sigma, options.keep);
    const double sum = block_sum(weights.size(), [&](std::size_t i) { return weights[i]; });
    if (!(sum > 0)) break;
    const Pose move =
        options.metric == Metric::plane ? plane_step(result.residuals, weights) : point_step(result.residuals, weights);
    const double moved = block_sum(weights.size(), [&](std::size_t i) {
      return weights[i] * (move(result.residuals[i].at) - result.residuals[i].at).sqrnorm();
    });
    result.pose = move * result.pose;
    ++result.steps;
    result.converged = kernel == 0 && std::sqrt(moved / sum) <= options.tolerance;
  }
  // Products of many rotations drift away from one.
  result.pose = pose_of(result.pose.matrix());
  return result;
}

}  // namespace tri

#include "libtri/alignment/rim_fit.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "libtri/alignment/scan_normals.hpp"
#include "meshops/random_stream.hpp"

namespace tri {
namespace {

constexpr double first_scale = 0.02;  // of the diagonal: overhang that is drawn in first
constexpr double reach_scales = 3;    // a point so far from the rim matters
constexpr double shrink = 0.25;       // of the scale, from one to the next
constexpr int most_draws = 10;        // at each scale
constexpr double settled = 0.02;      // of the scale: a shorter move is the last
constexpr double rim_inlier_sigmas = 4.685;
constexpr double tangent_error = 0.1;  // of the distance: the surface bends away from the rim's tangent plane
constexpr double least_speed = 0.05;   // across the rim, of the motion's
constexpr int most_motions = 3;
constexpr double wild = 1e-3;     // least likelihood of a point over the rim
constexpr double unlikely = 8;    // fall of the log-likelihood at the border of what is left
constexpr double longest = 2e-2;  // of the diagonal: what is left is not wider
// Points that a standard deviation of what is left would take over the rim: about one where the points are spread
// evenly up to it.
constexpr double most_missing = 4;
constexpr int centre_rounds = 3;
constexpr std::size_t draws = 1500;
constexpr double box_deviations = 3.5;
constexpr std::size_t most_points = 4000;
constexpr std::uint64_t draw_seed = 1;

using Motions = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// A point beside the rim: how far inside it lies, and how that changes with each motion.
struct Beside {
  double margin;
  Eigen::VectorXd change;
  std::uint32_t point;
};

class Fit {
 public:
  Fit(const Rim& rim, const FitTarget& target, const PointSample& sample, const NormalEquations& equations,
      double sigma, Context& context)
      : rim_(rim), target_(target), sample_(sample), matrix_(equations.matrix * (equations.weight / (sigma * sigma))),
        right_(equations.right_side * (equations.weight / (sigma * sigma))), centre_(equations.centre),
        radius_(equations.radius), sigma_(sigma), context_(context) {}

  RimFit run(const Pose& start, const Motions& motions) {
    RimFit result;
    result.pose = start;
    motions_ = motions;
    for (std::uint32_t i = 0; i < sample_.points.size(); ++i) used_.push_back(i);
    const double diagonal = target_.diagonal;
    // The points near the rim, once and for all.
    narrow(result.pose, reach_scales * first_scale * diagonal);
    across_the_rim(result.pose);
    if (used_.empty() || motions_.cols() == 0) return result;
    for (double scale = first_scale * diagonal;; scale = std::max(shrink * scale, sigma_)) {
      for (int step = 0; step < most_draws; ++step) {
        context_.checkpoint();
        if (draw_in(look(result.pose, reach_scales * scale), scale, result.pose) < settled * scale) break;
      }
      if (scale <= sigma_) break;
    }
    across_the_rim(result.pose);
    for (int round = 0; round < centre_rounds && motions_.cols() > 0; ++round) {
      context_.checkpoint();
      const auto beside = look(result.pose, longest * diagonal);
      result.motions = to_middle(beside, result.pose);
      if (result.motions == 0) break;
    }
    double sum = 0;
    for (const Vec3& p : sample_.points) sum += (result.pose(p) - start(p)).sqrnorm();
    result.moved = std::sqrt(sum / static_cast<double>(sample_.points.size()));
    return result;
  }

 private:
  void narrow(const Pose& pose, double reach) {
    std::vector<std::uint32_t> kept;
    for (const Beside& b : look(pose, reach)) kept.push_back(b.point);
    if (kept.size() > most_points) {
      std::vector<std::uint32_t> fewer;
      for (const std::uint32_t k : random_indices(kept.size(), most_points, draw_seed)) fewer.push_back(kept[k]);
      kept.swap(fewer);
    }
    used_.swap(kept);
  }

  std::vector<Beside> look(const Pose& pose, double reach) {
    std::vector<Vec3> points, normals;
    for (const std::uint32_t i : used_) {
      points.push_back(sample_.points[i]);
      if (!sample_.normals.empty()) normals.push_back(sample_.normals[i]);
    }
    const auto residuals = target_.residuals(points, normals, pose, context_);
    std::vector<Beside> result;
    for (std::size_t k = 0; k < residuals.size(); ++k) {
      const PointResidual& r = residuals[k];
      if (r.face < 0 || r.opposed || (!r.on_edge && std::abs(r.value) > rim_inlier_sigmas * sigma_)) continue;
      const Rim::Place* place = rim_.near(r.at, r.on_edge ? -1 : r.face, reach);
      if (!place) continue;
      const Vec3 from = r.at - place->point;
      Beside b;
      b.margin = from | place->inward;
      if (r.on_edge && std::abs(from | place->normal) > rim_inlier_sigmas * sigma_ + tangent_error * std::abs(b.margin))
        continue;
      b.change.resize(motions_.cols());
      const Eigen::Vector3d arm = to_eigen(r.at) - centre_, inward = to_eigen(place->inward);
      for (int m = 0; m < motions_.cols(); ++m) {
        const Eigen::Vector3d turn = motions_.col(m).head<3>() / radius_;
        b.change[m] = inward.dot(turn.cross(arm) + motions_.col(m).tail<3>());
      }
      b.point = used_[k];
      result.push_back(std::move(b));
    }
    return result;
  }

  // Sorts the motions into those that cross the rim and those along it, and leaves the latter out.
  void across_the_rim(const Pose& pose) {
    const auto k = motions_.cols();
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(k, k);
    const auto beside = look(pose, longest * target_.diagonal);
    for (const Beside& b : beside) gram += b.change * b.change.transpose();
    if (beside.empty()) {
      motions_.resize(6, 0);
      return;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram / static_cast<double>(beside.size()));
    int along = 0;
    while (along < k && solver.eigenvalues()[along] < least_speed * least_speed) ++along;
    motions_ = (motions_ * solver.eigenvectors().rightCols(k - along)).eval();
  }

  void move(const Eigen::VectorXd& x, Pose& pose) {
    const Vector6 whole = motions_ * x;
    // A turn about a far axis is one along its whole way, so that points on a sphere stay on it.
    const Eigen::Vector3d turn = whole.head<3>() / radius_, shift = whole.tail<3>();
    const double square = turn.squaredNorm();
    const bool straight = std::sqrt(square) * target_.diagonal < 1e-9 * shift.norm();
    pose = (straight ? motion(Eigen::Vector3d::Zero(), shift, centre_)
                     : motion(turn, turn * (turn.dot(shift) / square), centre_ + turn.cross(shift) / square)) *
           pose;
    right_ -= matrix_ * whole;
  }

  // @return how far it moved, mm
  double draw_in(const std::vector<Beside>& beside, double scale, Pose& pose) {
    const auto k = motions_.cols();
    Eigen::MatrixXd h = motions_.transpose() * matrix_ * motions_;
    Eigen::VectorXd g = motions_.transpose() * right_;
    bool any = false;
    for (const Beside& b : beside) {
      if (b.margin >= 0) continue;
      any = true;
      const double x = b.margin / scale, w = 1 / ((1 + x * x) * (1 + x * x)) / (sigma_ * sigma_);
      h += w * b.change * b.change.transpose();
      g -= w * b.margin * b.change;
    }
    if (!any) return 0;
    // As if half a point more held every motion: those that no rim stops are not made.
    h += Eigen::MatrixXd::Identity(k, k) * (0.5 * least_speed * least_speed / (sigma_ * sigma_));
    Eigen::VectorXd x = h.ldlt().solve(g);
    const double most = 2 * scale;
    if (x.norm() > most) x *= most / x.norm();
    move(x, pose);
    return x.norm();
  }

  double log_likelihood(const std::vector<Beside>& beside, const Eigen::VectorXd& x) const {
    const Vector6 whole = motions_ * x;
    double sum = right_.dot(whole) - 0.5 * whole.dot(matrix_ * whole), product = 1;
    const double steep = 1.702 / sigma_;  // of the logistic curve next to the normal distribution
    for (const Beside& b : beside) {
      const double y = steep * (b.margin + b.change.dot(x));
      if (y > 20) continue;
      product *= wild + (1 - wild) / (1 + std::exp(-y));
      if (product < 1e-200) {
        sum += std::log(product);
        product = 1;
      }
    }
    return sum + std::log(product);
  }

  // Along one direction, with the log-likelihood falling on both sides: from where to where; nothing if it does not.
  std::optional<std::pair<double, double>> stops(const std::vector<Beside>& beside, const Eigen::VectorXd& from,
                                                 const Eigen::VectorXd& along) const {
    const double far = longest * target_.diagonal, here = log_likelihood(beside, from);
    double ends[2];
    for (const int side : {-1, 1}) {
      double t = 0.5 * sigma_;
      while (t < far && log_likelihood(beside, from + along * (side * t)) > here - unlikely) t *= 1.3;
      if (t >= far) return std::nullopt;
      ends[side > 0] = side * t;
    }
    return std::pair(ends[0], ends[1]);
  }

  // Points that one millimetre along a direction takes over the rim, on the side where these are fewer.
  double points_a_millimetre(const std::vector<Beside>& beside, const Eigen::VectorXd& along) const {
    double sides[2] = {0, 0};
    for (const Beside& b : beside) {
      const double change = b.change.dot(along);
      sides[change > 0] += std::abs(change);
    }
    return std::min(sides[0], sides[1]) / (longest * target_.diagonal);
  }

  // A box about the posterior: its mean, principal directions as columns, and standard deviations along them.
  struct Posterior {
    Eigen::VectorXd mean, deviation;
    Eigen::MatrixXd axes;
  };

  // By importance sampling from a box that is fitted to it again and again, while the likelihood sharpens.
  Posterior posterior(const std::vector<Beside>& beside, Posterior box) const {
    RandomStream random(draw_seed, 17);
    std::vector<Eigen::VectorXd> at(draws);
    std::vector<double> weight(draws);
    const auto k = box.axes.cols();
    for (const double sharp : {0.05, 0.2, 0.6, 1.0, 1.0}) {
      for (std::size_t i = 0; i < at.size(); ++i) {
        Eigen::VectorXd inside(k);
        for (int j = 0; j < k; ++j) inside[j] = random.uniform(-box_deviations, box_deviations) * box.deviation[j];
        at[i] = box.mean + box.axes * inside;
        weight[i] = sharp * log_likelihood(beside, at[i]);
      }
      const double most = *std::max_element(weight.begin(), weight.end());
      double sum = 0;
      box.mean.setZero();
      for (std::size_t i = 0; i < at.size(); ++i) {
        weight[i] = std::exp(weight[i] - most);
        sum += weight[i];
        box.mean += weight[i] * at[i];
      }
      box.mean /= sum;
      Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(k, k);
      for (std::size_t i = 0; i < at.size(); ++i) {
        const Eigen::VectorXd d = box.axes.transpose() * (at[i] - box.mean);
        covariance += weight[i] / sum * d * d.transpose();
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
      box.axes = (box.axes * solver.eigenvectors()).eval();
      box.deviation = solver.eigenvalues().cwiseMax(0).cwiseSqrt().array() + 0.005 * sigma_;
    }
    return box;
  }

  // @return number of the motions that were centred
  int to_middle(const std::vector<Beside>& beside, Pose& pose) {
    const auto k = motions_.cols();
    // Of the motions by themselves, those that the rim stops; then the directions that their mixture leaves free go.
    Posterior box;
    box.mean = Eigen::VectorXd::Zero(k);
    std::vector<int> stopped;
    std::vector<double> half;
    for (int m = 0; m < k; ++m)
      if (const auto r = stops(beside, box.mean, Eigen::VectorXd::Unit(k, m))) {
        stopped.push_back(m);
        half.push_back(std::max(-r->first, r->second));
      }
    box.axes = Eigen::MatrixXd::Zero(k, static_cast<Eigen::Index>(stopped.size()));
    for (std::size_t j = 0; j < stopped.size(); ++j) box.axes(stopped[j], static_cast<Eigen::Index>(j)) = 1;
    while (box.axes.cols() > 0) {
      box.deviation = Eigen::Map<const Eigen::VectorXd>(half.data(), box.axes.cols()) / box_deviations;
      const Posterior p = posterior(beside, box);
      int kept = 0;
      // The widest last. Where so many points are missing before the rim, the scan ends there and not the part.
      while (kept < p.axes.cols() && stops(beside, p.mean, p.axes.col(kept)) &&
             p.deviation[kept] * points_a_millimetre(beside, p.axes.col(kept)) <= most_missing)
        ++kept;
      if (kept == p.axes.cols()) {
        move(p.mean, pose);
        break;
      }
      // Again without the first that is not stopped, and without the wider ones.
      box.axes = p.axes.leftCols(kept).eval();
      half.assign(static_cast<std::size_t>(kept), 0);
      for (int j = 0; j < kept; ++j) {
        const auto r = stops(beside, box.mean, box.axes.col(j));
        half[static_cast<std::size_t>(j)] = r ? std::max(-r->first, r->second) : box_deviations * p.deviation[j];
      }
    }
    return static_cast<int>(box.axes.cols());
  }

  const Rim& rim_;
  const FitTarget& target_;
  const PointSample& sample_;
  Matrix6 matrix_;
  Vector6 right_;
  Eigen::Vector3d centre_;
  double radius_, sigma_;
  Context& context_;
  Motions motions_;
  std::vector<std::uint32_t> used_;
};

}  // namespace

RimFit fit_to_rim(const Rim& rim, const FitTarget& target, const PointSample& sample, const Pose& start,
                  const NormalEquations& equations, double sigma, double limit, Context& context) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.matrix);
  const int weak = weak_motions(equations, sigma, limit);
  if (weak == 0 || rim.empty()) return {start, 0, 0};
  Motions motions = solver.eigenvectors().leftCols(std::min(weak, most_motions));
  return Fit(rim, target, sample, equations, sigma, context).run(start, motions);
}

}  // namespace tri

#include "libtri/alignment/information.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

namespace tri {
namespace {

constexpr double no_turn = 0.15;         // of a unit motion: less turn than this is none
constexpr double no_pitch = 0.05;        // of the radius, a radian
constexpr std::size_t sum_block = 4096;  // summed apart, so that rounding stays small

Eigen::Vector3d with_sign(Eigen::Vector3d axis) {
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Eigen::Vector3d(-axis) : axis;
}

// The motion of a vector of the normal equations: turn times radius, shift of the centre.
Freedom freedom_of(const Vector6& x, const NormalEquations& equations) {
  Freedom freedom;
  if (x.head<3>().norm() < no_turn * x.norm()) {
    freedom.axis = with_sign(x.tail<3>().normalized());
    return freedom;
  }
  const Eigen::Vector3d turn = x.head<3>() / equations.radius, shift = x.tail<3>();
  freedom.axis = with_sign(turn.normalized());
  freedom.place = equations.centre + turn.cross(shift) / turn.squaredNorm();
  const double a_radian = turn.dot(shift) / turn.squaredNorm();
  freedom.kind = std::abs(a_radian) > no_pitch * equations.radius ? Freedom::Kind::screw : Freedom::Kind::turn;
  freedom.pitch = 2 * std::numbers::pi * a_radian;
  return freedom;
}

}  // namespace

NormalEquations::NormalEquations(std::span<const PointResidual> residuals, std::span<const double> weights) {
  const auto in_blocks = [&](const auto& body, auto& sum) {
    for (std::size_t begin = 0; begin < residuals.size(); begin += sum_block) {
      auto part = sum;
      part.setZero();
      for (std::size_t i = begin; i < std::min(residuals.size(), begin + sum_block); ++i)
        if (weights[i] > 0) body(i, part);
      sum += part;
    }
  };
  for (const double w : weights) weight += w;
  if (!(weight > 0)) return;
  in_blocks([&](std::size_t i, auto& part) { part += weights[i] * to_eigen(residuals[i].at); }, centre);
  centre /= weight;
  Eigen::Matrix<double, 1, 1> square = Eigen::Matrix<double, 1, 1>::Zero();
  in_blocks(
      [&](std::size_t i, auto& part) { part[0] += weights[i] * (to_eigen(residuals[i].at) - centre).squaredNorm(); },
      square);
  radius = std::sqrt(square[0] / weight);
  if (!(radius > 0)) radius = 1;
  Eigen::Matrix<double, 6, 7> both = Eigen::Matrix<double, 6, 7>::Zero();
  in_blocks(
      [&](std::size_t i, auto& part) {
        const Eigen::Vector3d d = to_eigen(residuals[i].direction);
        Vector6 j;
        j << (to_eigen(residuals[i].at) - centre).cross(d) / radius, d;
        part.template leftCols<6>() += weights[i] * j * j.transpose();
        part.col(6) -= weights[i] * residuals[i].value * j;
      },
      both);
  matrix = both.leftCols<6>() / weight;
  right_side = both.col(6) / weight;
}

std::string Freedom::in_words() const {
  switch (kind) {
    case Kind::slide:
      return "slides along " + tri::in_words(axis);
    case Kind::turn:
      return fmt::format("turns about the axis {} through {}", tri::in_words(axis), tri::in_words(place));
    case Kind::screw:
      return fmt::format("turns about the axis {} through {}, moving {:.4g} mm a turn along it", tri::in_words(axis),
                         tri::in_words(place), pitch);
    case Kind::swivel:
      return fmt::format("turns about every axis through {}", tri::in_words(place));
  }
  return "";
}

PoseInformation information_of(const NormalEquations& equations, double sigma, double limit) {
  PoseInformation result;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.matrix);
  int free = 0;
  for (int k = 0; k < 6; ++k) {
    result.eigenvalues[static_cast<std::size_t>(k)] = std::max(0.0, solver.eigenvalues()[k]);
    if (solver.eigenvalues()[k] < PoseInformation::unfixed) free = k + 1;
  }
  double variance = 0;
  for (int k = free; k < 6; ++k) {
    const double deviation = sigma / std::sqrt(equations.weight * solver.eigenvalues()[k]);
    variance += deviation * deviation;
    if (deviation > limit) result.weak.push_back({freedom_of(solver.eigenvectors().col(k), equations), deviation});
  }
  result.standard_deviation = std::sqrt(variance);
  if (free == 0) return result;
  // Sort the free motions into slides and turns: combinations whose turn vanishes are slides, the rest is made
  // orthogonal to them.
  const Eigen::Matrix<double, 6, Eigen::Dynamic> motions = solver.eigenvectors().leftCols(free);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(motions.topRows<3>(), Eigen::ComputeFullV);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> sorted = motions * svd.matrixV();
  std::vector<Eigen::Vector3d> slides;
  std::vector<Vector6> turns;
  for (int k = free - 1; k >= 0; --k) {
    const double turn = k < svd.singularValues().size() ? svd.singularValues()[k] : 0;
    if (turn < no_turn)
      slides.push_back(sorted.col(k).tail<3>().normalized());
    else
      turns.push_back(sorted.col(k));
  }
  for (const Eigen::Vector3d& s : slides) {
    Freedom freedom;
    freedom.kind = Freedom::Kind::slide;
    freedom.axis = with_sign(s);
    result.freedoms.push_back(freedom);
  }
  Eigen::Matrix3d place_matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d place_right = Eigen::Vector3d::Zero();
  std::vector<Freedom> found;
  for (const Vector6& t : turns) {
    const Eigen::Vector3d turn = t.head<3>() / equations.radius;
    Eigen::Vector3d shift = t.tail<3>();
    for (const Eigen::Vector3d& s : slides) shift -= s * s.dot(shift);
    Vector6 across = t;
    across.tail<3>() = shift;
    found.push_back(freedom_of(across, equations));
    // The one point that all the turns leave where it is: turn x (place - centre) = -shift.
    Eigen::Matrix3d cross;
    cross << 0, -turn[2], turn[1], turn[2], 0, -turn[0], -turn[1], turn[0], 0;
    place_matrix += cross.transpose() * cross;
    place_right -= cross.transpose() * shift;
  }
  if (turns.size() == 3) {
    Freedom freedom;
    freedom.kind = Freedom::Kind::swivel;
    freedom.axis = {0, 0, 1};
    freedom.place = equations.centre + place_matrix.ldlt().solve(place_right);
    result.freedoms.push_back(freedom);
  } else {
    result.freedoms.insert(result.freedoms.end(), found.begin(), found.end());
  }
  return result;
}

namespace {

int count_weak(const Eigen::SelfAdjointEigenSolver<Matrix6>& solver, const NormalEquations& equations, double sigma,
               double limit) {
  int weak = 0;
  while (weak < 6 && (solver.eigenvalues()[weak] < PoseInformation::unfixed ||
                      sigma / std::sqrt(equations.weight * solver.eigenvalues()[weak]) > limit))
    ++weak;
  return weak;
}

}  // namespace

int weak_motions(const NormalEquations& equations, double sigma, double limit) {
  return count_weak(Eigen::SelfAdjointEigenSolver<Matrix6>(equations.matrix), equations, sigma, limit);
}

Pose firm_step(const NormalEquations& equations, double sigma, double limit) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.matrix);
  const int firm = 6 - count_weak(solver, equations, sigma, limit);
  const auto motions = solver.eigenvectors().rightCols(firm);
  const Vector6 x =
      motions * (motions.transpose() * equations.right_side).cwiseQuotient(solver.eigenvalues().tail(firm));
  return motion(x.head<3>() / equations.radius, x.tail<3>(), equations.centre);
}

bool is_free(const Pose& motion, std::span<const Freedom> freedoms, const Vec3& centre, double radius,
             double tolerance) {
  const MotionParts parts = parts_of(motion, centre);
  const bool turned = parts.angle * radius > tolerance;
  Eigen::Vector3d place = to_eigen(centre);
  bool axis_free = !turned;
  for (const Freedom& f : freedoms) {
    if (f.kind == Freedom::Kind::slide) continue;
    place = f.place;
    if (f.kind == Freedom::Kind::swivel || parts.angle * f.axis.cross(parts.axis).norm() * radius <= tolerance)
      axis_free = true;
  }
  if (!axis_free) return false;
  Eigen::Vector3d left = motion.rotation * place + motion.translation - place;
  std::vector<Eigen::Vector3d> slides;
  for (const Freedom& f : freedoms) {
    if (f.kind == Freedom::Kind::slide) slides.push_back(f.axis);
    if (f.kind == Freedom::Kind::screw)
      left -= f.axis * (f.axis.dot(parts.axis) * parts.angle * f.pitch / (2 * std::numbers::pi));
  }
  for (const Eigen::Vector3d& s : slides) left -= s * s.dot(left);
  return left.norm() <= tolerance;
}

}  // namespace tri

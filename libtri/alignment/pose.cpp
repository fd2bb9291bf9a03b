#include "libtri/alignment/pose.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr double rigid_tolerance = 1e-5;
constexpr double collinear_share = 1e-6;
constexpr double smallest_turn = 0.05 * std::numbers::pi / 180;  // told as a turn from here on

// The rotation nearest to `m` [Umeyama 1991].
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, 1);
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign[2] = -1;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

std::array<std::array<double, 4>, 4> Pose::matrix() const {
  std::array<std::array<double, 4>, 4> m{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m[r][c] = rotation(r, c);
    m[r][3] = translation[r];
  }
  m[3][3] = 1;
  return m;
}

Pose pose_of(const std::array<std::array<double, 4>, 4>& matrix) {
  Pose pose;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      if (!std::isfinite(matrix[r][c])) throw InvalidInput("pose: an entry of the matrix is not finite");
  for (int c = 0; c < 4; ++c)
    if (std::abs(matrix[3][c] - (c == 3 ? 1 : 0)) > rigid_tolerance)
      throw InvalidInput("pose: the last row of the matrix is not 0 0 0 1");
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.rotation(r, c) = matrix[r][c];
    pose.translation[r] = matrix[r][3];
  }
  const double error = (pose.rotation.transpose() * pose.rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= rigid_tolerance))
    throw InvalidInput(fmt::format("pose: the matrix is no rigid motion: its axes are off by {:.3g}", error));
  if (pose.rotation.determinant() < 0) throw InvalidInput("pose: the matrix mirrors");
  // A matrix that is exact to rounding stays as it is.
  if (error > 1e-15) pose.rotation = nearest_rotation(pose.rotation);
  return pose;
}

Pose motion(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift, const Eigen::Vector3d& centre) {
  Pose pose;
  const double angle = turn.norm();
  if (angle > 0) pose.rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  pose.translation = centre - pose.rotation * centre + shift;
  return pose;
}

Pose fit_pose(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
  if (from.size() != to.size() || (!weights.empty() && weights.size() != from.size()))
    throw InvalidInput("fit_pose: as many places as points are needed");
  if (from.size() < 3)
    throw InvalidInput(fmt::format("{} pairs of points are too few for a pose: 3 are needed", from.size()));
  const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  double sum = 0;
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    sum += weight(i);
    a += weight(i) * to_eigen(from[i]);
    b += weight(i) * to_eigen(to[i]);
  }
  if (!(sum > 0)) throw InvalidInput("fit_pose: all weights are zero");
  a /= sum;
  b /= sum;
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero(), spread_a = cross, spread_b = cross;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d x = to_eigen(from[i]) - a, y = to_eigen(to[i]) - b;
    cross += weight(i) * y * x.transpose();
    spread_a += weight(i) * x * x.transpose();
    spread_b += weight(i) * y * y.transpose();
  }
  for (const Eigen::Matrix3d& spread : {spread_a, spread_b}) {
    const Eigen::Vector3d s = Eigen::JacobiSVD<Eigen::Matrix3d>(spread).singularValues();
    if (!(s[1] > collinear_share * collinear_share * s[0]))
      throw InvalidInput("the points of the pairs lie on one line or in one place, so that a turn stays free");
  }
  Pose pose;
  pose.rotation = nearest_rotation(cross);
  pose.translation = b - pose.rotation * a;
  return pose;
}

MotionParts parts_of(const Pose& motion, const Vec3& centre) {
  MotionParts parts;
  const Eigen::Vector3d c = to_eigen(centre);
  parts.shift = motion.rotation * c + motion.translation - c;
  const Eigen::AngleAxisd turn(motion.rotation);
  parts.angle = turn.angle();
  parts.axis = turn.axis();
  if (parts.angle > std::numbers::pi) {
    parts.angle = 2 * std::numbers::pi - parts.angle;
    parts.axis = -parts.axis;
  }
  int largest = 0;
  parts.axis.cwiseAbs().maxCoeff(&largest);
  if (parts.angle > std::numbers::pi - 1e-2 && parts.axis[largest] < 0) parts.axis = -parts.axis;
  parts.slide = parts.axis.dot(parts.shift);
  // place + c is fixed up to the slide: (I - R) place = shift - slide * axis.
  const Eigen::Vector3d across = parts.shift - parts.slide * parts.axis;
  const double half = 0.5 * parts.angle;
  parts.place = c;
  if (half > 0) parts.place += 0.5 * (across + parts.axis.cross(across) / std::tan(half));
  return parts;
}

std::string in_words(const Eigen::Vector3d& v) {
  const double smallest = 1e-4 * v.cwiseAbs().maxCoeff();
  const auto number = [&](double x) { return std::abs(x) <= smallest ? 0.0 : x; };
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", number(v[0]), number(v[1]), number(v[2]));
}

std::string in_words(const Pose& motion, const Vec3& centre, double size) {
  const MotionParts parts = parts_of(motion, centre);
  if (parts.angle < smallest_turn) return fmt::format("moved by {} mm", in_words(parts.shift));
  // The sign of an axis below half a turn: the largest component positive, the angle with a sign.
  Eigen::Vector3d axis = parts.axis;
  double degrees = parts.angle * 180 / std::numbers::pi, slide = parts.slide;
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) {
    axis = -axis;
    degrees = -degrees;
    slide = -slide;
  }
  const double unit = 1e-3 * size;  // blanks out what the part is too small to show
  const auto rounded = [&](const Eigen::Vector3d& v) {
    Eigen::Vector3d r = v;
    for (int k = 0; k < 3; ++k)
      if (std::abs(r[k]) < unit) r[k] = 0;
    return r;
  };
  std::string text = fmt::format("turned by {:.4g} degrees about {} through {}", degrees, in_words(axis),
                                 in_words(rounded(parts.place)));
  if (std::abs(slide) > unit) text += fmt::format(" and moved by {:.4g} mm along it", slide);
  return text;
}

}  // namespace tri

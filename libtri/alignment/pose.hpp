#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>

#include "meshops/vec.hpp"

namespace tri {

/// The same three numbers, for Eigen.
inline Eigen::Vector3d to_eigen(const Vec3& v) {
  return {v[0], v[1], v[2]};
}
/// The same three numbers, for OpenMesh.
inline Vec3 to_vec(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

/// A rigid motion: x becomes rotation * x + translation (mm).
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< orthonormal, determinant +1
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   ///< mm; applied after the rotation

  /// Where a point goes.
  Vec3 operator()(const Vec3& p) const { return to_vec(rotation * to_eigen(p) + translation); }
  /// A direction, which is turned and not moved.
  Vec3 turn(const Vec3& d) const { return to_vec(rotation * to_eigen(d)); }
  /// First `other`, then this.
  Pose operator*(const Pose& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  /// The motion that takes everything back, but for rounding.
  Pose inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
  /// True if every number is exactly that of the identity: no point changes by a bit.
  bool is_identity() const { return rotation.isIdentity(0) && translation.isZero(0); }
  /// Row-major 4x4, last row 0 0 0 1.
  std::array<std::array<double, 4>, 4> matrix() const;
};

/// The pose of a row-major 4x4 matrix; its rotation is made orthonormal to rounding.
/// @throws InvalidInput unless the last row is 0 0 0 1 and the rest a rotation (no mirror, no scale) to 1e-5.
Pose pose_of(const std::array<std::array<double, 4>, 4>& matrix);

/// Turns by |turn| radians about the axis `turn` through `centre`, then moves by `shift` (mm).
Pose motion(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift, const Eigen::Vector3d& centre);

/// The motion that takes `from` onto `to` with the least sum of weighted squares [Kabsch 1976, Umeyama 1991].
///
/// @param weights  >= 0, one a pair; empty for equal weights
/// @throws InvalidInput if there are fewer than three pairs or they lie on one line (to 1e-6 of their extent), so that
///         a turn about it stays free.
Pose fit_pose(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights = {});

/// A rigid motion as a person describes it.
struct MotionParts {
  double angle = 0;                                 ///< rad, in [0, pi]
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();   ///< unit; for half turns the largest component is positive
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of the axis, the point nearest to the centre asked for
  double slide = 0;                                 ///< mm, along the axis
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< mm, where the centre goes, relative to where it was
};
/// Takes a motion apart. @param centre  mm; the axis is given by its point nearest to this one
MotionParts parts_of(const Pose& motion, const Vec3& centre);

/// "turned by 180 degrees about (0, 0, 1) through (10, 5, 0)" or "moved by (0, 2, 0) mm".
/// @param centre  of the part; the axis is named by its point nearest to it
/// @param size    mm, of the part: motions are told apart to about 1e-3 of it
std::string in_words(const Pose& motion, const Vec3& centre, double size);

/// "(0, 0, 1)", three digits, without "-0".
std::string in_words(const Eigen::Vector3d& v);

}  // namespace tri

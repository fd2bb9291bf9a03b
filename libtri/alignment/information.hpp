#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "libtri/alignment/exact_fit.hpp"
#include "libtri/alignment/pose.hpp"

namespace tri {

/// A turn (times a radius) and a shift: three numbers each, lengths in mm.
using Vector6 = Eigen::Matrix<double, 6, 1>;
/// A quadratic form over such motions.
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// J^T W J of point-to-plane residuals and its right side, over the turns (times `radius`, so that all six are lengths)
/// and the shifts of the points about their centre.
struct NormalEquations {
  /// @param weights  one a residual, >= 0; their sum above 0
  NormalEquations(std::span<const PointResidual> residuals, std::span<const double> weights);

  Matrix6 matrix = Matrix6::Zero();                  ///< divided by the sum of weights: eigenvalues lie in [0, 2]
  Vector6 right_side = Vector6::Zero();              ///< divided likewise
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< weighted mean of the points, mm
  double radius = 1;                                 ///< mm, rms distance of the points from it
  double weight = 0;                                 ///< sum of the weights
};

/// A motion of the posed points that their distances to the model do not change.
struct Freedom {
  /// How the points can move without a change of their distances.
  enum class Kind {
    slide,  ///< along `axis`
    turn,   ///< about `axis` through `place`
    screw,  ///< about `axis` through `place`, moving `pitch` mm a turn along it
    swivel  ///< about any axis through `place`
  };
  Kind kind = Kind::slide;                          ///< one of the four
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();   ///< unit, the largest component positive
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< mm
  double pitch = 0;                                 ///< mm
  std::string in_words() const;                     ///< "slides along (0, 0, 1)"
};

/// What the distances of points to the model say of their pose, and what they leave open.
struct PoseInformation {
  /// Ascending eigenvalues of the normal equations: mean squared change of the distances for a unit motion. Below
  /// `unfixed` the points do not fix that motion.
  std::array<double, 6> eigenvalues{};
  static constexpr double unfixed = 1e-5;  ///< least eigenvalue of a motion that counts as fixed
  /// Motions that the points do not fix.
  std::vector<Freedom> freedoms;
  /// A motion that they fix badly.
  struct Weak {
    Freedom motion;                 ///< by which the points can move and hardly change their distances
    double standard_deviation = 0;  ///< mm, rms over the points
  };
  /// Motions that are fixed, but badly.
  std::vector<Weak> weak;
  double standard_deviation = 0;  ///< mm, rms over the points of what noise does to the pose, without the free motions
};

/// @param sigma  mm, of the noise, which is taken to be independent from point to point
/// @param limit  mm: motions with a larger standard deviation are weak
PoseInformation information_of(const NormalEquations& equations, double sigma, double limit);

/// How many of the six motions the points fix badly or not at all: those of the lowest eigenvalues.
/// @param sigma, limit  as `information_of`
int weak_motions(const NormalEquations& equations, double sigma, double limit);

/// The step of Gauss and Newton along the others.
Pose firm_step(const NormalEquations& equations, double sigma, double limit);

/// True if `motion` is made up of `freedoms` only, to `tolerance` mm over points up to `radius` mm from `centre`.
bool is_free(const Pose& motion, std::span<const Freedom> freedoms, const Vec3& centre, double radius,
             double tolerance);

}  // namespace tri

#pragma once

#include <vector>

#include "libtri/surfaces/bspline_basis.hpp"
#include "libtri/surfaces/third_order.hpp"

namespace tri {

/// A tensor-product B-spline surface of any degree up to 25, rational or not, periodic or not; a Bezier surface is one
/// span.
class BSplineSurface : public ThirdOrderSurface {
 public:
  /// @param poles   u.count() rows of v.count() control points
  /// @param weights as many, all positive, or empty for a surface that is not rational
  /// @throws CadError if the sizes do not fit or a weight is not positive.
  BSplineSurface(BSplineBasis u, BSplineBasis v, const std::vector<Vec3>& poles, const std::vector<double>& weights);

  Vec3 point(double u, double v) const override;
  SurfacePoint evaluate(double u, double v) const override { return evaluate_(*this, u, v); }
  double u_period() const override { return u_.period(); }
  double v_period() const override { return v_.period(); }
  SurfaceBounds bounds(double u0, double u1, double v0, double v1) const override;
  std::vector<ParameterBreak> u_breaks() const override { return u_.breaks(); }
  std::vector<ParameterBreak> v_breaks() const override { return v_.breaks(); }

  /// Partial derivatives out[k][l] for k + l <= order (at most 3), k in u, l in v.
  void derivatives(double u, double v, int order, Vec3 out[4][4]) const;

  void third_derivatives(double u, double v, Vec3 out[4]) const override;

  bool rational() const { return rational_; }

 private:
  template <int PU, int PV, bool Rational>
  static SurfacePoint evaluate_table(const BSplineSurface& s, double u, double v);
  template <bool Rational>
  static SurfacePoint evaluate_nets(const BSplineSurface& s, double u, double v);
  void make_nets();
  // The Bezier points over a rectangle within one span, row by row of equal u index.
  void bezier_net(int su, int sv, double u0, double u1, double v0, double v1, std::vector<double>& net) const;
  void span_bounds(int su, int sv, double u0, double u1, double v0, double v1, double out[4][4]) const;

  BSplineBasis u_, v_;
  bool rational_;
  int dimension_;              // doubles per control point: 3, or 4 for (wx, wy, wz, w)
  std::vector<double> poles_;  // row by row of equal u index
  std::vector<double> nets_;  // Bezier points of every span, row by row of the direction of the higher degree; or empty
  bool v_first_ = false;      // that is v
  SurfacePoint (*evaluate_)(const BSplineSurface&, double, double) = nullptr;
};

}  // namespace tri

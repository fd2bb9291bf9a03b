#include "libtri/surfaces/curve_types.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshops/error.hpp"

namespace tri {

namespace {

template <class Vec>
constexpr int dimension = static_cast<int>(Vec::size_);

template <class Vec>
Vec filled(double x) {
  Vec v;
  for (int c = 0; c < dimension<Vec>; ++c) v[c] = x;
  return v;
}

// Closed curves tell their period in space only; pcurves are cut to their edge.
template <class Vec>
class CurveBase : public CurveIn<Vec> {};
template <>
class CurveBase<Vec3> : public Curve3 {
 public:
  explicit CurveBase(double period = 0) : period_(period) {}
  double period() const override { return period_; }

 private:
  double period_;
};
template <>
class CurveBase<Vec2> : public Curve2 {
 public:
  explicit CurveBase(double = 0) {}
};

template <class Vec>
class Line final : public CurveBase<Vec> {
 public:
  Line(const Vec& o, const Vec& d) : o_(o), d_(d) {}
  Vec point(double t) const override { return o_ + d_ * t; }
  CurvePointIn<Vec> evaluate(double t) const override { return {point(t), d_, filled<Vec>(0)}; }
  CurveBounds<Vec> bounds(double, double) const override {
    Vec d;
    for (int c = 0; c < dimension<Vec>; ++c) d[c] = std::abs(d_[c]);
    return {d, filled<Vec>(0), filled<Vec>(0)};
  }

 private:
  Vec o_, d_;
};

template <class Vec>
class Ellipse final : public CurveBase<Vec> {
 public:
  Ellipse(const Vec& o, const Vec& x, const Vec& y) : CurveBase<Vec>(2 * std::numbers::pi), o_(o), x_(x), y_(y) {}
  Vec point(double t) const override { return o_ + x_ * std::cos(t) + y_ * std::sin(t); }
  CurvePointIn<Vec> evaluate(double t) const override {
    const double c = std::cos(t), s = std::sin(t);
    const Vec r = x_ * c + y_ * s;
    return {o_ + r, y_ * c - x_ * s, -r};
  }
  Vec third_derivative(double t) const override { return x_ * std::sin(t) - y_ * std::cos(t); }
  CurveBounds<Vec> bounds(double, double) const override {
    Vec d;
    for (int c = 0; c < dimension<Vec>; ++c) d[c] = std::hypot(x_[c], y_[c]);
    return {d, d, d};
  }

 private:
  Vec o_, x_, y_;
};

template <class Vec>
class Parabola final : public CurveBase<Vec> {
 public:
  Parabola(const Vec& o, const Vec& x, const Vec& y) : o_(o), x_(x), y_(y) {}
  Vec point(double t) const override { return o_ + x_ * (t * t) + y_ * t; }
  CurvePointIn<Vec> evaluate(double t) const override { return {point(t), x_ * (2 * t) + y_, x_ * 2.0}; }
  CurveBounds<Vec> bounds(double t0, double t1) const override {
    const double t = std::max(std::abs(t0), std::abs(t1));
    Vec d, dd;
    for (int c = 0; c < dimension<Vec>; ++c) {
      dd[c] = 2 * std::abs(x_[c]);
      d[c] = dd[c] * t + std::abs(y_[c]);
    }
    return {d, dd, filled<Vec>(0)};
  }

 private:
  Vec o_, x_, y_;
};

template <class Vec>
class Hyperbola final : public CurveBase<Vec> {
 public:
  Hyperbola(const Vec& o, const Vec& x, const Vec& y) : o_(o), x_(x), y_(y) {}
  Vec point(double t) const override { return o_ + x_ * std::cosh(t) + y_ * std::sinh(t); }
  CurvePointIn<Vec> evaluate(double t) const override {
    const double c = std::cosh(t), s = std::sinh(t);
    const Vec r = x_ * c + y_ * s;
    return {o_ + r, x_ * s + y_ * c, r};
  }
  Vec third_derivative(double t) const override { return x_ * std::sinh(t) + y_ * std::cosh(t); }
  CurveBounds<Vec> bounds(double t0, double t1) const override {
    const double t = std::max(std::abs(t0), std::abs(t1));
    Vec d;
    for (int c = 0; c < dimension<Vec>; ++c) d[c] = (std::abs(x_[c]) + std::abs(y_[c])) * std::cosh(t);
    return {d, d, d};
  }

 private:
  Vec o_, x_, y_;
};

template <class Vec>
class BSplineCurve final : public CurveBase<Vec> {
 public:
  static constexpr int dim = dimension<Vec>;

  BSplineCurve(BSplineBasis basis, const std::vector<Vec>& poles, const std::vector<double>& weights)
      : CurveBase<Vec>(basis.period()), basis_(std::move(basis)), rational_(!weights.empty()),
        n_(dim + (rational_ ? 1 : 0)) {
    const std::size_t count = basis_.count();
    if (poles.size() != count || (rational_ && weights.size() != count))
      throw CadError("b-spline curve: number of poles does not fit the knots");
    for (std::size_t i = 0; i < count; ++i) {
      const double w = rational_ ? weights[i] : 1;
      if (!(w > 0)) throw CadError("b-spline curve: a weight is not positive");
      for (int c = 0; c < dim; ++c) poles_.push_back(poles[i][c] * w);
      if (rational_) poles_.push_back(w);
    }
  }
  Vec point(double t) const override {
    Vec out[4];
    derivatives(t, 0, out);
    return out[0];
  }
  CurvePointIn<Vec> evaluate(double t) const override {
    Vec out[4];
    derivatives(t, 2, out);
    return {out[0], out[1], out[2]};
  }
  Vec third_derivative(double t) const override {
    Vec out[4];
    derivatives(t, 3, out);
    return out[3];
  }
  std::vector<ParameterBreak> breaks() const override { return basis_.breaks(); }

  CurveBounds<Vec> bounds(double t0, double t1) const override {
    CurveBounds<Vec> most{filled<Vec>(0), filled<Vec>(0), filled<Vec>(0)};
    basis_.for_each_piece(t0, t1, [&](int s, double a, double b) { add_span_bounds(s, a, b, most); });
    return most;
  }

 private:
  static constexpr double choose[4][4] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 2, 1, 0}, {1, 3, 3, 1}};

  void derivatives(double t, int order, Vec out[4]) const {
    double b[4 * (BSplineBasis::max_degree + 1)];
    t = basis_.wrapped(t);
    const int s = basis_.span(t), p = basis_.degree();
    if (order <= 2)
      basis_.values2(s, t, b);
    else
      basis_.derivatives(s, t, order, b);
    const double* poles = poles_.data() + static_cast<std::ptrdiff_t>(basis_.first_control(s)) * n_;
    double a[4][dim + 1] = {};
    for (int k = 0; k <= order; ++k)
      for (int i = 0; i <= p; ++i)
        for (int c = 0; c < n_; ++c) a[k][c] += b[k * (p + 1) + i] * poles[i * n_ + c];
    for (int k = 0; k <= order; ++k) {
      for (int c = 0; c < dim; ++c) out[k][c] = a[k][c];
      if (!rational_) continue;
      for (int i = 1; i <= k; ++i) out[k] -= out[k - i] * (choose[k][i] * a[i][dim]);
      out[k] /= a[0][dim];
    }
  }

  void add_span_bounds(int s, double a, double b, CurveBounds<Vec>& most) const {
    const int m = basis_.degree() + 1;
    std::vector<double> to(m * m), net(m * n_);
    basis_.bezier_matrix(s, a, b, to.data());
    const double* poles = poles_.data() + static_cast<std::ptrdiff_t>(basis_.first_control(s)) * n_;
    for (int i = 0; i < m; ++i)
      for (int k = 0; k < m; ++k)
        for (int c = 0; c < n_; ++c) net[i * n_ + c] += to[i * m + k] * poles[k * n_ + c];
    double w_min = 1;
    if (rational_) {
      const double* q = net.data() + (m / 2) * n_;
      Vec center;
      for (int c = 0; c < dim; ++c) center[c] = q[c] / q[dim];
      w_min = q[dim];
      for (int i = 0; i < m; ++i) {
        for (int c = 0; c < dim; ++c) net[i * n_ + c] -= center[c] * net[i * n_ + dim];
        w_min = std::min(w_min, net[i * n_ + dim]);
      }
    }
    double bound[4][dim + 1] = {};
    double factor = 1;
    for (int k = 0; k < 4 && k < m; ++k) {
      for (int i = 0; i < m - k; ++i)
        for (int c = 0; c < n_; ++c) bound[k][c] = std::max(bound[k][c], std::abs(net[i * n_ + c]) * factor);
      for (int i = 0; i + 1 < m - k; ++i)
        for (int c = 0; c < n_; ++c) net[i * n_ + c] = net[(i + 1) * n_ + c] - net[i * n_ + c];
      factor *= (m - 1 - k) / (b - a);
    }
    if (rational_) {
      for (int k = 0; k < 4; ++k) {
        for (int c = 0; c < dim; ++c) {
          for (int i = 1; i <= k; ++i) bound[k][c] += choose[k][i] * bound[i][dim] * bound[k - i][c];
          bound[k][c] = w_min > 0 ? bound[k][c] / w_min : SurfaceBounds::unknown;
        }
      }
    }
    for (int c = 0; c < dim; ++c) {
      most.d[c] = std::max(most.d[c], bound[1][c]);
      most.dd[c] = std::max(most.dd[c], bound[2][c]);
      most.ddd[c] = std::max(most.ddd[c], bound[3][c]);
    }
  }

  BSplineBasis basis_;
  bool rational_;
  int n_;  // doubles per pole
  std::vector<double> poles_;
};

// base + distance * m / |m| with m linear in the tangent: turned by -90 degrees, or crossed with a direction.
template <class Vec>
class Offset final : public CurveBase<Vec> {
 public:
  Offset(CurvePtr<Vec> base, double distance, const Vec3& direction)
      : base_(std::move(base)), distance_(distance), z_(direction) {}

  Vec point(double t) const override {
    const CurvePointIn<Vec> b = base_->evaluate(t);
    return b.p + turned(b.d) * (distance_ / turned(b.d).norm());
  }
  CurvePointIn<Vec> evaluate(double t) const override {
    const CurvePointIn<Vec> b = base_->evaluate(t);
    const Vec m = turned(b.d), dm = turned(b.dd), ddm = turned(base_->third_derivative(t));
    const double length = m.norm();
    const Vec n = m / length;
    // n' = (m' - n l') / l, n'' = (m'' - 2 n' l' - n l'') / l with l' = n.m', l'' = n.m'' + n'.m'.
    const double dl = n | dm;
    const Vec dn = (dm - n * dl) / length;
    const double ddl = (n | ddm) + (dn | dm);
    const Vec ddn = (ddm - dn * (2 * dl) - n * ddl) / length;
    return {b.p + n * distance_, b.d + dn * distance_, b.dd + ddn * distance_};
  }
  CurveBounds<Vec> bounds(double t0, double t1) const override {
    const CurveBounds<Vec> b = base_->bounds(t0, t1);
    const double m = turned(base_->evaluate((t0 + t1) / 2).d).norm() - b.dd.norm() * (t1 - t0) / 2;
    CurveBounds<Vec> out{filled<Vec>(SurfaceBounds::unknown), filled<Vec>(SurfaceBounds::unknown),
                         filled<Vec>(SurfaceBounds::unknown)};
    if (m <= 0) return out;
    const double r = b.dd.norm() / m, o = std::abs(distance_);
    out.d = b.d + filled<Vec>(o * r);
    out.dd = b.dd + filled<Vec>(o * (2 * b.ddd.norm() / m + 5 * r * r));
    return out;
  }
  std::vector<ParameterBreak> breaks() const override {
    std::vector<ParameterBreak> result = base_->breaks();
    for (ParameterBreak& b : result) b.continuity = std::max(0, b.continuity - 1);
    return result;
  }

 private:
  Vec turned(const Vec& d) const {
    if constexpr (dimension<Vec> == 2)
      return Vec(d[1], -d[0]);
    else
      return d % z_;
  }

  CurvePtr<Vec> base_;
  double distance_;
  Vec3 z_;
};

}  // namespace

template <class Vec>
CurvePtr<Vec> make_line(const Vec& origin, const Vec& direction) {
  return std::make_shared<Line<Vec>>(origin, direction);
}
template <class Vec>
CurvePtr<Vec> make_ellipse(const Vec& origin, const Vec& x, const Vec& y) {
  return std::make_shared<Ellipse<Vec>>(origin, x, y);
}
template <class Vec>
CurvePtr<Vec> make_parabola(const Vec& origin, const Vec& x, const Vec& y) {
  return std::make_shared<Parabola<Vec>>(origin, x, y);
}
template <class Vec>
CurvePtr<Vec> make_hyperbola(const Vec& origin, const Vec& x, const Vec& y) {
  return std::make_shared<Hyperbola<Vec>>(origin, x, y);
}
template <class Vec>
CurvePtr<Vec> make_bspline_curve(BSplineBasis basis, const std::vector<Vec>& poles,
                                 const std::vector<double>& weights) {
  return std::make_shared<BSplineCurve<Vec>>(std::move(basis), poles, weights);
}

CurvePtr<Vec2> make_offset_curve(CurvePtr<Vec2> base, double distance) {
  return std::make_shared<Offset<Vec2>>(std::move(base), distance, Vec3(0, 0, 1));
}
CurvePtr<Vec3> make_offset_curve(CurvePtr<Vec3> base, double distance, const Vec3& direction) {
  return std::make_shared<Offset<Vec3>>(std::move(base), distance, direction);
}

template CurvePtr<Vec2> make_line(const Vec2&, const Vec2&);
template CurvePtr<Vec3> make_line(const Vec3&, const Vec3&);
template CurvePtr<Vec2> make_ellipse(const Vec2&, const Vec2&, const Vec2&);
template CurvePtr<Vec3> make_ellipse(const Vec3&, const Vec3&, const Vec3&);
template CurvePtr<Vec2> make_parabola(const Vec2&, const Vec2&, const Vec2&);
template CurvePtr<Vec3> make_parabola(const Vec3&, const Vec3&, const Vec3&);
template CurvePtr<Vec2> make_hyperbola(const Vec2&, const Vec2&, const Vec2&);
template CurvePtr<Vec3> make_hyperbola(const Vec3&, const Vec3&, const Vec3&);
template CurvePtr<Vec2> make_bspline_curve(BSplineBasis, const std::vector<Vec2>&, const std::vector<double>&);
template CurvePtr<Vec3> make_bspline_curve(BSplineBasis, const std::vector<Vec3>&, const std::vector<double>&);

}  // namespace tri

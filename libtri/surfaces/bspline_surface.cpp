#include "libtri/surfaces/bspline_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "meshops/error.hpp"

namespace tri {

namespace {

constexpr double choose[4][4] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 2, 1, 0}, {1, 3, 3, 1}};

using Evaluator = SurfacePoint (*)(const BSplineSurface&, double, double);

}  // namespace

namespace {

// Control points and the values, first and second derivatives of the functions that belong to them in both directions.
// The first direction is summed up first: whole rows of control points at a time.
template <int PA, int PB, bool Rational>
SurfacePoint sum_up(const double* poles, std::ptrdiff_t stride, int pa, int pb, const double* fa, const double* fb) {
  constexpr int n = Rational ? 4 : 3;
  constexpr int mb = PB > 0 ? PB + 1 : BSplineBasis::max_degree + 1;
  if constexpr (PA > 0) pa = PA;
  if constexpr (PB > 0) pb = PB;
  double r0[mb * n], r1[mb * n], r2[mb * n];
  const int width = (pb + 1) * n;
  for (int x = 0; x < width; ++x) {
    const double q = poles[x];
    r0[x] = fa[0] * q;
    r1[x] = fa[pa + 1] * q;
    r2[x] = fa[2 * (pa + 1)] * q;
  }
  for (int i = 1; i <= pa; ++i) {
    const double* row = poles + i * stride;
    const double f0 = fa[i], f1 = fa[pa + 1 + i], f2 = fa[2 * (pa + 1) + i];
    for (int x = 0; x < width; ++x) {
      const double q = row[x];
      r0[x] += f0 * q;
      r1[x] += f1 * q;
      r2[x] += f2 * q;
    }
  }
  double a00[n] = {}, a10[n] = {}, a01[n] = {}, a20[n] = {}, a11[n] = {}, a02[n] = {};
  for (int j = 0; j <= pb; ++j) {
    const double f0 = fb[j], f1 = fb[pb + 1 + j], f2 = fb[2 * (pb + 1) + j];
    for (int c = 0; c < n; ++c) {
      const double q0 = r0[j * n + c], q1 = r1[j * n + c];
      a00[c] += f0 * q0;
      a01[c] += f1 * q0;
      a02[c] += f2 * q0;
      a10[c] += f0 * q1;
      a11[c] += f1 * q1;
      a20[c] += f0 * r2[j * n + c];
    }
  }
  SurfacePoint out;
  if constexpr (!Rational) {
    out.p = Vec3(a00);
    out.du = Vec3(a10);
    out.dv = Vec3(a01);
    out.duu = Vec3(a20);
    out.duv = Vec3(a11);
    out.dvv = Vec3(a02);
  } else {
    const double w = 1 / a00[3];
    for (int c = 0; c < 3; ++c) {
      const double p = a00[c] * w;
      const double du = (a10[c] - a10[3] * p) * w, dv = (a01[c] - a01[3] * p) * w;
      out.p[c] = p;
      out.du[c] = du;
      out.dv[c] = dv;
      out.duu[c] = (a20[c] - 2 * a10[3] * du - a20[3] * p) * w;
      out.duv[c] = (a11[c] - a10[3] * dv - a01[3] * du - a11[3] * p) * w;
      out.dvv[c] = (a02[c] - 2 * a01[3] * dv - a02[3] * p) * w;
    }
  }
  return out;
}

}  // namespace

// Degrees of 0 stand for any, known at run time only.
template <int PU, int PV, bool Rational>
SurfacePoint BSplineSurface::evaluate_table(const BSplineSurface& s, double u, double v) {
  constexpr int n = Rational ? 4 : 3;
  constexpr int most = BSplineBasis::max_degree;
  u = s.u_.wrapped(u);
  v = s.v_.wrapped(v);
  const int su = s.u_.span(u), sv = s.v_.span(v);
  double fu[3 * (PU > 0 ? PU + 1 : most + 1)], fv[3 * (PV > 0 ? PV + 1 : most + 1)];
  s.u_.values2<PU>(su, u, fu);
  s.v_.values2<PV>(sv, v, fv);
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(s.v_.count()) * n;
  const double* poles =
      s.poles_.data() + s.u_.first_control(su) * stride + static_cast<std::ptrdiff_t>(s.v_.first_control(sv)) * n;
  return sum_up<PU, PV, Rational>(poles, stride, s.u_.degree(), s.v_.degree(), fu, fv);
}

template <bool Rational>
SurfacePoint BSplineSurface::evaluate_nets(const BSplineSurface& s, double u, double v) {
  constexpr int n = Rational ? 4 : 3;
  const BSplineBasis &a = s.v_first_ ? s.v_ : s.u_, &b = s.v_first_ ? s.u_ : s.v_;
  const double ta = a.wrapped(s.v_first_ ? v : u), tb = b.wrapped(s.v_first_ ? u : v);
  const int sa = a.span(ta), sb = b.span(tb), pa = a.degree(), pb = b.degree();
  double fa[3 * (BSplineBasis::max_degree + 1)], fb[3 * (BSplineBasis::max_degree + 1)];
  a.bernstein2(sa, ta, fa);
  b.bernstein2(sb, tb, fb);
  const std::size_t size = static_cast<std::size_t>(pa + 1) * (pb + 1) * n;
  const double* net = s.nets_.data() + (static_cast<std::size_t>(sa) * b.span_count() + sb) * size;
  SurfacePoint out = sum_up<0, 0, Rational>(net, static_cast<std::ptrdiff_t>(pb + 1) * n, pa, pb, fa, fb);
  if (s.v_first_) {
    std::swap(out.du, out.dv);
    std::swap(out.duu, out.dvv);
  }
  return out;
}

void BSplineSurface::make_nets() {
  v_first_ = v_.degree() > u_.degree();
  const int mu = u_.degree() + 1, mv = v_.degree() + 1, n = dimension_;
  const std::size_t size = static_cast<std::size_t>(mu) * mv * n;
  nets_.resize(size * u_.span_count() * v_.span_count());
  std::vector<double> net(size);
  for (int su = 0; su < u_.span_count(); ++su) {
    for (int sv = 0; sv < v_.span_count(); ++sv) {
      bezier_net(su, sv, u_.span_begin(su), u_.span_end(su), v_.span_begin(sv), v_.span_end(sv), net);
      const std::size_t at = v_first_ ? static_cast<std::size_t>(sv) * u_.span_count() + su
                                      : static_cast<std::size_t>(su) * v_.span_count() + sv;
      for (int i = 0; i < mu; ++i)
        for (int j = 0; j < mv; ++j)
          std::copy_n(net.data() + (i * mv + j) * n, n,
                      nets_.data() + at * size + (v_first_ ? j * mu + i : i * mv + j) * n);
    }
  }
}

BSplineSurface::BSplineSurface(BSplineBasis u, BSplineBasis v, const std::vector<Vec3>& poles,
                               const std::vector<double>& weights)
    : u_(std::move(u)), v_(std::move(v)), rational_(!weights.empty()), dimension_(rational_ ? 4 : 3) {
  const std::size_t n = static_cast<std::size_t>(u_.count()) * v_.count();
  if (poles.size() != n || (rational_ && weights.size() != n))
    throw CadError("b-spline surface: number of poles does not fit the knots");
  poles_.resize(n * dimension_);
  for (std::size_t i = 0; i < n; ++i) {
    const double w = rational_ ? weights[i] : 1;
    if (!(w > 0)) throw CadError("b-spline surface: a weight is not positive");
    for (int c = 0; c < 3; ++c) poles_[i * dimension_ + c] = poles[i][c] * w;
    if (rational_) poles_[i * dimension_ + 3] = w;
  }
  const int pu = u_.degree(), pv = v_.degree();
  static constexpr std::array<std::array<std::array<Evaluator, 3>, 3>, 2> small = {{
      {{{evaluate_table<1, 1, false>, evaluate_table<1, 2, false>, evaluate_table<1, 3, false>},
        {evaluate_table<2, 1, false>, evaluate_table<2, 2, false>, evaluate_table<2, 3, false>},
        {evaluate_table<3, 1, false>, evaluate_table<3, 2, false>, evaluate_table<3, 3, false>}}},
      {{{evaluate_table<1, 1, true>, evaluate_table<1, 2, true>, evaluate_table<1, 3, true>},
        {evaluate_table<2, 1, true>, evaluate_table<2, 2, true>, evaluate_table<2, 3, true>},
        {evaluate_table<3, 1, true>, evaluate_table<3, 2, true>, evaluate_table<3, 3, true>}}},
  }};
  if (pu <= 3 && pv <= 3)
    evaluate_ = small[rational_][pu - 1][pv - 1];
  else if (pu == 5 && pv == 5)
    evaluate_ = rational_ ? evaluate_table<5, 5, true> : evaluate_table<5, 5, false>;
  else
    evaluate_ = rational_ ? evaluate_table<0, 0, true> : evaluate_table<0, 0, false>;
  // Of high degree, Bezier points are the faster the fewer they are more than control points.
  const std::size_t bezier = static_cast<std::size_t>(u_.span_count()) * (pu + 1) * v_.span_count() * (pv + 1);
  if (std::max(pu, pv) > BSplineBasis::table_degree && bezier <= 4 * n) {
    make_nets();
    evaluate_ = rational_ ? evaluate_nets<true> : evaluate_nets<false>;
  }
}

Vec3 BSplineSurface::point(double u, double v) const {
  Vec3 d[4][4];
  derivatives(u, v, 0, d);
  return d[0][0];
}

void BSplineSurface::derivatives(double u, double v, int order, Vec3 out[4][4]) const {
  constexpr int m = BSplineBasis::max_degree + 1;
  double bu[4 * m], bv[4 * m];
  u = u_.wrapped(u);
  v = v_.wrapped(v);
  const int su = u_.span(u), sv = v_.span(v), pu = u_.degree(), pv = v_.degree(), n = dimension_;
  if (order <= 2) {
    u_.values2(su, u, bu);
    v_.values2(sv, v, bv);
  } else {
    u_.derivatives(su, u, order, bu);
    v_.derivatives(sv, v, order, bv);
  }
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(v_.count()) * n;
  const double* poles =
      poles_.data() + u_.first_control(su) * stride + static_cast<std::ptrdiff_t>(v_.first_control(sv)) * n;
  double a[4][4][4] = {};
  for (int i = 0; i <= pu; ++i) {
    const double* row = poles + i * stride;
    double r[4][4] = {};
    for (int j = 0; j <= pv; ++j)
      for (int l = 0; l <= order; ++l)
        for (int c = 0; c < n; ++c) r[l][c] += bv[l * (pv + 1) + j] * row[j * n + c];
    for (int k = 0; k <= order; ++k)
      for (int l = 0; k + l <= order; ++l)
        for (int c = 0; c < n; ++c) a[k][l][c] += bu[k * (pu + 1) + i] * r[l][c];
  }
  // Quotient rule, algorithm A4.4 of The NURBS Book.
  for (int k = 0; k <= order; ++k) {
    for (int l = 0; k + l <= order; ++l) {
      Vec3 value(a[k][l][0], a[k][l][1], a[k][l][2]);
      if (rational_) {
        for (int i = 0; i <= k; ++i)
          for (int j = 0; j <= l; ++j)
            if (i + j > 0) value -= out[k - i][l - j] * (choose[k][i] * choose[l][j] * a[i][j][3]);
        value /= a[0][0][3];
      }
      out[k][l] = value;
    }
  }
}

void BSplineSurface::third_derivatives(double u, double v, Vec3 out[4]) const {
  Vec3 d[4][4];
  derivatives(u, v, 3, d);
  for (int l = 0; l < 4; ++l) out[l] = d[3 - l][l];
}

void BSplineSurface::bezier_net(int su, int sv, double u0, double u1, double v0, double v1,
                                std::vector<double>& net) const {
  const int mu = u_.degree() + 1, mv = v_.degree() + 1, n = dimension_;
  std::vector<double> to_u(mu * mu), to_v(mv * mv), half(mu * mv * n);
  u_.bezier_matrix(su, u0, u1, to_u.data());
  v_.bezier_matrix(sv, v0, v1, to_v.data());
  std::fill(net.begin(), net.end(), 0.0);
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(v_.count()) * n;
  const double* poles =
      poles_.data() + u_.first_control(su) * stride + static_cast<std::ptrdiff_t>(v_.first_control(sv)) * n;
  for (int i = 0; i < mu; ++i)
    for (int k = 0; k < mu; ++k)
      for (int x = 0; x < mv * n; ++x) half[i * mv * n + x] += to_u[i * mu + k] * poles[k * stride + x];
  for (int i = 0; i < mu; ++i)
    for (int j = 0; j < mv; ++j)
      for (int k = 0; k < mv; ++k)
        for (int c = 0; c < n; ++c) net[(i * mv + j) * n + c] += to_v[j * mv + k] * half[(i * mv + k) * n + c];
}

void BSplineSurface::span_bounds(int su, int sv, double u0, double u1, double v0, double v1, double out[4][4]) const {
  const int mu = u_.degree() + 1, mv = v_.degree() + 1, n = dimension_;
  std::vector<double> net(mu * mv * n);
  bezier_net(su, sv, u0, u1, v0, v1, net);
  double magnitude = 0;
  for (const double x : net) magnitude = std::max(magnitude, std::abs(x));
  // What rounding may have done to a Bezier point; each difference doubles it.
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * magnitude;
  double w_min = 1;
  if (rational_) {
    // About a point of the patch the numerator is small, and so are the terms that weights bring.
    const double* q = net.data() + ((mu / 2) * mv + mv / 2) * n;
    const double center[3] = {q[0] / q[3], q[1] / q[3], q[2] / q[3]};
    w_min = q[3];
    for (int x = 0; x < mu * mv; ++x) {
      for (int c = 0; c < 3; ++c) net[x * n + c] -= center[c] * net[x * n + 3];
      w_min = std::min(w_min, net[x * n + 3]);
    }
  }
  double w[4][4] = {};
  // The hull of the differences of Bezier points bounds each derivative of numerator and weight.
  std::vector<double> rows = net, cell;
  double u_factor = 1;
  for (int k = 0; k < 4; ++k) {
    const int nu = mu - k;
    if (nu < 1) break;
    cell.assign(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(nu) * mv * n);
    double factor = u_factor;
    for (int l = 0; k + l < 4; ++l) {
      const int nv = mv - l;
      if (nv < 1) break;
      double largest = 0, weight = 0;
      for (int i = 0; i < nu; ++i) {
        for (int j = 0; j < nv; ++j) {
          const double* q = cell.data() + (i * mv + j) * n;
          largest = std::max(largest, q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
          if (rational_) weight = std::max(weight, std::abs(q[3]));
        }
      }
      out[k][l] = (std::sqrt(largest) + std::ldexp(rounding, k + l)) * factor;
      w[k][l] = rational_ ? (weight + std::ldexp(rounding, k + l)) * factor : 0;
      for (int i = 0; i < nu; ++i)
        for (int j = 0; j + 1 < nv; ++j)
          for (int c = 0; c < n; ++c)
            cell[(i * mv + j) * n + c] = cell[(i * mv + j + 1) * n + c] - cell[(i * mv + j) * n + c];
      factor *= (mv - 1 - l) / (v1 - v0);
    }
    for (int i = 0; i + 1 < nu; ++i)
      for (int x = 0; x < mv * n; ++x) rows[i * mv * n + x] = rows[(i + 1) * mv * n + x] - rows[i * mv * n + x];
    u_factor *= (mu - 1 - k) / (u1 - u0);
  }
  if (!rational_) return;
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; k + l < 4; ++l) {
      double sum = out[k][l];
      for (int i = 0; i <= k; ++i)
        for (int j = 0; j <= l; ++j)
          if (i + j > 0) sum += choose[k][i] * choose[l][j] * w[i][j] * out[k - i][l - j];
      out[k][l] = w_min > 0 ? sum / w_min : SurfaceBounds::unknown;
    }
  }
}

SurfaceBounds BSplineSurface::bounds(double u0, double u1, double v0, double v1) const {
  double most[4][4] = {};
  u_.for_each_piece(u0, u1, [&](int su, double ua, double ub) {
    v_.for_each_piece(v0, v1, [&](int sv, double va, double vb) {
      double one[4][4] = {};
      span_bounds(su, sv, ua, ub, va, vb, one);
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) most[k][l] = std::max(most[k][l], one[k][l]);
    });
  });
  return {most[1][0], most[0][1], most[2][0], most[1][1], most[0][2], most[3][0], most[2][1], most[1][2], most[0][3]};
}

}  // namespace tri

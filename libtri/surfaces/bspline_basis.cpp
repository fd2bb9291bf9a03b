#include "libtri/surfaces/bspline_basis.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/error.hpp"

namespace tri {

BSplineBasis::BSplineBasis(int degree, std::vector<double> knots, double period)
    : degree_(degree), knots_(std::move(knots)), period_(period) {
  if (degree < 1 || degree > max_degree)
    throw CadError("b-spline degree " + std::to_string(degree) + " is not in 1..25");
  if (static_cast<int>(knots_.size()) < 2 * degree + 2) throw CadError("b-spline with too few knots for its degree");
  for (std::size_t i = 0; i + 1 < knots_.size(); ++i)
    if (!(knots_[i] <= knots_[i + 1])) throw CadError("b-spline knots are not in ascending order");
  const int n = count();
  for (int k = degree; k < n; ++k) {
    if (knots_[k] == knots_[k + 1]) continue;
    if (edges_.empty()) edges_.push_back(knots_[k]);
    edges_.push_back(knots_[k + 1]);
    span_knot_.push_back(k);
  }
  if (span_knot_.empty()) throw CadError("b-spline without any span");

  const int cells = std::clamp(2 * span_count(), 4, 8192);
  cell_scale_ = cells / (last() - first());
  // Half a cell early, because the rounded product in span() may fall into a neighbouring cell.
  for (int c = 0; c < cells + 2; ++c) {
    const double t = first() + (c - 0.5) / cell_scale_;
    const auto above = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, t);
    cell_span_.push_back(static_cast<int>(above - edges_.begin()) - 1);
  }

  const int m = degree + 1;
  table_.resize(static_cast<std::size_t>(span_count()) * m * m);
  std::vector<double> bezier(m * m);
  for (int s = 0; s < span_count(); ++s) {
    const double a = span_begin(s), b = span_end(s);
    table_middle_.push_back((a + b) / 2);
    table_scale_.push_back(2 / (b - a));
    bezier_matrix(s, a, b, bezier.data());
    double* table = table_.data() + static_cast<std::size_t>(s) * m * m;
    if (degree > table_degree) {
      std::copy(bezier.begin(), bezier.end(), table);
      continue;
    }
    // Bernstein polynomials in x = -1..1 as powers of x, times the Bezier points of each function.
    for (int j = 0; j < m; ++j) {
      double choose = 1;
      for (int i = 0; i < m; ++i) {
        // C(p,i) ((1+x)/2)^i ((1-x)/2)^(p-i)
        std::vector<double> poly{choose * std::pow(0.5, degree)};
        for (int k = 0; k < degree; ++k) {
          const double sign = k < i ? 1 : -1;
          poly.push_back(0);
          for (std::size_t e = poly.size() - 1; e > 0; --e) poly[e] += sign * poly[e - 1];
        }
        for (int k = 0; k < m; ++k) table[k * m + j] += bezier[i * m + j] * poly[k];
        choose = choose * (degree - i) / (i + 1);
      }
    }
  }
}

void BSplineBasis::bernstein2(int s, double t, double* out) const {
  constexpr int most = max_degree + 1;
  const int p = degree_, m = p + 1;
  const double scale = table_scale_[s] / 2, x = 0.5 + (t - table_middle_[s]) * scale, y = 1 - x;
  double *f = out, *df = out + m, *ddf = out + 2 * m;
  if (p == 1) {
    f[0] = y, f[1] = x;
    df[0] = -scale, df[1] = scale;
    ddf[0] = ddf[1] = 0;
    return;
  }
  // Degree p - 2 from powers, then one step each to p - 1 and p, beside the differences.
  double power[most], b[most + 2];
  power[0] = 1;
  for (int i = 1; i <= p - 2; ++i) power[i] = power[i - 1] * y;
  double choose = 1;
  b[0] = b[1] = b[p + 1] = b[p + 2] = 0;
  for (int i = 0; i <= p - 2; ++i) {
    b[i + 2] = choose * power[p - 2 - i];
    choose *= x * (p - 2 - i) / (i + 1);
  }
  const double d1 = p * scale, d2 = d1 * (p - 1) * scale;
  for (int i = 0; i <= p; ++i) {
    const double b0 = b[i], b1 = b[i + 1], b2 = b[i + 2];
    const double low = x * b0 + y * b1, high = x * b1 + y * b2;  // degree p - 1, functions i - 1 and i
    f[i] = x * low + y * high;
    df[i] = d1 * (low - high);
    ddf[i] = d2 * (b0 - 2 * b1 + b2);
  }
}

void BSplineBasis::values2_high(int s, double t, double* out) const {
  double w[3 * (max_degree + 1)];
  bernstein2(s, t, w);
  const int m = degree_ + 1;
  double *f = out, *d = out + m, *dd = out + 2 * m;
  std::fill_n(out, 3 * m, 0.0);
  const double* row = table_.data() + static_cast<std::size_t>(s) * m * m;
  for (int i = 0; i < m; ++i, row += m) {
    const double w0 = w[i], w1 = w[m + i], w2 = w[2 * m + i];
    for (int j = 0; j < m; ++j) {
      f[j] += w0 * row[j];
      d[j] += w1 * row[j];
      dd[j] += w2 * row[j];
    }
  }
}

double BSplineBasis::wrap(double t) const {
  t -= std::floor((t - first()) / period_) * period_;
  return std::clamp(t, first(), last());
}

std::vector<ParameterBreak> BSplineBasis::breaks() const {
  std::vector<ParameterBreak> result;
  for (int s = 1; s < span_count(); ++s) {
    const auto range = std::equal_range(knots_.begin(), knots_.end(), edges_[s]);
    const int multiplicity = static_cast<int>(range.second - range.first);
    result.push_back({edges_[s], std::max(0, degree_ - multiplicity)});
  }
  return result;
}

void BSplineBasis::derivatives(int s, double t, int order, double* out) const {
  // Algorithm A2.3 of The NURBS Book.
  constexpr int m = max_degree + 1;
  const int p = degree_, k = span_knot_[s];
  double ndu[m][m], left[m], right[m], a[2][m];
  ndu[0][0] = 1;
  for (int j = 1; j <= p; ++j) {
    left[j] = t - knots_[k + 1 - j];
    right[j] = knots_[k + j] - t;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      ndu[j][r] = right[r + 1] + left[j - r];
      const double temp = ndu[r][j - 1] / ndu[j][r];
      ndu[r][j] = saved + right[r + 1] * temp;
      saved = left[j - r] * temp;
    }
    ndu[j][j] = saved;
  }
  for (int j = 0; j <= p; ++j) out[j] = ndu[j][p];
  for (int d = p + 1; d <= order; ++d) std::fill_n(out + d * (p + 1), p + 1, 0.0);
  const int top = std::min(order, p);
  for (int r = 0; r <= p; ++r) {
    int s1 = 0, s2 = 1;
    a[0][0] = 1;
    for (int d = 1; d <= top; ++d) {
      double value = 0;
      const int rk = r - d, pk = p - d;
      if (r >= d) {
        a[s2][0] = a[s1][0] / ndu[pk + 1][rk];
        value = a[s2][0] * ndu[rk][pk];
      }
      const int j1 = rk >= -1 ? 1 : -rk;
      const int j2 = r - 1 <= pk ? d - 1 : p - r;
      for (int j = j1; j <= j2; ++j) {
        a[s2][j] = (a[s1][j] - a[s1][j - 1]) / ndu[pk + 1][rk + j];
        value += a[s2][j] * ndu[rk + j][pk];
      }
      if (r <= pk) {
        a[s2][d] = -a[s1][d - 1] / ndu[pk + 1][r];
        value += a[s2][d] * ndu[r][pk];
      }
      out[d * (p + 1) + r] = value;
      std::swap(s1, s2);
    }
  }
  double factor = p;
  for (int d = 1; d <= top; ++d) {
    for (int j = 0; j <= p; ++j) out[d * (p + 1) + j] *= factor;
    factor *= p - d;
  }
}

void BSplineBasis::bezier_matrix(int s, double a, double b, double* matrix) const {
  const int p = degree_, m = p + 1, k = span_knot_[s];
  std::vector<double> d(static_cast<std::size_t>(m) * m);
  for (int i = 0; i < m; ++i) {
    std::fill(d.begin(), d.end(), 0.0);
    for (int j = 0; j < m; ++j) d[j * m + j] = 1;
    for (int r = 1; r <= p; ++r) {
      const double x = r <= p - i ? a : b;  // the blossom's arguments: a (p - i times), b (i times)
      for (int j = p; j >= r; --j) {
        const double low = knots_[k - p + j], high = knots_[k + 1 + j - r];
        const double alpha = (x - low) / (high - low);
        for (int c = 0; c < m; ++c) d[j * m + c] = (1 - alpha) * d[(j - 1) * m + c] + alpha * d[j * m + c];
      }
    }
    std::copy_n(d.data() + static_cast<std::size_t>(p) * m, m, matrix + i * m);
  }
}

}  // namespace tri

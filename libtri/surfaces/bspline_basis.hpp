#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "libtri/surfaces/surface.hpp"

namespace tri {

/// The B-spline basis functions of one knot vector [Piegl & Tiller, The NURBS Book, 1997]. Immutable, free of caches.
///
/// Evaluation outside the range continues the polynomial of the first or last span; with a period, the parameter is
/// brought into [first, first + period] before.
class BSplineBasis {
 public:
  static constexpr int max_degree = 25;   ///< what OpenCASCADE allows
  static constexpr int max_order = 3;     ///< highest derivative
  static constexpr int table_degree = 9;  ///< up to this degree each span keeps its polynomials as powers

  /// @param degree 1 to max_degree
  /// @param knots  non-decreasing, every knot repeated by its multiplicity; more than 2 * degree + 1 of them
  /// @param period 0 for none
  /// @throws CadError if the knots are not as said.
  BSplineBasis(int degree, std::vector<double> knots, double period = 0);

  int degree() const { return degree_; }
  /// Number of functions, that is of control points.
  int count() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  double first() const { return edges_.front(); }
  double last() const { return edges_.back(); }
  double period() const { return period_; }
  int span_count() const { return static_cast<int>(edges_.size()) - 1; }
  /// Limits of span s.
  double span_begin(int s) const { return edges_[s]; }
  double span_end(int s) const { return edges_[s + 1]; }
  /// The first of the degree + 1 control points that matter on span s.
  int first_control(int s) const { return span_knot_[s] - degree_; }
  /// Breaks strictly inside the range.
  std::vector<ParameterBreak> breaks() const;

  double wrapped(double t) const {
    if (period_ > 0 && (t < first() || t > last())) return wrap(t);
    return t;
  }

  /// The non-empty span that t lies in; the first or last one for t outside.
  int span(double t) const {
    const int last_cell = static_cast<int>(cell_span_.size()) - 3;
    const double x = (t - edges_.front()) * cell_scale_;
    const int cell = x > 0 ? (x < last_cell ? static_cast<int>(x) : last_cell) : 0;
    int s = cell_span_[cell];
    int end = cell_span_[cell + 2];
    while (end - s > 8) {
      const int middle = (s + end) / 2;
      (t >= edges_[middle] ? s : end) = middle;
    }
    while (s < end && t >= edges_[s + 1]) ++s;
    return s;
  }

  /// Derivatives 0 to `order` (at most max_order) of the degree + 1 functions on span s:
  /// out[k * (degree + 1) + i] is derivative k of function first_control(s) + i.
  void derivatives(int s, double t, int order, double* out) const;

  /// Values, first and second derivatives by the span's own polynomials, laid out as by `derivatives`.
  /// @tparam P degree(), at most table_degree; or 0 to leave it to run time
  template <int P = 0>
  void values2(int s, double t, double* out) const {
    if (P == 0 && degree_ > table_degree) {
      values2_high(s, t, out);
      return;
    }
    const int m = (P > 0 ? P : degree_) + 1;
    const double* c = table_.data() + static_cast<std::size_t>(s) * m * m;
    const double scale = table_scale_[s];
    const double x = (t - table_middle_[s]) * scale;
    double *f = out, *d = out + m, *dd = out + 2 * m;
    for (int i = 0; i < m; ++i) {
      f[i] = c[(m - 1) * m + i];
      d[i] = dd[i] = 0;
    }
    for (int k = m - 2; k >= 0; --k) {
      for (int i = 0; i < m; ++i) {
        dd[i] = dd[i] * x + d[i];
        d[i] = d[i] * x + f[i];
        f[i] = f[i] * x + c[k * m + i];
      }
    }
    for (int i = 0; i < m; ++i) {
      d[i] *= scale;
      dd[i] *= 2 * scale * scale;
    }
  }

  /// Values, first and second derivatives by t of the Bernstein polynomials over span s, laid out as by `derivatives`.
  void bernstein2(int s, double t, double* out) const;

  /// Calls use(s, a, b) with pieces of [low, high], each within one span, that cover it; across the seam if there is a
  /// period. Pieces too short for differences of control points to be told from rounding are widened within their span.
  template <class Use>
  void for_each_piece(double low, double high, Use&& use) const {
    if (period_ > 0) {
      const double shift = std::floor((low - first()) / period_) * period_;
      low -= shift;
      high -= shift;
      if (high - low >= period_) {
        low = first();
        high = last();
      }
      if (high > last()) {
        pieces_within(first(), high - period_, use);
        high = last();
      }
    }
    pieces_within(low, high, use);
  }

  /// The map from the degree + 1 control points of span s to the Bezier points over [a,b], by blossoming [Ramshaw
  /// 1989]: Bezier point i = sum over j of matrix[i * (degree + 1) + j] * control first_control(s) + j.
  void bezier_matrix(int s, double a, double b, double* matrix) const;

 private:
  double wrap(double t) const;
  // As values2, from Bernstein polynomials, which stay accurate where high powers do not.
  void values2_high(int s, double t, double* out) const;

  template <class Use>
  void pieces_within(double low, double high, Use&& use) const {
    const int s0 = span(low);
    int s1 = span(high);
    if (s1 > s0 && high == span_begin(s1)) --s1;
    for (int s = s0; s <= s1; ++s) {
      double a = s == s0 ? low : span_begin(s), b = s == s1 ? high : span_end(s);
      const double least = 1e-3 * (span_end(s) - span_begin(s));
      if (b - a < least) {
        const double middle = std::clamp((a + b) / 2, span_begin(s) + least / 2, span_end(s) - least / 2);
        a = std::min(a, middle - least / 2);
        b = std::max(b, middle + least / 2);
      }
      use(s, a, b);
    }
  }

  int degree_;
  std::vector<double> knots_;
  double period_;
  std::vector<double> edges_;   // distinct knots within the range
  std::vector<int> span_knot_;  // per span: k with knots_[k] = begin, knots_[k + 1] = end
  std::vector<int> cell_span_;  // uniform cells over the range: span half a cell before each, one entry more than cells
  double cell_scale_ = 0;
  // Per span: powers of each function, row by row; above table_degree the map from Bernstein polynomials instead.
  std::vector<double> table_, table_middle_, table_scale_;
};

}  // namespace tri

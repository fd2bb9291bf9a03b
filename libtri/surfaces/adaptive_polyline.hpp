#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace tri {

/// Parameters of a polyline that follows a curve within `tolerance`.
///
/// @param breaks     ascending parameters that are kept, first and last included
/// @param deviation  (t0, t, t1) -> distance of the curve at t from the chord between t0 and t1, t0 < t < t1
/// @param tolerance  same unit as `deviation`
/// At most 2^12 pieces between two breaks.
template <class Deviation>
std::vector<double> adaptive_parameters(const std::vector<double>& breaks, Deviation deviation, double tolerance) {
  struct Piece {
    double t0, t1;
    int depth;
  };
  std::vector<double> result;
  std::vector<Piece> stack;
  for (std::size_t i = breaks.size() - 1; i-- > 0;) stack.push_back({breaks[i], breaks[i + 1], 0});
  if (!breaks.empty()) result.push_back(breaks.front());
  while (!stack.empty()) {
    const Piece piece = stack.back();
    stack.pop_back();
    const double length = piece.t1 - piece.t0;
    bool split = false;
    // The middle alone would miss an S-shaped piece.
    for (const double share : {0.5, 0.25, 0.75})
      split = split || deviation(piece.t0, piece.t0 + share * length, piece.t1) > tolerance;
    if (split && piece.depth < 12) {
      const double middle = piece.t0 + 0.5 * length;
      stack.push_back({middle, piece.t1, piece.depth + 1});
      stack.push_back({piece.t0, middle, piece.depth + 1});
    } else {
      result.push_back(piece.t1);
    }
  }
  return result;
}

/// Breaks for `adaptive_parameters`: `inner` parameters strictly inside [first, last], filled up to `pieces` pieces.
inline std::vector<double> breaks_between(double first, double last, std::vector<double> inner, int pieces) {
  std::vector<double> knots{first};
  std::sort(inner.begin(), inner.end());
  const double gap = 1e-9 * (last - first);
  for (const double t : inner)
    if (t > knots.back() + gap && t < last - gap) knots.push_back(t);
  knots.push_back(last);
  const int spans = static_cast<int>(knots.size()) - 1;
  const int parts = std::max(1, (pieces + spans - 1) / spans);
  std::vector<double> result{first};
  for (int i = 0; i < spans; ++i)
    for (int k = 1; k <= parts; ++k)
      result.push_back(k == parts ? knots[i + 1] : knots[i] + (knots[i + 1] - knots[i]) * k / parts);
  return result;
}

/// Largest value of f in [a, b], where f has one maximum there (golden section); the ends included.
template <class F>
double golden_maximum(double a, double b, F f) {
  constexpr double golden = 0.6180339887498949;
  double best = std::max(f(a), f(b));
  double x1 = b - golden * (b - a), x2 = a + golden * (b - a);
  double f1 = f(x1), f2 = f(x2);
  for (int i = 0; i < 40; ++i) {
    if (f1 < f2) {
      a = x1, x1 = x2, f1 = f2;
      x2 = a + golden * (b - a), f2 = f(x2);
    } else {
      b = x2, x2 = x1, f2 = f1;
      x1 = b - golden * (b - a), f1 = f(x1);
    }
  }
  return std::max({best, f1, f2});
}

}  // namespace tri

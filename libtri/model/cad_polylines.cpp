#include "libtri/model/cad_polylines.hpp"

#include <algorithm>
#include <cmath>

#include "libtri/surfaces/adaptive_polyline.hpp"

namespace tri {
ParameterPolyline parameter_polyline(const Curve2& curve, double first, double last, const Surface& surface,
                                     const std::vector<double>& inner, int pieces, double tolerance) {
  double metric_t0 = NAN, metric_t1 = NAN, e = 0, f = 0, g = 0;
  Vec2 p0, p1;
  const auto deviation = [&](double t0, double t, double t1) {
    if (t0 != metric_t0 || t1 != metric_t1) {
      metric_t0 = t0, metric_t1 = t1;
      p0 = curve.point(t0), p1 = curve.point(t1);
      const Vec2 middle = 0.5 * (p0 + p1);
      const SurfacePoint s = surface.evaluate(middle[0], middle[1]);
      e = s.du | s.du, f = s.du | s.dv, g = s.dv | s.dv;
    }
    const auto product = [&](const Vec2& a, const Vec2& b) {
      return e * a[0] * b[0] + f * (a[0] * b[1] + a[1] * b[0]) + g * a[1] * b[1];
    };
    const Vec2 chord = p1 - p0, d = curve.point(t) - p0;
    const double cc = product(chord, chord), dd = product(d, d), dc = product(d, chord);
    const double share = cc > 0 ? std::clamp(dc / cc, 0.0, 1.0) : 0.0;
    return std::sqrt(std::max(0.0, dd - 2 * share * dc + share * share * cc));
  };
  ParameterPolyline result;
  result.parameters = adaptive_parameters(breaks_between(first, last, inner, pieces), deviation, tolerance);
  result.points.reserve(result.parameters.size());
  for (const double t : result.parameters) result.points.push_back(curve.point(t));
  return result;
}

void extend_range(const Curve2& curve, const ParameterPolyline& polyline, int axis, double& low, double& high) {
  const auto& t = polyline.parameters;
  const std::size_t n = t.size();
  for (const double sign : {-1.0, 1.0}) {
    const auto value = [&](double at) { return sign * curve.point(at)[axis]; };
    std::size_t best = 0;
    for (std::size_t i = 1; i < n; ++i)
      if (sign * polyline.points[i][axis] > sign * polyline.points[best][axis]) best = i;
    double extreme = sign * polyline.points[best][axis];
    if (best > 0) extreme = std::max(extreme, golden_maximum(t[best - 1], t[best], value));
    if (best + 1 < n) extreme = std::max(extreme, golden_maximum(t[best], t[best + 1], value));
    if (sign < 0)
      low = std::min(low, -extreme);
    else
      high = std::max(high, extreme);
  }
}

bool inside_polygon(const std::vector<Vec2>& polygon, const Vec2& point) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 &a = polygon[i], &b = polygon[j];
    if ((a[1] > point[1]) == (b[1] > point[1])) continue;
    if (point[0] < (b[0] - a[0]) * (point[1] - a[1]) / (b[1] - a[1]) + a[0]) inside = !inside;
  }
  return inside;
}

}  // namespace tri

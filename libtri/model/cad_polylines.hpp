#pragma once

#include <vector>

#include "libtri/surfaces/curve.hpp"
#include "libtri/surfaces/surface.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A parameter curve as a polyline: `parameters` ascending, `points` beside them.
struct ParameterPolyline {
  std::vector<double> parameters;
  std::vector<Vec2> points;
};

/// Follows `curve` over [first, last] so that the straight (u,v) pieces stay within `tolerance` mm of it on `surface`.
/// @param inner   parameters where the curve is less smooth, in any order
/// @param pieces  fewest pieces, >= 1
ParameterPolyline parameter_polyline(const Curve2& curve, double first, double last, const Surface& surface,
                                     const std::vector<double>& inner, int pieces, double tolerance);

/// Smallest and largest value of coordinate `axis` (0: u, 1: v) of `curve` around `polyline`, to 1e-9 of the range
/// between neighbouring points.
void extend_range(const Curve2& curve, const ParameterPolyline& polyline, int axis, double& low, double& high);

/// True if `point` is inside the closed polygon, by crossings.
bool inside_polygon(const std::vector<Vec2>& polygon, const Vec2& point);

}  // namespace tri

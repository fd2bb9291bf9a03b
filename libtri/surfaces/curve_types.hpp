#pragma once

#include <memory>
#include <type_traits>
#include <vector>

#include "libtri/surfaces/bspline_basis.hpp"
#include "libtri/surfaces/curve.hpp"

namespace tri {

/// Curve2 for Vec2, Curve3 for Vec3.
template <class Vec>
using CurveIn = std::conditional_t<std::is_same_v<Vec, Vec2>, Curve2, Curve3>;
template <class Vec>
using CurvePointIn = std::conditional_t<std::is_same_v<Vec, Vec2>, CurvePoint2, CurvePoint3>;
template <class Vec>
using CurvePtr = std::shared_ptr<const CurveIn<Vec>>;

// Each is instantiated for Vec2 and Vec3.

/// origin + t direction
template <class Vec>
CurvePtr<Vec> make_line(const Vec& origin, const Vec& direction);
/// origin + cos t x + sin t y; a circle where x and y are orthogonal and of one length
template <class Vec>
CurvePtr<Vec> make_ellipse(const Vec& origin, const Vec& x, const Vec& y);
/// origin + t^2 x + t y
template <class Vec>
CurvePtr<Vec> make_parabola(const Vec& origin, const Vec& x, const Vec& y);
/// origin + cosh t x + sinh t y
template <class Vec>
CurvePtr<Vec> make_hyperbola(const Vec& origin, const Vec& x, const Vec& y);
/// @param weights one per pole, all positive, or empty
/// @throws CadError if the sizes do not fit or a weight is not positive.
template <class Vec>
CurvePtr<Vec> make_bspline_curve(BSplineBasis basis, const std::vector<Vec>& poles, const std::vector<double>& weights);

/// The curve at `distance` to the right of `base` (left if negative).
CurvePtr<Vec2> make_offset_curve(CurvePtr<Vec2> base, double distance);
/// The curve at `distance` from `base` along tangent x direction.
CurvePtr<Vec3> make_offset_curve(CurvePtr<Vec3> base, double distance, const Vec3& direction);

}  // namespace tri

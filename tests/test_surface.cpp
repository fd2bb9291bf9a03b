// The flat evaluators against OpenCASCADE's own derivatives.
#include <doctest/doctest.h>

#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom2d_Hyperbola.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_OffsetCurve.hxx>
#include <Geom2d_Parabola.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_OffsetCurve.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Ax22d.hxx>
#include <gp_Hypr.hxx>
#include <gp_Hypr2d.hxx>
#include <gp_Parab.hxx>
#include <gp_Parab2d.hxx>
#include <numbers>
#include <random>

#include "libtri/surfaces/geometry_occt.hpp"
#include "meshops/error.hpp"

namespace {

using namespace tri;
using std::numbers::pi;

const gp_Ax3 axes(gp_Pnt(10, -20, 5), gp_Dir(0.3, -0.5, 0.8), gp_Dir(1, 1, 0.2));

template <class A, class B>
double gap(const A& a, const B& b) {
  double sum = 0;
  for (int c = 0; c < static_cast<int>(A::size_); ++c) sum += (a[c] - b.Coord(c + 1)) * (a[c] - b.Coord(c + 1));
  return std::sqrt(sum);
}

TColgp_Array2OfPnt wavy_net(int nu, int nv, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-1, 1);
  TColgp_Array2OfPnt poles(1, nu, 1, nv);
  for (int i = 1; i <= nu; ++i)
    for (int j = 1; j <= nv; ++j)
      poles(i, j) = gp_Pnt(10 * i + noise(random), 7 * j + noise(random), 3 * noise(random));
  return poles;
}

TColStd_Array2OfReal some_weights(int nu, int nv, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> weight(0.5, 2);
  TColStd_Array2OfReal weights(1, nu, 1, nv);
  for (int i = 1; i <= nu; ++i)
    for (int j = 1; j <= nv; ++j) weights(i, j) = weight(random);
  return weights;
}

// Clamped, uneven knots; `repeated` gives one inner knot that multiplicity.
void make_knots(int poles, int degree, int repeated, std::vector<double>& knots, std::vector<int>& multiplicities) {
  int inner = poles - degree - 1;
  knots = {-1.0};
  multiplicities = {degree + 1};
  double at = -1;
  for (int k = 0; inner > 0; ++k) {
    const int m = k == 1 ? std::min(repeated, inner) : 1;
    at += 0.3 + 0.25 * (k % 3);
    knots.push_back(at);
    multiplicities.push_back(m);
    inner -= m;
  }
  knots.push_back(at + 0.7);
  multiplicities.push_back(degree + 1);
}

template <class Array, class T>
Array array_of(const std::vector<T>& values) {
  Array a(1, static_cast<int>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) a(static_cast<int>(i) + 1) = values[i];
  return a;
}

Handle(Geom_BSplineSurface) bspline(int nu, int nv, int pu, int pv, bool rational, int repeated = 1) {
  std::vector<double> ku, kv;
  std::vector<int> mu, mv;
  make_knots(nu, pu, repeated, ku, mu);
  make_knots(nv, pv, 1, kv, mv);
  const auto uk = array_of<TColStd_Array1OfReal>(ku), vk = array_of<TColStd_Array1OfReal>(kv);
  const auto um = array_of<TColStd_Array1OfInteger>(mu), vm = array_of<TColStd_Array1OfInteger>(mv);
  if (rational) return new Geom_BSplineSurface(wavy_net(nu, nv, 7), some_weights(nu, nv, 3), uk, vk, um, vm, pu, pv);
  return new Geom_BSplineSurface(wavy_net(nu, nv, 7), uk, vk, um, vm, pu, pv);
}

Handle(Geom_BSplineSurface) periodic_bspline(bool rational) {
  const int nu = 7, nv = 5;
  TColgp_Array2OfPnt poles(1, nu, 1, nv);
  for (int i = 1; i <= nu; ++i)
    for (int j = 1; j <= nv; ++j)
      poles(i, j) = gp_Pnt((20 + j) * std::cos(2 * pi * i / nu), (20 - j) * std::sin(2 * pi * i / nu), 6 * j);
  const auto uk = array_of<TColStd_Array1OfReal>(std::vector<double>{0, 1, 2.5, 3, 4, 5.5, 6, 7});
  const auto um = array_of<TColStd_Array1OfInteger>(std::vector<int>{1, 1, 1, 1, 1, 1, 1, 1});
  const auto vk = array_of<TColStd_Array1OfReal>(std::vector<double>{0, 1, 2});
  const auto vm = array_of<TColStd_Array1OfInteger>(std::vector<int>{4, 1, 4});
  if (rational) return new Geom_BSplineSurface(poles, some_weights(nu, nv, 5), uk, vk, um, vm, 3, 3, true, false);
  return new Geom_BSplineSurface(poles, uk, vk, um, vm, 3, 3, true, false);
}

Handle(Geom_BSplineCurve) bspline_curve(int n, int p, bool rational) {
  std::vector<double> k;
  std::vector<int> m;
  make_knots(n, p, 1, k, m);
  TColgp_Array1OfPnt poles(1, n);
  TColStd_Array1OfReal weights(1, n);
  for (int i = 1; i <= n; ++i) {
    poles(i) = gp_Pnt(30 + 4 * i, 3 * std::sin(i), 5 * std::cos(2 * i));
    weights(i) = rational ? 1 + 0.5 * std::sin(3 * i) : 1;
  }
  return new Geom_BSplineCurve(poles, weights, array_of<TColStd_Array1OfReal>(k), array_of<TColStd_Array1OfInteger>(m),
                               p);
}

// Parameters over the range: even, both ends, and every break with its close neighbourhood.
std::vector<double> parameters(double first, double last, const std::vector<ParameterBreak>& breaks) {
  std::vector<double> t;
  for (int i = 0; i <= 12; ++i) t.push_back(i == 12 ? last : first + (last - first) * i / 12);
  const double step = 1e-9 * (last - first);
  for (const ParameterBreak& b : breaks) {
    t.push_back(b.at - step);
    t.push_back(b.at + step);
  }
  return t;
}

// First and second derivatives carry the length over powers of the parameter range.
void check_surface(const Handle(Geom_Surface) & expected, double u0, double u1, double v0, double v1) {
  const auto surface = make_surface(expected);
  CAPTURE(expected->DynamicType()->Name());
  const SurfaceBounds all = surface->bounds(u0, u1, v0, v1);
  for (const double u : parameters(u0, u1, surface->u_breaks())) {
    for (const double v : parameters(v0, v1, surface->v_breaks())) {
      CAPTURE(u);
      CAPTURE(v);
      gp_Pnt p;
      gp_Vec du, dv, duu, dvv, duv;
      expected->D2(u, v, p, du, dv, duu, dvv, duv);
      const SurfacePoint s = surface->evaluate(u, v);
      const double scale =
          1 + p.XYZ().Modulus() + du.Magnitude() + dv.Magnitude() + duu.Magnitude() + duv.Magnitude() + dvv.Magnitude();
      const double tolerance = 1e-11 * scale;
      CHECK(gap(s.p, p) <= tolerance);
      CHECK(gap(surface->point(u, v), p) <= tolerance);
      CHECK(gap(s.du, du) <= tolerance);
      CHECK(gap(s.dv, dv) <= tolerance);
      CHECK(gap(s.duu, duu) <= tolerance);
      CHECK(gap(s.duv, duv) <= tolerance);
      CHECK(gap(s.dvv, dvv) <= tolerance);
      CHECK(s.du.norm() <= all.du * (1 + 1e-12) + tolerance);
      CHECK(s.dv.norm() <= all.dv * (1 + 1e-12) + tolerance);
      CHECK(s.duu.norm() <= all.duu * (1 + 1e-12) + tolerance);
      CHECK(s.duv.norm() <= all.duv * (1 + 1e-12) + tolerance);
      CHECK(s.dvv.norm() <= all.dvv * (1 + 1e-12) + tolerance);
    }
  }
}

// Bounds over small rectangles hold and are not far from what they bound.
void check_bounds(const Handle(Geom_Surface) & expected, double u0, double u1, double v0, double v1, double slack) {
  const auto surface = make_surface(expected);
  CAPTURE(expected->DynamicType()->Name());
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const double ua = u0 + (u1 - u0) * (0.05 + 0.23 * a), ub = ua + 0.03 * (u1 - u0);
      const double va = v0 + (v1 - v0) * (0.04 + 0.23 * b), vb = va + 0.03 * (v1 - v0);
      const SurfaceBounds bound = surface->bounds(ua, ub, va, vb);
      double seen[9] = {};
      for (int i = 0; i <= 6; ++i) {
        for (int j = 0; j <= 6; ++j) {
          const double u = ua + (ub - ua) * i / 6, v = va + (vb - va) * j / 6;
          gp_Pnt p;
          gp_Vec du, dv, duu, dvv, duv, duuu, dvvv, duuv, duvv;
          expected->D3(u, v, p, du, dv, duu, dvv, duv, duuu, dvvv, duuv, duvv);
          const gp_Vec* d[] = {&du, &dv, &duu, &duv, &dvv, &duuu, &duuv, &duvv, &dvvv};
          for (int k = 0; k < 9; ++k) seen[k] = std::max(seen[k], d[k]->Magnitude());
        }
      }
      const double bounds[] = {bound.du,   bound.dv,   bound.duu,  bound.duv, bound.dvv,
                               bound.duuu, bound.duuv, bound.duvv, bound.dvvv};
      for (int k = 0; k < 9; ++k) {
        CAPTURE(k);
        CHECK(seen[k] <= bounds[k] * (1 + 1e-9) + 1e-9);
        if (k < 2) CHECK(bounds[k] <= slack * seen[k]);
      }
    }
  }
}

void check_curve2(const Handle(Geom2d_Curve) & expected, double first, double last) {
  const auto curve = make_curve2(expected, first, last);
  CAPTURE(expected->DynamicType()->Name());
  const CurveBounds<Vec2> bound = curve->bounds(first, last);
  for (const double t : parameters(first, last, curve->breaks())) {
    CAPTURE(t);
    gp_Pnt2d p;
    gp_Vec2d d, dd;
    expected->D2(t, p, d, dd);
    const CurvePoint2 c = curve->evaluate(t);
    const double tolerance = 1e-11 * (1 + p.XY().Modulus() + d.Magnitude() + dd.Magnitude());
    CHECK(gap(c.p, p) <= tolerance);
    CHECK(gap(curve->point(t), p) <= tolerance);
    CHECK(gap(c.d, d) <= tolerance);
    CHECK(gap(c.dd, dd) <= tolerance);
    for (int k = 0; k < 2; ++k) {
      CHECK(std::abs(c.d[k]) <= bound.d[k] * (1 + 1e-12) + tolerance);
      CHECK(std::abs(c.dd[k]) <= bound.dd[k] * (1 + 1e-12) + tolerance);
    }
  }
}

void check_curve3(const Handle(Geom_Curve) & expected, double first, double last) {
  const auto curve = make_curve3(expected);
  CAPTURE(expected->DynamicType()->Name());
  const CurveBounds<Vec3> bound = curve->bounds(first, last);
  for (const double t : parameters(first, last, curve->breaks())) {
    CAPTURE(t);
    gp_Pnt p;
    gp_Vec d, dd;
    expected->D2(t, p, d, dd);
    const CurvePoint3 c = curve->evaluate(t);
    const double tolerance = 1e-11 * (1 + p.XYZ().Modulus() + d.Magnitude() + dd.Magnitude());
    CHECK(gap(c.p, p) <= tolerance);
    CHECK(gap(c.d, d) <= tolerance);
    CHECK(gap(c.dd, dd) <= tolerance);
    for (int k = 0; k < 3; ++k) {
      CHECK(std::abs(c.d[k]) <= bound.d[k] * (1 + 1e-12) + tolerance);
      CHECK(std::abs(c.dd[k]) <= bound.dd[k] * (1 + 1e-12) + tolerance);
    }
  }
}

}  // namespace

TEST_CASE("surface: elementary types equal OpenCASCADE's up to second derivatives, in left-handed frames too") {
  gp_Ax3 left = axes;
  left.YReverse();
  for (const gp_Ax3& a : {axes, left}) {
    check_surface(new Geom_Plane(a), -50, 70, -30, 20);
    check_surface(new Geom_CylindricalSurface(a, 12), 0, 2 * pi, -5, 40);
    check_surface(new Geom_ConicalSurface(a, 0.4, 8), 0, 2 * pi, -8 / std::sin(0.4), 30);
    check_surface(new Geom_ConicalSurface(a, -0.3, 8), -1, 2, -5, 10);
    check_surface(new Geom_SphericalSurface(a, 9), 0, 2 * pi, -pi / 2, pi / 2);
    check_surface(new Geom_ToroidalSurface(a, 20, 6), 0, 2 * pi, 0, 2 * pi);
  }
}

TEST_CASE("surface: b-splines of degree 1 to 9, rational or not, at knots and ends") {
  for (const bool rational : {false, true}) {
    for (int pu = 1; pu <= 6; ++pu)
      for (int pv = 1; pv <= 6; ++pv) {
        const auto s = bspline(pu + 5, pv + 4, pu, pv, rational);
        double u0, u1, v0, v1;
        s->Bounds(u0, u1, v0, v1);
        check_surface(s, u0, u1, v0, v1);
      }
    const auto s = bspline(14, 12, 9, 8, rational);
    double u0, u1, v0, v1;
    s->Bounds(u0, u1, v0, v1);
    check_surface(s, u0, u1, v0, v1);
    check_bounds(s, u0, u1, v0, v1, 2);
    const auto bicubic = bspline(9, 9, 3, 3, rational, 3);
    bicubic->Bounds(u0, u1, v0, v1);
    check_surface(bicubic, u0, u1, v0, v1);
    check_bounds(bicubic, u0, u1, v0, v1, 2);
  }
}

namespace {

// B-spline functions and their first two derivatives by the recursion of Cox and de Boor, in long double.
// OpenCASCADE's own evaluation loses up to nine digits at these degrees.
std::array<std::vector<long double>, 3> cox_de_boor(const std::vector<double>& k, int p, double t) {
  const int n = static_cast<int>(k.size()) - p - 1;
  int span = p;
  while (span + 1 < n && t >= k[span + 1]) ++span;
  std::vector<std::vector<long double>> value(p + 1, std::vector<long double>(n + p, 0));  // [degree][function]
  const auto over = [](long double a, long double b) { return b > 0 ? a / b : 0; };
  value[0][span] = 1;
  for (int d = 1; d <= p; ++d)
    for (int i = 0; i + d < n + p; ++i)
      value[d][i] =
          over(static_cast<long double>(t) - k[i], static_cast<long double>(k[i + d]) - k[i]) * value[d - 1][i] +
          over(static_cast<long double>(k[i + d + 1]) - t, static_cast<long double>(k[i + d + 1]) - k[i + 1]) *
              value[d - 1][i + 1];
  const auto derived = [&](const std::vector<long double>& lower, int d) {
    std::vector<long double> out(n + p, 0);
    for (int i = 0; i + d < n + p; ++i)
      out[i] = d * (over(lower[i], static_cast<long double>(k[i + d]) - k[i]) -
                    over(lower[i + 1], static_cast<long double>(k[i + d + 1]) - k[i + 1]));
    return out;
  };
  return {value[p], derived(value[p - 1], p), derived(derived(value[p - 2], p - 1), p)};
}

std::vector<double> flat(const TColStd_Array1OfReal& knots, const TColStd_Array1OfInteger& multiplicities) {
  std::vector<double> k;
  for (int i = knots.Lower(); i <= knots.Upper(); ++i) k.insert(k.end(), multiplicities(i), knots(i));
  return k;
}

}  // namespace

TEST_CASE("surface: b-splines of high degree, with few control points a span and with many, either direction higher") {
  for (const bool rational : {false, true}) {
    CAPTURE(rational);
    for (const auto& [pu, pv] : {std::pair{2, 14}, {14, 2}, {12, 11}, {2, 25}}) {
      CAPTURE(pu);
      CAPTURE(pv);
      for (const int more : {1, 4}) {
        const auto given = bspline(pu + more, pv + more, pu, pv, rational);
        const auto surface = make_surface(given);
        const auto ku = flat(given->UKnots(), given->UMultiplicities()),
                   kv = flat(given->VKnots(), given->VMultiplicities());
        for (const double u : parameters(ku.front(), ku.back(), surface->u_breaks())) {
          for (const double v : parameters(kv.front(), kv.back(), surface->v_breaks())) {
            const auto fu = cox_de_boor(ku, pu, u), fv = cox_de_boor(kv, pv, v);
            long double a[3][3][4] = {};
            for (int k = 0; k < 3; ++k)
              for (int l = 0; k + l < 3; ++l)
                for (int i = 1; i <= given->NbUPoles(); ++i)
                  for (int j = 1; j <= given->NbVPoles(); ++j) {
                    const long double w = fu[k][i - 1] * fv[l][j - 1] * given->Weight(i, j);
                    for (int c = 0; c < 3; ++c) a[k][l][c] += w * given->Pole(i, j).Coord(c + 1);
                    a[k][l][3] += w;
                  }
            Vec3 p, du, duu, duv;
            double size = 1;
            for (int c = 0; c < 3; ++c) {
              const long double w = a[0][0][3], x = a[0][0][c] / w;
              const long double xu = (a[1][0][c] - a[1][0][3] * x) / w, xv = (a[0][1][c] - a[0][1][3] * x) / w;
              p[c] = static_cast<double>(x);
              du[c] = static_cast<double>(xu);
              duu[c] = static_cast<double>((a[2][0][c] - 2 * a[1][0][3] * xu - a[2][0][3] * x) / w);
              duv[c] = static_cast<double>((a[1][1][c] - a[1][0][3] * xv - a[0][1][3] * xu - a[1][1][3] * x) / w);
              size += std::abs(p[c]);
            }
            const SurfacePoint s = surface->evaluate(u, v);
            CAPTURE(u);
            CAPTURE(v);
            // A derivative differs by what rounding does to it: the degree times as much for each order.
            CHECK((s.p - p).norm() <= 1e-13 * size);
            CHECK((surface->point(u, v) - p).norm() <= 1e-13 * size);
            CHECK((s.du - du).norm() <= 1e-13 * size * 4 * pu);
            CHECK((s.duu - duu).norm() <= 1e-13 * size * 16 * pu * pu);
            CHECK((s.duv - duv).norm() <= 1e-13 * size * 16 * pu * pv);
          }
        }
      }
    }
  }
}

TEST_CASE("surface: a knot of full multiplicity is reported as a kink") {
  const auto surface = make_surface(bspline(12, 8, 3, 3, false, 3));
  const auto breaks = surface->u_breaks();
  REQUIRE(breaks.size() >= 2);
  CHECK(breaks[0].continuity == 2);
  CHECK(breaks[1].continuity == 0);
}

TEST_CASE("surface: many poles find their span") {
  std::vector<double> knots{0.0};
  std::vector<int> multiplicities{4};
  double at = 0;
  for (int i = 0; i < 1019; ++i) {
    at += i % 97 == 0 ? 10 : 1e-3 * (1 + i % 5);  // uneven by four orders of magnitude
    knots.push_back(at);
    multiplicities.push_back(1);
  }
  knots.push_back(at + 1);
  multiplicities.push_back(4);
  const Handle(Geom_BSplineSurface) s = new Geom_BSplineSurface(
      wavy_net(1023, 4, 1), array_of<TColStd_Array1OfReal>(knots),
      array_of<TColStd_Array1OfReal>(std::vector<double>{0, 1}), array_of<TColStd_Array1OfInteger>(multiplicities),
      array_of<TColStd_Array1OfInteger>(std::vector<int>{4, 4}), 3, 3);
  const auto surface = make_surface(s);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> t(0, at + 1);
  for (int i = 0; i < 3000; ++i) {
    const double u = i < 1000 ? knots[i] : t(random);
    CHECK(gap(surface->point(u, 0.3), s->Value(u, 0.3)) < 1e-8);
    CHECK(gap(surface->evaluate(u, 0.3).p, s->Value(u, 0.3)) < 1e-8);
  }
}

TEST_CASE("surface: a periodic b-spline closes, and parameters beyond its range wrap") {
  for (const bool rational : {false, true}) {
    const auto s = periodic_bspline(rational);
    check_surface(s, 0, 7, 0, 2);
    const auto surface = make_surface(s);
    CHECK(surface->u_period() == 7);
    CHECK(surface->v_period() == 0);
    CHECK((surface->point(0, 1) - surface->point(7, 1)).norm() < 1e-12);
    CHECK((surface->point(1.3, 1) - surface->point(8.3, 1)).norm() < 1e-12);
    CHECK((surface->point(6.5, 1) - surface->point(-0.5, 1)).norm() < 1e-12);
    const SurfaceBounds across = surface->bounds(6.5, 7.5, 0, 2);
    for (int i = 0; i <= 20; ++i) CHECK(surface->evaluate(6.5 + i / 20.0, 0.7).duu.norm() <= across.duu * (1 + 1e-12));
  }
}

TEST_CASE("surface: Bezier, trimmed, swept and offset types") {
  check_surface(new Geom_BezierSurface(wavy_net(4, 3, 5)), 0, 1, 0, 1);
  check_surface(new Geom_BezierSurface(wavy_net(4, 6, 5), some_weights(4, 6, 9)), 0, 1, 0, 1);
  check_surface(new Geom_RectangularTrimmedSurface(new Geom_CylindricalSurface(axes, 4), 1.0, 2.0, -3.0, 5.0), 1, 2, -3,
                5);

  const auto curve = bspline_curve(8, 3, false), rational = bspline_curve(9, 4, true);
  const double first = curve->FirstParameter(), last = curve->LastParameter();
  check_surface(new Geom_SurfaceOfLinearExtrusion(curve, gp_Dir(0.2, 0.1, 1)), first, last, -3, 8);
  check_surface(new Geom_SurfaceOfRevolution(curve, gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(0.1, -0.2, 1))), 0, 2 * pi, first,
                last);
  check_surface(new Geom_SurfaceOfRevolution(rational, axes.Axis()), -1, 4, rational->FirstParameter(),
                rational->LastParameter());
  check_surface(new Geom_SurfaceOfLinearExtrusion(new Geom_Ellipse(axes.Ax2(), 9, 4), gp_Dir(1, 0, 0.3)), 0, 2 * pi, 0,
                5);
  check_surface(new Geom_SurfaceOfRevolution(new Geom_Line(gp_Pnt(9, 0, 0), gp_Dir(0, 0.4, 1)), gp::OZ()), 0, 2 * pi,
                -4, 9);
  check_bounds(new Geom_SurfaceOfRevolution(rational, axes.Axis()), 0, 2 * pi, rational->FirstParameter(),
               rational->LastParameter(), 2);

  for (const double offset : {-1.5, 2.0}) {
    check_surface(new Geom_OffsetSurface(new Geom_Plane(axes), offset), -3, 4, 5, 6);
    check_surface(new Geom_OffsetSurface(new Geom_CylindricalSurface(axes, 6), offset), 0, 6, 0, 4);
    check_surface(new Geom_OffsetSurface(new Geom_ConicalSurface(axes, 0.5, 6), offset), 0, 6, 0, 4);
    check_surface(new Geom_OffsetSurface(new Geom_SphericalSurface(axes, 6), offset), 0, 6, -1, 1);
    check_surface(new Geom_OffsetSurface(new Geom_ToroidalSurface(axes, 16, 4), offset), 0, 6, 0, 6);
    check_surface(new Geom_OffsetSurface(new Geom_BezierSurface(wavy_net(4, 4, 5)), offset), 0, 1, 0, 1);
    check_surface(new Geom_OffsetSurface(new Geom_BezierSurface(wavy_net(4, 4, 5), some_weights(4, 4, 2)), offset), 0,
                  1, 0, 1);
    check_surface(new Geom_OffsetSurface(new Geom_SurfaceOfLinearExtrusion(curve, gp_Dir(0.2, 0.1, 1)), offset), first,
                  last, -3, 8);
    check_surface(new Geom_OffsetSurface(
                      new Geom_SurfaceOfRevolution(curve, gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(0.1, -0.2, 1))), offset),
                  0, 2 * pi, first, last);
  }
}

TEST_CASE("surface: the closed-form feet hold the closest point of a dense sampling") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(-40, 40);
  struct Case {
    Handle(Geom_Surface) surface;
    double u1, v0, v1;
  };
  const Case cases[] = {{new Geom_CylindricalSurface(axes, 12), 2 * pi, -90, 90},
                        {new Geom_ConicalSurface(axes, 0.4, 8), 2 * pi, -110, 90},
                        {new Geom_SphericalSurface(axes, 9), 2 * pi, -pi / 2, pi / 2},
                        {new Geom_ToroidalSurface(axes, 20, 6), 2 * pi, 0, 2 * pi},
                        {new Geom_ToroidalSurface(axes, 10, 14), 2 * pi, 0, 2 * pi}};
  for (const Case& c : cases) {
    const auto surface = make_surface(c.surface);
    CAPTURE(c.surface->DynamicType()->Name());
    for (int i = 0; i < 20; ++i) {
      const Vec3 p(coordinate(random), coordinate(random), coordinate(random));
      Vec2 feet[2];
      const int n = surface->closest(p, feet);
      REQUIRE(n >= 1);
      double best = 1e300;
      for (int k = 0; k < n; ++k) best = std::min(best, (surface->point(feet[k][0], feet[k][1]) - p).norm());
      double sampled = 1e300;
      for (int a = 0; a < 200; ++a)
        for (int b = 0; b <= 200; ++b)
          sampled = std::min(sampled, (surface->point(c.u1 * a / 200, c.v0 + (c.v1 - c.v0) * b / 200) - p).norm());
      CHECK(best <= sampled + 1e-12);
      CHECK(sampled <= best + 2);
    }
  }
}

TEST_CASE("curve: 2D types equal OpenCASCADE's") {
  const gp_Ax22d a(gp_Pnt2d(3, 4), gp_Dir2d(1, 0.4), true), left(gp_Pnt2d(3, 4), gp_Dir2d(1, 0.4), false);
  for (const gp_Ax22d& axis : {a, left}) {
    check_curve2(new Geom2d_Circle(axis, 5), 0, 2 * pi);
    check_curve2(new Geom2d_Ellipse(axis, 5, 2), 0, 2 * pi);
    check_curve2(new Geom2d_Parabola(gp_Parab2d(axis, 1.5)), -4, 3);
    check_curve2(new Geom2d_Hyperbola(gp_Hypr2d(axis, 2, 1.5)), -2, 1);
  }
  check_curve2(new Geom2d_Line(gp_Pnt2d(1, 2), gp_Dir2d(3, -1)), -5, 9);
  TColgp_Array1OfPnt2d poles(1, 6);
  TColStd_Array1OfReal weights(1, 6);
  for (int i = 1; i <= 6; ++i) {
    poles(i) = gp_Pnt2d(i, std::sin(2 * i));
    weights(i) = 1 + 0.3 * std::cos(i);
  }
  check_curve2(new Geom2d_BezierCurve(poles), 0, 1);
  check_curve2(new Geom2d_BezierCurve(poles, weights), 0, 1);
  check_curve2(new Geom2d_OffsetCurve(new Geom2d_BezierCurve(poles), 0.2), 0, 1);
  check_curve2(new Geom2d_TrimmedCurve(new Geom2d_Circle(a, 5), 1, 2), 1, 2);
  const auto knots = array_of<TColStd_Array1OfReal>(std::vector<double>{0, 0.4, 1, 3});
  const auto multiplicities = array_of<TColStd_Array1OfInteger>(std::vector<int>{4, 1, 1, 4});
  check_curve2(new Geom2d_BSplineCurve(poles, knots, multiplicities, 3), 0, 3);
  check_curve2(new Geom2d_BSplineCurve(poles, weights, knots, multiplicities, 3), 0, 3);
  const auto turns = array_of<TColStd_Array1OfReal>(std::vector<double>{0, 1, 2, 3, 4, 5, 6});
  const auto ones = array_of<TColStd_Array1OfInteger>(std::vector<int>{1, 1, 1, 1, 1, 1, 1});
  check_curve2(new Geom2d_BSplineCurve(poles, turns, ones, 2, true), 0, 6);
}

TEST_CASE("curve: 3D types equal OpenCASCADE's") {
  const gp_Ax2 a = axes.Ax2();
  check_curve3(new Geom_Line(gp_Pnt(1, 2, 3), gp_Dir(1, 2, -1)), -2, 7);
  check_curve3(new Geom_Circle(a, 6), 0, 2 * pi);
  check_curve3(new Geom_Ellipse(a, 6, 2), 0, 2 * pi);
  check_curve3(new Geom_Parabola(gp_Parab(a, 2)), -3, 5);
  check_curve3(new Geom_Hyperbola(gp_Hypr(a, 3, 2)), -2, 2);
  for (const bool rational : {false, true}) {
    const auto c = bspline_curve(9, 4, rational);
    check_curve3(c, c->FirstParameter(), c->LastParameter());
    check_curve3(new Geom_OffsetCurve(c, 0.3, gp_Dir(0, 1, 0.1)), c->FirstParameter(), c->LastParameter());
  }
}

TEST_CASE("surface: what has no evaluator is refused by name") {
  CHECK_THROWS_AS(make_surface(Handle(Geom_Surface)()), CadError);
  CHECK_THROWS_AS(make_curve2(Handle(Geom2d_Curve)(), 0, 1), CadError);
}

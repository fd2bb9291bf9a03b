#include "libtri/surfaces/geometry_occt.hpp"

#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom2d_Hyperbola.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_OffsetCurve.hxx>
#include <Geom2d_Parabola.hxx>
#include <Geom2d_TrimmedCurve.hxx>
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
#include <Standard_Failure.hxx>
#include <cmath>
#include <string>
#include <vector>

#include "libtri/surfaces/bspline_surface.hpp"
#include "libtri/surfaces/curve_types.hpp"
#include "libtri/surfaces/elementary_surface.hpp"
#include "libtri/surfaces/swept_surface.hpp"
#include "meshops/error.hpp"

namespace tri {

namespace {

Vec3 vec(const gp_XYZ& p) {
  return {p.X(), p.Y(), p.Z()};
}
Vec3 vec(const gp_Pnt& p) {
  return vec(p.XYZ());
}
Vec3 vec(const gp_Dir& d) {
  return vec(d.XYZ());
}
Vec2 vec(const gp_Pnt2d& p) {
  return {p.X(), p.Y()};
}
Vec2 vec(const gp_Dir2d& d) {
  return {d.X(), d.Y()};
}

Frame frame(const gp_Ax3& a) {
  return {vec(a.Location()), vec(a.XDirection()), vec(a.YDirection()), vec(a.Direction())};
}

std::vector<double> bezier_knots(int degree) {
  std::vector<double> knots(degree + 1, 0.0);
  knots.resize(2 * degree + 2, 1.0);
  return knots;
}

std::vector<double> values(const TColStd_Array1OfReal& array) {
  return {array.begin(), array.end()};
}

template <class Curve, class Vec>
void read_poles(const Curve& curve, std::vector<Vec>& poles, std::vector<double>& weights) {
  for (int i = 1; i <= curve.NbPoles(); ++i) {
    poles.push_back(vec(curve.Pole(i)));
    if (curve.IsRational()) weights.push_back(curve.Weight(i));
  }
}

template <class Surface>
void read_net(const Surface& surface, std::vector<Vec3>& poles, std::vector<double>& weights) {
  const bool rational = surface.IsURational() || surface.IsVRational();
  for (int i = 1; i <= surface.NbUPoles(); ++i) {
    for (int j = 1; j <= surface.NbVPoles(); ++j) {
      poles.push_back(vec(surface.Pole(i, j)));
      if (rational) weights.push_back(surface.Weight(i, j));
    }
  }
}

template <class Vec, class BSpline>
CurvePtr<Vec> from_bspline(const opencascade::handle<BSpline>& original) {
  opencascade::handle<BSpline> curve = original;
  double period = 0;
  if (curve->IsPeriodic()) {
    period = curve->LastParameter() - curve->FirstParameter();
    curve = opencascade::handle<BSpline>::DownCast(original->Copy());
    curve->SetNotPeriodic();
  }
  std::vector<Vec> poles;
  std::vector<double> weights;
  read_poles(*curve, poles, weights);
  return make_bspline_curve<Vec>(BSplineBasis(curve->Degree(), values(curve->KnotSequence()), period), poles, weights);
}

template <class Vec, class Bezier>
CurvePtr<Vec> from_bezier(const Bezier& curve) {
  std::vector<Vec> poles;
  std::vector<double> weights;
  read_poles(curve, poles, weights);
  return make_bspline_curve<Vec>(BSplineBasis(curve.Degree(), bezier_knots(curve.Degree())), poles, weights);
}

template <class Vec, class Axes>
CurvePtr<Vec> hyperbola(const Axes& axes, double major, double minor) {
  return make_hyperbola<Vec>(vec(axes.Location()), vec(axes.XDirection()) * major, vec(axes.YDirection()) * minor);
}

template <class Vec, class Axes>
CurvePtr<Vec> ellipse(const Axes& axes, double major, double minor) {
  return make_ellipse<Vec>(vec(axes.Location()), vec(axes.XDirection()) * major, vec(axes.YDirection()) * minor);
}

template <class Vec, class Axes>
CurvePtr<Vec> parabola(const Axes& axes, double focal) {
  if (!(focal > 0)) throw CadError("parabola without focal length");
  return make_parabola<Vec>(vec(axes.Location()), vec(axes.XDirection()) / (4 * focal), vec(axes.YDirection()));
}

std::shared_ptr<const Surface> from_bspline(const Handle(Geom_BSplineSurface) & original) {
  Handle(Geom_BSplineSurface) surface = original;
  double u1, u2, v1, v2;
  surface->Bounds(u1, u2, v1, v2);
  double u_period = 0, v_period = 0;
  if (surface->IsUPeriodic() || surface->IsVPeriodic()) {
    surface = Handle(Geom_BSplineSurface)::DownCast(original->Copy());
    if (surface->IsUPeriodic()) {
      u_period = u2 - u1;
      surface->SetUNotPeriodic();
    }
    if (surface->IsVPeriodic()) {
      v_period = v2 - v1;
      surface->SetVNotPeriodic();
    }
  }
  std::vector<Vec3> poles;
  std::vector<double> weights;
  read_net(*surface, poles, weights);
  return std::make_shared<BSplineSurface>(BSplineBasis(surface->UDegree(), values(surface->UKnotSequence()), u_period),
                                          BSplineBasis(surface->VDegree(), values(surface->VKnotSequence()), v_period),
                                          poles, weights);
}

// An elementary surface's offset is of the same type with the same parameterisation; OpenCASCADE's normal is du x dv.
std::shared_ptr<const Surface> offset_of(const Handle(Geom_Surface) & base, double distance) {
  const auto radial = [&](const gp_Ax3& a) { return a.Direct() ? distance : -distance; };
  if (const auto s = Handle(Geom_RectangularTrimmedSurface)::DownCast(base))
    return offset_of(s->BasisSurface(), distance);
  if (const auto s = Handle(Geom_Plane)::DownCast(base)) {
    Frame f = frame(s->Position());
    f.origin += f.x % f.y * distance;
    return make_plane(f);
  }
  if (const auto s = Handle(Geom_CylindricalSurface)::DownCast(base)) {
    const double r = s->Radius() + radial(s->Position());
    if (r > 0) return make_cylinder(frame(s->Position()), r);
  }
  if (const auto s = Handle(Geom_SphericalSurface)::DownCast(base)) {
    const double r = s->Radius() + radial(s->Position());
    if (r > 0) return make_sphere(frame(s->Position()), r);
  }
  if (const auto s = Handle(Geom_ToroidalSurface)::DownCast(base)) {
    const double r = s->MinorRadius() + radial(s->Position());
    if (r > 0 && s->MajorRadius() > s->MinorRadius()) return make_torus(frame(s->Position()), s->MajorRadius(), r);
  }
  if (const auto s = Handle(Geom_ConicalSurface)::DownCast(base)) {
    Frame f = frame(s->Position());
    const double d = radial(s->Position()), a = s->SemiAngle();
    f.origin -= f.z * (d * std::sin(a));
    return make_cone(f, s->RefRadius() + d * std::cos(a), a);
  }
  const std::shared_ptr<const Surface> flat = make_surface(base);
  try {
    return make_offset_surface(flat, distance);
  } catch (const CadError&) {
    throw CadError("offset surface over a " + std::string(base->DynamicType()->Name()) + " that degenerates");
  }
}

}  // namespace

std::shared_ptr<const Surface> make_surface(const Handle(Geom_Surface) & surface) {
  if (surface.IsNull()) throw CadError("face without a surface");
  try {
    if (const auto s = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface))
      return make_surface(s->BasisSurface());
    if (const auto s = Handle(Geom_BSplineSurface)::DownCast(surface)) return from_bspline(s);
    if (const auto s = Handle(Geom_BezierSurface)::DownCast(surface)) {
      std::vector<Vec3> poles;
      std::vector<double> weights;
      read_net(*s, poles, weights);
      return std::make_shared<BSplineSurface>(BSplineBasis(s->UDegree(), bezier_knots(s->UDegree())),
                                              BSplineBasis(s->VDegree(), bezier_knots(s->VDegree())), poles, weights);
    }
    if (const auto s = Handle(Geom_Plane)::DownCast(surface)) return make_plane(frame(s->Position()));
    if (const auto s = Handle(Geom_CylindricalSurface)::DownCast(surface))
      return make_cylinder(frame(s->Position()), s->Radius());
    if (const auto s = Handle(Geom_ConicalSurface)::DownCast(surface))
      return make_cone(frame(s->Position()), s->RefRadius(), s->SemiAngle());
    if (const auto s = Handle(Geom_SphericalSurface)::DownCast(surface))
      return make_sphere(frame(s->Position()), s->Radius());
    if (const auto s = Handle(Geom_ToroidalSurface)::DownCast(surface))
      return make_torus(frame(s->Position()), s->MajorRadius(), s->MinorRadius());
    if (const auto s = Handle(Geom_SurfaceOfRevolution)::DownCast(surface)) {
      const gp_Ax1 axis = s->Axis();
      return make_revolution(make_curve3(s->BasisCurve()), vec(axis.Location()), vec(axis.Direction()));
    }
    if (const auto s = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(surface))
      return make_extrusion(make_curve3(s->BasisCurve()), vec(s->Direction()));
    if (const auto s = Handle(Geom_OffsetSurface)::DownCast(surface)) return offset_of(s->BasisSurface(), s->Offset());
  } catch (const Standard_Failure& failure) {
    throw CadError(std::string("surface of type ") + surface->DynamicType()->Name() + ": " +
                   failure.GetMessageString());
  }
  throw CadError(std::string("no evaluator for a surface of type ") + surface->DynamicType()->Name());
}

std::shared_ptr<const Curve2> make_curve2(const Handle(Geom2d_Curve) & curve, double first, double last) {
  if (curve.IsNull()) throw CadError("edge without a curve in its face's (u,v)");
  try {
    if (const auto c = Handle(Geom2d_TrimmedCurve)::DownCast(curve)) return make_curve2(c->BasisCurve(), first, last);
    if (const auto c = Handle(Geom2d_Line)::DownCast(curve))
      return make_line<Vec2>(vec(c->Location()), vec(c->Direction()));
    if (const auto c = Handle(Geom2d_BSplineCurve)::DownCast(curve)) return from_bspline<Vec2>(c);
    if (const auto c = Handle(Geom2d_BezierCurve)::DownCast(curve)) return from_bezier<Vec2>(*c);
    if (const auto c = Handle(Geom2d_Circle)::DownCast(curve))
      return ellipse<Vec2>(c->Position(), c->Radius(), c->Radius());
    if (const auto c = Handle(Geom2d_Ellipse)::DownCast(curve))
      return ellipse<Vec2>(c->Position(), c->MajorRadius(), c->MinorRadius());
    if (const auto c = Handle(Geom2d_Parabola)::DownCast(curve)) return parabola<Vec2>(c->Position(), c->Focal());
    if (const auto c = Handle(Geom2d_Hyperbola)::DownCast(curve))
      return hyperbola<Vec2>(c->Position(), c->MajorRadius(), c->MinorRadius());
    if (const auto c = Handle(Geom2d_OffsetCurve)::DownCast(curve))
      return make_offset_curve(make_curve2(c->BasisCurve(), first, last), c->Offset());
  } catch (const Standard_Failure& failure) {
    throw CadError(std::string("curve of type ") + curve->DynamicType()->Name() + ": " + failure.GetMessageString());
  }
  throw CadError(std::string("no evaluator for a curve of type ") + curve->DynamicType()->Name());
}

std::shared_ptr<const Curve3> make_curve3(const Handle(Geom_Curve) & curve) {
  if (curve.IsNull()) throw CadError("curve missing");
  try {
    if (const auto c = Handle(Geom_TrimmedCurve)::DownCast(curve)) return make_curve3(c->BasisCurve());
    if (const auto c = Handle(Geom_Line)::DownCast(curve))
      return make_line<Vec3>(vec(c->Lin().Location()), vec(c->Lin().Direction()));
    if (const auto c = Handle(Geom_BSplineCurve)::DownCast(curve)) return from_bspline<Vec3>(c);
    if (const auto c = Handle(Geom_BezierCurve)::DownCast(curve)) return from_bezier<Vec3>(*c);
    if (const auto c = Handle(Geom_Circle)::DownCast(curve))
      return ellipse<Vec3>(c->Position(), c->Radius(), c->Radius());
    if (const auto c = Handle(Geom_Ellipse)::DownCast(curve))
      return ellipse<Vec3>(c->Position(), c->MajorRadius(), c->MinorRadius());
    if (const auto c = Handle(Geom_Parabola)::DownCast(curve)) return parabola<Vec3>(c->Position(), c->Focal());
    if (const auto c = Handle(Geom_Hyperbola)::DownCast(curve))
      return hyperbola<Vec3>(c->Position(), c->MajorRadius(), c->MinorRadius());
    if (const auto c = Handle(Geom_OffsetCurve)::DownCast(curve))
      return make_offset_curve(make_curve3(c->BasisCurve()), c->Offset(), vec(c->Direction()));
  } catch (const Standard_Failure& failure) {
    throw CadError(std::string("curve of type ") + curve->DynamicType()->Name() + ": " + failure.GetMessageString());
  }
  throw CadError(std::string("no evaluator for a curve of type ") + curve->DynamicType()->Name());
}

}  // namespace tri

// A thin, twisted fan blade, open at its root. z runs from root to tip.
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>

#include "libtri/parts/parts.hpp"

namespace tri::parts {
namespace {

constexpr double blade_height = 120, edge_radius = 0.3;

// One profile at the share h of the height: suction side, trailing edge, pressure side, leading edge.
TopoDS_Wire section(double h) {
  const double chord = 40 - 8 * h, twist = (12 + 38 * h) * M_PI / 180, thickest = 2.0 - 0.9 * h;
  const auto place = [&](double x, double y) {
    x -= 0.45 * chord;
    return gp_Pnt(x * std::cos(twist) - y * std::sin(twist), x * std::sin(twist) + y * std::cos(twist),
                  blade_height * h);
  };
  // A parabolic camber line of 8% and half the thickness across it; s in [0,1] along the chord.
  const auto at = [&](double s, double side) {
    const double slope = 0.32 * (1 - 2 * s);
    const double half =
        edge_radius + (0.5 * thickest - edge_radius) * std::pow(4 * s * (1 - s), 0.8) * (1.25 - 0.5 * s) / 1.02;
    const double length = std::hypot(1.0, slope);
    return place(chord * s - side * half * slope / length, 0.32 * chord * s * (1 - s) + side * half / length);
  };
  const auto nose = [&](double s, double sign) {
    const double slope = 0.32 * (1 - 2 * s), length = std::hypot(1.0, slope);
    return place(chord * s + sign * edge_radius / length,
                 0.32 * chord * s * (1 - s) + sign * edge_radius * slope / length);
  };
  const auto spline = [&](double side) {
    constexpr int n = 13;
    Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, n);
    // The same parameters in every section, so that the loft needs no knots beyond theirs.
    Handle(TColStd_HArray1OfReal) parameters = new TColStd_HArray1OfReal(1, n);
    for (int i = 0; i < n; ++i) {
      const double s = 0.5 * (1 - std::cos(M_PI * i / (n - 1)));
      points->SetValue(i + 1, at(side > 0 ? s : 1 - s, side));
      parameters->SetValue(i + 1, s);
    }
    GeomAPI_Interpolate fit(points, parameters, false, 1e-9);
    fit.Perform();
    return fit.Curve();
  };
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(spline(1)));
  wire.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(1, 1), nose(1, 1), at(1, -1)).Value()));
  wire.Add(BRepBuilderAPI_MakeEdge(spline(-1)));
  wire.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(0, -1), nose(0, -1), at(0, 1)).Value()));
  return wire.Wire();
}

}  // namespace

TopoDS_Shape blade() {
  BRepOffsetAPI_ThruSections loft(false, false, 1e-5);
  loft.CheckCompatibility(false);
  constexpr int sections = 7;
  for (int i = 0; i < sections; ++i) loft.AddWire(section(double(i) / (sections - 1)));
  loft.Build();
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer it(loft.Shape(), TopAbs_FACE); it.More(); it.Next()) faces.push_back(it.Current());
  faces.push_back(BRepBuilderAPI_MakeFace(section(1), true).Shape());
  return joined(faces, 1e-3, gp_Pnt(-30, 40, 0.5 * blade_height));
}

}  // namespace tri::parts

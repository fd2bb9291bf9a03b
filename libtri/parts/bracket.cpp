// A bracket bent from sheet metal 1 mm thick: two flanges and a web, four through holes.
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <cmath>
#include <gp_Ax2.hxx>

#include "libtri/parts/parts.hpp"

namespace tri::parts {
namespace {

constexpr double thickness = 1, inner_radius = 2, outer_radius = inner_radius + thickness;
constexpr double width = 40, base = 50, web = 30, top = 25;

// The sheet's cross-section, a Z with rounded bends, in the plane y = 0.
TopoDS_Face profile() {
  const auto at = [](double x, double z) { return gp_Pnt(x, 0, z); };
  const auto arc = [&](double x, double z, double radius, double from, double to) {
    const auto on = [&](double a) { return at(x + radius * std::cos(a), z + radius * std::sin(a)); };
    return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(on(from), on(0.5 * (from + to)), on(to)).Value()).Edge();
  };
  const auto line = [&](const gp_Pnt& a, const gp_Pnt& b) { return BRepBuilderAPI_MakeEdge(a, b).Edge(); };
  // Centres of the two bends: the base turns up into the web, the web turns away into the top flange.
  const double x1 = base - outer_radius, z1 = outer_radius;
  const double x2 = base - thickness + outer_radius, z2 = web - outer_radius;
  const double end = x2 + top;
  BRepBuilderAPI_MakeWire wire;
  wire.Add(line(at(0, 0), at(x1, 0)));
  wire.Add(arc(x1, z1, outer_radius, -M_PI / 2, 0));
  wire.Add(line(at(base, z1), at(base, z2)));
  wire.Add(arc(x2, z2, inner_radius, M_PI, M_PI / 2));
  wire.Add(line(at(x2, web - thickness), at(end, web - thickness)));
  wire.Add(line(at(end, web - thickness), at(end, web)));
  wire.Add(line(at(end, web), at(x2, web)));
  wire.Add(arc(x2, z2, outer_radius, M_PI / 2, M_PI));
  wire.Add(line(at(base - thickness, z2), at(base - thickness, z1)));
  wire.Add(arc(x1, z1, inner_radius, 0, -M_PI / 2));
  wire.Add(line(at(x1, thickness), at(0, thickness)));
  wire.Add(line(at(0, thickness), at(0, 0)));
  return BRepBuilderAPI_MakeFace(wire.Wire(), true).Face();
}

}  // namespace

TopoDS_Shape bracket() {
  TopoDS_Shape sheet = BRepPrimAPI_MakePrism(profile(), gp_Vec(0, width, 0)).Shape();
  // The four free corners of the flanges.
  sheet = filleted(sheet, 6, [](const gp_Pnt& p, const gp_Vec& t) {
    return std::abs(t.Z()) > 0.99 && (p.X() < 1 || p.X() > base + top);
  });
  sheet = cut(sheet, cylinder(14, 11, -5, 3.25, 10));
  sheet = cut(sheet, cylinder(14, width - 11, -5, 3.25, 10));
  sheet = cut(sheet, cylinder(base + 15, width / 2, web - 5, 4.5, 10));
  const gp_Ax2 through_web(gp_Pnt(base - 10, width / 2, web / 2), gp_Dir(1, 0, 0));
  sheet = cut(sheet, BRepPrimAPI_MakeCylinder(through_web, 7, 20).Shape());
  return only_solid(sheet);
}

}  // namespace tri::parts

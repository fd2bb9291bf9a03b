// A cast housing: an open box with rounded corners, four bosses with blind holes inside and one boss outside.
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <cmath>
#include <gp_Ax2.hxx>

#include "libtri/parts/parts.hpp"

namespace tri::parts {
namespace {

constexpr double length = 120, depth = 80, tall = 45, wall = 4, floor = 5;

}  // namespace

TopoDS_Shape housing() {
  TopoDS_Shape body = box(0, 0, 0, length, depth, tall);
  body = filleted(body, 12, [](const gp_Pnt&, const gp_Vec& t) { return vertical(t); });
  body = filleted(body, 3, [](const gp_Pnt& p, const gp_Vec&) { return level(p, 0); });

  TopoDS_Shape cavity = box(wall, wall, floor, length - 2 * wall, depth - 2 * wall, tall);
  cavity = filleted(cavity, 8, [](const gp_Pnt&, const gp_Vec& t) { return vertical(t); });
  cavity = filleted(cavity, 3, [](const gp_Pnt& p, const gp_Vec&) { return level(p, floor); });
  body = cut(body, cavity);

  for (const double x : {22.0, length - 22.0}) {
    for (const double y : {22.0, depth - 22.0}) body = fused(body, cylinder(x, y, floor - 1, 6, 28));
  }
  body = filleted(body, 2, [](const gp_Pnt& p, const gp_Vec& t) {
    return level(p, floor) && !vertical(t) && p.X() > 14 && p.X() < length - 14 && p.Y() > 14 && p.Y() < depth - 14;
  });
  for (const double x : {22.0, length - 22.0}) {
    for (const double y : {22.0, depth - 22.0}) body = cut(body, cylinder(x, y, 14, 2.5, 40));
  }
  // The boss for a sensor on the side wall, with a blind hole that stops in the wall.
  const gp_Ax2 out(gp_Pnt(length / 2, 1, tall / 2), gp_Dir(0, -1, 0));
  body = fused(body, BRepPrimAPI_MakeCylinder(out, 10, 13).Shape());
  body = filleted(body, 2.5, [](const gp_Pnt& p, const gp_Vec&) {
    return std::abs(p.Y()) < 1e-6 && std::hypot(p.X() - length / 2, p.Z() - tall / 2) < 10.5;
  });
  const gp_Ax2 bore(gp_Pnt(length / 2, -20, tall / 2), gp_Dir(0, 1, 0));
  body = cut(body, BRepPrimAPI_MakeCylinder(bore, 5, 18).Shape());
  return only_solid(body);
}

}  // namespace tri::parts

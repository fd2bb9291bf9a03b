// The outside of a pipe that turns by twice 45 degrees, open at both ends: every face closes on itself.
#include <BRepBuilderAPI_MakeFace.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <cmath>
#include <gp_Ax3.hxx>

#include "libtri/parts/parts.hpp"

namespace tri::parts {

TopoDS_Shape elbow() {
  constexpr double radius = 25, bend = 70, turn = M_PI / 4, full = 2 * M_PI;
  std::vector<TopoDS_Shape> faces;
  // The pipe runs in the plane y = 0; (x, z) is the centre of its current end, `angle` its direction from +x to +z.
  // All seams lie on the outer side of the bends, so that the rims of neighbours start at the same point.
  double x = 0, z = 0, angle = 0;
  const auto straight = [&](double length) {
    const gp_Dir along(std::cos(angle), 0, std::sin(angle)), outer(std::sin(angle), 0, -std::cos(angle));
    const Handle(Geom_CylindricalSurface) surface =
        new Geom_CylindricalSurface(gp_Ax3(gp_Pnt(x, 0, z), along, outer), radius);
    faces.push_back(BRepBuilderAPI_MakeFace(surface, 0, full, 0, length, 1e-7).Shape());
    x += length * std::cos(angle);
    z += length * std::sin(angle);
  };
  const auto curved = [&] {
    const gp_Dir outer(std::sin(angle), 0, -std::cos(angle));
    const gp_Pnt centre(x - bend * outer.X(), 0, z - bend * outer.Z());
    // About -y a positive angle turns +x towards +z.
    const Handle(Geom_ToroidalSurface) surface =
        new Geom_ToroidalSurface(gp_Ax3(centre, gp_Dir(0, -1, 0), outer), bend, radius);
    faces.push_back(BRepBuilderAPI_MakeFace(surface, 0, turn, 0, full, 1e-7).Shape());
    angle += turn;
    x = centre.X() + bend * std::sin(angle);
    z = centre.Z() - bend * std::cos(angle);
  };
  straight(60);
  curved();
  straight(30);
  curved();
  straight(80);
  return joined(faces, 1e-6, gp_Pnt(30, 200, 10));
}

}  // namespace tri::parts

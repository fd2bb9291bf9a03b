// A cap of a sphere: one face with a seam and, in its middle, a pole.
#include <BRepBuilderAPI_MakeFace.hxx>
#include <Geom_SphericalSurface.hxx>
#include <cmath>
#include <gp_Ax3.hxx>

#include "libtri/parts/parts.hpp"

namespace tri::parts {

TopoDS_Shape sphere_cap() {
  const Handle(Geom_SphericalSurface) sphere = new Geom_SphericalSurface(gp_Ax3(), 50);
  const TopoDS_Shape face = BRepBuilderAPI_MakeFace(sphere, 0, 2 * M_PI, M_PI / 6, M_PI / 2, 1e-6).Shape();
  return joined({face}, 1e-6, gp_Pnt(-20, -30, 100));
}

}  // namespace tri::parts

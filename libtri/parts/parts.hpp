#pragma once

// Builders of the example parts; included only by source files that wrap OpenCASCADE. All lengths are millimetres.
#include <BRepAdaptor_Curve.hxx>
#include <TopoDS_Shape.hxx>
#include <cmath>
#include <functional>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <vector>

namespace tri::parts {

TopoDS_Shape boot_lid();
TopoDS_Shape blade();
TopoDS_Shape bracket();
TopoDS_Shape elbow();
TopoDS_Shape housing();
TopoDS_Shape sphere_cap();
TopoDS_Shape fillet_block();

/// Says whether an edge is wanted, from its midpoint and the unit tangent there.
using EdgeFilter = std::function<bool(const gp_Pnt& middle, const gp_Vec& tangent)>;

/// Whether an edge runs along z, up or down; whether a point is at height `z`.
inline bool vertical(const gp_Vec& tangent) {
  return std::abs(tangent.Z()) > 0.99;
}
inline bool level(const gp_Pnt& p, double z) {
  return std::abs(p.Z() - z) < 1e-6;
}

/// `shape` with the edges that pass `wanted` (and those tangent to them) rounded by `radius` mm.
/// @throws CadError if OpenCASCADE cannot build the fillet or no edge passes.
TopoDS_Shape filleted(const TopoDS_Shape& shape, double radius, const EdgeFilter& wanted);

/// A box with corner (x, y, z) and extents (dx, dy, dz).
TopoDS_Shape box(double x, double y, double z, double dx, double dy, double dz);

/// A cylinder along +z, its bottom centre at (x, y, z).
TopoDS_Shape cylinder(double x, double y, double z, double radius, double height);

/// Boolean operations. @throws CadError if they fail.
TopoDS_Shape fused(const TopoDS_Shape& a, const TopoDS_Shape& b);
TopoDS_Shape cut(const TopoDS_Shape& a, const TopoDS_Shape& b);
TopoDS_Shape common(const TopoDS_Shape& a, const TopoDS_Shape& b);

/// Joins faces into one shell; edges nearer than `tolerance` mm become shared. The orientation is coherent, and such
/// that the normal of the face that holds `outside`'s nearest surface point looks to `outside`.
/// @throws CadError if the result is not exactly one shell.
TopoDS_Shape joined(const std::vector<TopoDS_Shape>& faces, double tolerance, const gp_Pnt& outside);

/// The only solid in `shape`. @throws CadError if it holds none or several.
TopoDS_Shape only_solid(const TopoDS_Shape& shape);

}  // namespace tri::parts

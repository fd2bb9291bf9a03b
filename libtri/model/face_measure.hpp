#pragma once

#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/model/cad_polylines.hpp"

namespace tri {

/// Parameters where a surface is less smooth, ascending; the ends need not be among them.
struct SurfaceBreaks {
  std::vector<double> u, v;
};

/// Share of one trimming curve in its face's area: the integral of F dv along it, F(u,v) being the area element
/// integrated from `u_start` to u. Over all loops, in their direction, the shares add up to the area (Green's theorem).
/// @param line  the curve's polyline: between its parameters the curve is smooth
double area_share(const Surface& surface, const SurfaceBreaks& breaks, const Curve2& curve,
                  const ParameterPolyline& line, double u_start);

/// True if (u,v) is inside the face's trimming polylines.
bool inside_loops(const CadFace& face, const Vec2& uv);

/// Extends the box by the inside of a face, where it reaches beyond; accurate to about 1e-9 of the face's size.
void extend_box(const CadFace& face, const SurfaceBreaks& breaks, Vec3& box_min, Vec3& box_max);

}  // namespace tri

#include "libtri/shape.hpp"

#include <BRepBuilderAPI_Sewing.hxx>
#include <TopExp_Explorer.hxx>

#include "libtri/shape_occt.hpp"

namespace tri {

Shape sewn(const Shape& shape, double tolerance) {
  int shells = 0;
  for (TopExp_Explorer it(occt(shape), TopAbs_SHELL); it.More(); it.Next()) ++shells;
  const bool has_solid = TopExp_Explorer(occt(shape), TopAbs_SOLID).More();
  if (has_solid || shells == 1) return shape;
  BRepBuilderAPI_Sewing sewing(tolerance);
  sewing.Add(occt(shape));
  sewing.Perform();
  return make_shape(sewing.SewedShape());
}

}  // namespace tri

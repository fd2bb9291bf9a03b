// A block with two pads and six round bosses, every edge rounded: 100 faces, 72 of them narrow fillets.
#include <cmath>

#include "libtri/parts/parts.hpp"

namespace tri::parts {
namespace {

constexpr double height = 30, pad_height = 8, boss_height = 10, radius = 0.8, corner_radius = 1.5;

}  // namespace

TopoDS_Shape fillet_block() {
  TopoDS_Shape block = box(0, 0, 0, 160, 100, height);
  for (const double x : {15.0, 105.0}) block = fused(block, box(x, 30, height, 40, 40, pad_height));
  for (const double x : {20.0, 80.0, 140.0}) {
    for (const double y : {14.0, 86.0}) block = fused(block, cylinder(x, y, height, 7, boss_height));
  }
  // Upright edges first: after that every rim is one tangent chain.
  const auto upright_corner = [](const gp_Pnt& p, const gp_Vec& t) {
    return vertical(t) && p.Y() != 14 && p.Y() != 86;
  };
  block = filleted(block, corner_radius, upright_corner);
  block = filleted(block, radius, [](const gp_Pnt& p, const gp_Vec& t) {
    return !vertical(t) &&
           (level(p, 0) || level(p, height) || level(p, height + pad_height) || level(p, height + boss_height));
  });
  return only_solid(block);
}

}  // namespace tri::parts

#pragma once

#include "meshops/context.hpp"
#include "meshops/crossings/arrangement/part_sheets.hpp"

namespace tri {

/// Parts vertices that lie in one place and could not move: of those in a place, all fans but one lose their tips.
///
/// Around the place the surface of a fan divides a small sphere in two. On a side where nothing else lies the part of
/// the sphere takes the place of the tip: its polygon is cut into ears, which hold the place off by flat triangles. So
/// a corner of a solid loses a little material, or a notch is filled a little. Every new triangle is tested, exactly,
/// against all that is near; where it would meet something a smaller sphere is tried, and where none fits the fan
/// stays. Edges at the tip end a little beside where they were, off others that lie there as well.
/// @param height  grid steps: how far from the place tips are cut; where nothing fits there, up to 25 times as far
/// @return how many vertices still lie upon others
std::size_t cut_tips(PlacedBoundary& boundary, double height, Context& context);

}  // namespace tri

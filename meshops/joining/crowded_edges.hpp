#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/joining/side_pairs.hpp"

namespace tri {

/// Pairs the sides of edges of three or more, so that sheets come apart without crossing each other.
///
/// The sides of an edge are taken in angular order about it. Sheets that end there (with a single side of their shell,
/// a set of triangles joined over edges of two sides) are left out at first, unless the others alone do not come out
/// even: a fin does not tear a solid open. The rest is paired so that each pair encloses material: a side that runs
/// against the edge's direction opens a wedge of material and one that runs along it closes the wedge. What is left
/// over is paired among itself: an even number of four or more each with its neighbour in the order, else the pairs
/// that come closest to a smooth surface first, as long as no two pairs cross. Sides that stay alone become boundary.
///
/// Sides that run the same way are paired if one of the two shells can be turned around for it, given all pairs made
/// before.
/// @param may_turn false: only sides that run against each other are paired, and the result is empty
/// @param pairs of `triangles`, with nothing in `same_way`; `twin` is set for the pairs made that need no triangle
/// turned
/// @return triangles that have to be turned around, increasing; if there are any, `twin` is not changed: turn them,
/// pair
///         the sides anew, and call again
/// @throws Cancelled
std::vector<std::uint32_t> pair_crowded_sides(std::span<const Triangle> triangles, std::span<const Vec3> points,
                                              SidePairs& pairs, bool may_turn, const Context& context);

}  // namespace tri

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// The points' indices along a Morton curve through the box [low, high], so that neighbours in the order are neighbours
/// in space. Points outside the box count as on its border; points that are not finite come last. Equal keys keep the
/// order of the input.
std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Vec3& low, const Vec3& high);

}  // namespace tri

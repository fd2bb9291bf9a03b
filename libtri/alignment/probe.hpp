#pragma once

#include <span>
#include <vector>

#include "libtri/registration.hpp"
#include "meshops/context.hpp"

namespace tri {

/// How far off the model the centres of a probe's ball lie: its radius, positive if at least half of them are outside,
/// else negative.
/// @param feet    of the centres @param radius  mm, >= 0
double probe_offset(std::span<const Foot> feet, double radius);

/// The places that the ball touched, for centres in the model's frame: each moved by the radius straight towards its
/// closest point on the model, through it if the part is larger there. The direction is the model's, not the probe's,
/// as usual where no approach was recorded: right but for terms of second order in the part's slope errors.
///
/// @param centres  mm; those that are not finite stay
/// @param radius   mm; 0 changes nothing
/// @throws InvalidInput if the radius is negative or not finite; Cancelled
std::vector<Vec3> touched_places(const Registration& registration, std::span<const Vec3> centres, double radius,
                                 Context& context);

}  // namespace tri

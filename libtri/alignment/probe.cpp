#include "libtri/alignment/probe.hpp"

#include <fmt/format.h>

#include <cmath>

#include "meshops/error.hpp"

namespace tri {

double probe_offset(std::span<const Foot> feet, double radius) {
  std::size_t outside = 0, found = 0;
  for (const Foot& foot : feet) {
    found += foot.face >= 0;
    outside += foot.face >= 0 && foot.deviation > 0;
  }
  return 2 * outside >= found ? radius : -radius;
}

std::vector<Vec3> touched_places(const Registration& registration, std::span<const Vec3> centres, double radius,
                                 Context& context) {
  if (!(radius >= 0 && std::isfinite(radius)))
    throw InvalidInput(fmt::format("the probe's radius is {}; allowed: 0 or more mm", radius));
  std::vector<Vec3> places(centres.begin(), centres.end());
  if (radius == 0) return places;
  const std::vector<Foot> feet = registration.register_points(centres, context);
  const double offset = probe_offset(feet, radius);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Foot& foot = feet[i];
    if (foot.face < 0) continue;
    // Against the normal where the centre lies on the model itself.
    const Vec3 outward = foot.deviation != 0 ? (places[i] - foot.point) / foot.deviation
                                             : Vec3(foot.normal[0], foot.normal[1], foot.normal[2]);
    places[i] -= outward * offset;
  }
  return places;
}

}  // namespace tri

#pragma once

#include <memory>

#include "libtri/surfaces/curve.hpp"
#include "libtri/surfaces/surface.hpp"

namespace tri {

/// The surface of revolution: `profile`(v) turned by u about the axis.
/// @param origin a point of the axis
/// @param axis   unit vector
std::shared_ptr<const Surface> make_revolution(std::shared_ptr<const Curve3> profile, const Vec3& origin,
                                               const Vec3& axis);

/// `profile`(u) + v direction
/// @param direction unit vector
std::shared_ptr<const Surface> make_extrusion(std::shared_ptr<const Curve3> profile, const Vec3& direction);

/// The surface at `distance` from `base` along du x dv / |du x dv|.
/// @param base of any type made by this library
std::shared_ptr<const Surface> make_offset_surface(std::shared_ptr<const Surface> base, double distance);

}  // namespace tri

#pragma once

#include <memory>

#include "libtri/surfaces/surface.hpp"

namespace tri {

/// A right- or left-handed orthonormal frame.
struct Frame {
  Vec3 origin, x, y, z;
};

/// origin + u x + v y
std::shared_ptr<const Surface> make_plane(const Frame& frame);
/// origin + radius (cos u x + sin u y) + v z
std::shared_ptr<const Surface> make_cylinder(const Frame& frame, double radius);
/// origin + (radius + v sin a)(cos u x + sin u y) + v cos a z
std::shared_ptr<const Surface> make_cone(const Frame& frame, double radius, double half_angle);
/// origin + radius (cos v (cos u x + sin u y) + sin v z)
std::shared_ptr<const Surface> make_sphere(const Frame& frame, double radius);
/// origin + (major + minor cos v)(cos u x + sin u y) + minor sin v z
std::shared_ptr<const Surface> make_torus(const Frame& frame, double major, double minor);

}  // namespace tri

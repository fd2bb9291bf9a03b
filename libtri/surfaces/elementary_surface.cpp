#include "libtri/surfaces/elementary_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tri {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

double positive_angle(double y, double x) {
  const double a = std::atan2(y, x);
  return a < 0 ? a + two_pi : a;
}

class Plane final : public Surface {
 public:
  explicit Plane(const Frame& f) : f_(f) {}
  Vec3 point(double u, double v) const override { return f_.origin + f_.x * u + f_.y * v; }
  SurfacePoint evaluate(double u, double v) const override {
    const Vec3 zero(0, 0, 0);
    return {point(u, v), f_.x, f_.y, zero, zero, zero};
  }
  SurfaceBounds bounds(double, double, double, double) const override { return {1, 1, 0, 0, 0, 0, 0, 0, 0}; }
  int closest(const Vec3& p, Vec2 feet[2]) const override {
    const Vec3 d = p - f_.origin;
    feet[0] = Vec2(d | f_.x, d | f_.y);
    return 1;
  }

 private:
  Frame f_;
};

// The other four are circles about z: radius r(v), height h(v).
struct Meridian {
  double r, h, dr, dh, ddr, ddh;
};

template <class Shape>
class Round final : public Surface {
 public:
  Round(const Frame& f, const Shape& shape) : f_(f), shape_(shape) {}
  Vec3 point(double u, double v) const override {
    const Meridian m = shape_.meridian(v);
    return f_.origin + (f_.x * std::cos(u) + f_.y * std::sin(u)) * m.r + f_.z * m.h;
  }
  SurfacePoint evaluate(double u, double v) const override {
    const Meridian m = shape_.meridian(v);
    const double c = std::cos(u), s = std::sin(u);
    const Vec3 out = f_.x * c + f_.y * s, around = f_.y * c - f_.x * s;
    return {f_.origin + out * m.r + f_.z * m.h, around * m.r, out * m.dr + f_.z * m.dh, out * -m.r, around * m.dr,
            out * m.ddr + f_.z * m.ddh};
  }
  double u_period() const override { return two_pi; }
  double v_period() const override { return Shape::v_period; }
  SurfaceBounds bounds(double, double, double v0, double v1) const override { return shape_.bounds(v0, v1); }
  int closest(const Vec3& p, Vec2 feet[2]) const override {
    const Vec3 d = p - f_.origin;
    const double x = d | f_.x, y = d | f_.y;
    return shape_.closest(positive_angle(y, x), std::hypot(x, y), d | f_.z, feet);
  }

 private:
  Frame f_;
  Shape shape_;
};

double opposite(double u) {
  return u < std::numbers::pi ? u + std::numbers::pi : u - std::numbers::pi;
}

struct Cylinder {
  static constexpr double v_period = 0;
  double radius;
  Meridian meridian(double v) const { return {radius, v, 0, 1, 0, 0}; }
  SurfaceBounds bounds(double, double) const { return {radius, 1, radius, 0, 0, radius, 0, 0, 0}; }
  int closest(double u, double, double h, Vec2 feet[2]) const {
    feet[0] = Vec2(u, h);
    return 1;
  }
};

struct Cone {
  static constexpr double v_period = 0;
  double radius, sin, cos;
  Meridian meridian(double v) const { return {radius + v * sin, v * cos, sin, cos, 0, 0}; }
  SurfaceBounds bounds(double v0, double v1) const {
    const double r = std::max(std::abs(radius + v0 * sin), std::abs(radius + v1 * sin)), s = std::abs(sin);
    return {r, 1, r, s, 0, r, s, 0, 0};
  }
  // On each nappe the ruling in the half plane of the point, as far as its foot does not run through the apex.
  int closest(double u, double r, double h, Vec2 feet[2]) const {
    int n = 0;
    const double v = (r - radius) * sin + h * cos;
    if (radius + v * sin >= 0) feet[n++] = Vec2(u, v);
    const double w = (-r - radius) * sin + h * cos;
    if (radius + w * sin <= 0) feet[n++] = Vec2(opposite(u), w);
    return n;
  }
};

struct Sphere {
  static constexpr double v_period = 0;
  double radius;
  Meridian meridian(double v) const {
    const double c = radius * std::cos(v), s = radius * std::sin(v);
    return {c, s, -s, c, -c, -s};
  }
  SurfaceBounds bounds(double, double) const {
    const double r = radius;
    return {r, r, r, r, r, r, r, r, r};
  }
  int closest(double u, double r, double h, Vec2 feet[2]) const {
    feet[0] = Vec2(u, std::atan2(h, r));
    return 1;
  }
};

struct Torus {
  static constexpr double v_period = two_pi;
  double major, minor;
  Meridian meridian(double v) const {
    const double c = minor * std::cos(v), s = minor * std::sin(v);
    return {major + c, s, -s, c, -c, -s};
  }
  SurfaceBounds bounds(double, double) const {
    const double r = major + minor, m = minor;
    return {r, m, r, m, m, r, m, m, m};
  }
  // The circle in the half plane of the point, and, where the torus meets itself, the inner part of the one opposite.
  int closest(double u, double r, double h, Vec2 feet[2]) const {
    int n = 0;
    const double v = positive_angle(h, r - major);
    if (major + minor * std::cos(v) >= 0) feet[n++] = Vec2(u, v);
    const double w = positive_angle(h, -r - major);
    if (major + minor * std::cos(w) <= 0) feet[n++] = Vec2(opposite(u), w);
    return n;
  }
};

}  // namespace

std::shared_ptr<const Surface> make_plane(const Frame& frame) {
  return std::make_shared<Plane>(frame);
}

std::shared_ptr<const Surface> make_cylinder(const Frame& frame, double radius) {
  return std::make_shared<Round<Cylinder>>(frame, Cylinder{radius});
}

std::shared_ptr<const Surface> make_cone(const Frame& frame, double radius, double half_angle) {
  return std::make_shared<Round<Cone>>(frame, Cone{radius, std::sin(half_angle), std::cos(half_angle)});
}

std::shared_ptr<const Surface> make_sphere(const Frame& frame, double radius) {
  return std::make_shared<Round<Sphere>>(frame, Sphere{radius});
}

std::shared_ptr<const Surface> make_torus(const Frame& frame, double major, double minor) {
  return std::make_shared<Round<Torus>>(frame, Torus{major, minor});
}

}  // namespace tri

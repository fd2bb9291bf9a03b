#include "camera.hpp"

#include <algorithm>
#include <cmath>

namespace editor {
namespace {

constexpr float field_of_view = 0.6F;  // radians, top to bottom

float dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

void Camera::frame(const Vector3& center, float radius) {
  center_ = center;
  radius_ = std::max(radius, 1e-12F);
  distance_ = radius_ / std::sin(field_of_view / 2) * 1.05F;
}

void Camera::turn(float dx, float dy) {
  azimuth_ -= dx * 0.008F;
  elevation_ = std::clamp(elevation_ + dy * 0.008F, -1.57F, 1.57F);
}

void Camera::move(float dx, float dy, int height) {
  const float per_pixel = 2 * distance_ * std::tan(field_of_view / 2) / static_cast<float>(std::max(height, 1));
  const Vector3 r = right(), u = up();
  for (std::size_t k = 0; k < 3; ++k) center_[k] += (u[k] * dy - r[k] * dx) * per_pixel;
}

void Camera::approach(float steps) {
  distance_ = std::clamp(distance_ * std::pow(0.9F, steps), radius_ * 0.01F, radius_ * 100);
}

Vector3 Camera::backward() const {
  return {std::cos(elevation_) * std::cos(azimuth_), std::cos(elevation_) * std::sin(azimuth_), std::sin(elevation_)};
}

Vector3 Camera::right() const {
  return {-std::sin(azimuth_), std::cos(azimuth_), 0};
}

Vector3 Camera::up() const {
  return {-std::sin(elevation_) * std::cos(azimuth_), -std::sin(elevation_) * std::sin(azimuth_), std::cos(elevation_)};
}

Matrix4 Camera::view() const {
  const Vector3 r = right(), u = up(), b = backward();
  return {r[0],
          u[0],
          b[0],
          0,
          r[1],
          u[1],
          b[1],
          0,
          r[2],
          u[2],
          b[2],
          0,
          -dot(r, center_),
          -dot(u, center_),
          -dot(b, center_) - distance_,
          1};
}

Matrix4 Camera::projection(float width_by_height) const {
  const float near = std::max(distance_ - 4 * radius_, distance_ * 0.01F), far = distance_ + 4 * radius_;
  const float f = 1 / std::tan(field_of_view / 2);
  return {f / width_by_height,           0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
          2 * far * near / (near - far), 0};
}

}  // namespace editor

#pragma once

#include <array>

namespace editor {

/// Column-major, as OpenGL takes it.
using Matrix4 = std::array<float, 16>;
using Vector3 = std::array<float, 3>;

/// Looks at a ball from outside; turned by dragging, moved in its own plane, brought nearer by the wheel.
class Camera {
 public:
  /// Frames a ball; the direction stays.
  void frame(const Vector3& center, float radius);
  /// Pixels of a drag, in a window `height` pixels high.
  void turn(float dx, float dy);
  void move(float dx, float dy, int height);
  /// Steps of the wheel; positive brings nearer.
  void approach(float steps);

  /// To view space, and from there to clip space.
  Matrix4 view() const;
  Matrix4 projection(float width_by_height) const;

 private:
  Vector3 right() const;
  Vector3 up() const;
  Vector3 backward() const;

  Vector3 center_{0, 0, 0};
  float radius_ = 1;
  float distance_ = 3;
  float azimuth_ = 0.6F;    ///< radians around z
  float elevation_ = 0.5F;  ///< radians above the plane of x and y
};

}  // namespace editor

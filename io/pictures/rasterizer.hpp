#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A camera that looks at a set of points.
struct CameraSettings {
  int width = 0, height = 0;  ///< of the image, in samples
  Vec3 view, up;              ///< as RenderOptions
  bool perspective = false;
  double zoom = 1;
  std::optional<Vec3> center;
};

/// A point as the camera sees it.
struct ScreenPoint {
  double x = 0, y = 0;   ///< samples, from the top left corner
  double closeness = 0;  ///< grows toward the camera, and linearly over the image of a plane
  double weight = 1;     ///< of a perspective-correct mean: 1 / distance, or 1 in an orthographic view
};

/// Projects points; the scale is chosen so that `framed` points fill the image but for a margin.
class Camera {
 public:
  /// Every coordinate of `points` is finite and below 1e150.
  /// @throws InvalidInput if no index is given, `view` has no direction, or the frame is beyond what a double can hold.
  Camera(const CameraSettings& settings, const std::vector<Vec3>& points, const std::vector<std::uint32_t>& framed);

  ScreenPoint project(const Vec3& point) const;
  /// Unit vector from `point` to the camera.
  Vec3 toward_camera(const Vec3& point) const;
  /// Unit vectors to the right and upward in the picture.
  const Vec3& right() const { return x_; }
  const Vec3& upward() const { return y_; }

 private:
  Vec3 in_view(const Vec3& point) const;

  bool perspective_;
  Vec3 origin_, x_, y_, z_;  // z toward the camera
  double distance_ = 1;      // of the camera from the origin, perspective only
  double scale_ = 1;         // samples per unit
  double shift_x_ = 0, shift_y_ = 0;
};

/// What one sample shows: element `id` (a triangle, or a point of a cloud) and where.
struct Sample {
  static constexpr std::uint32_t nothing = 0xffffffff;
  std::uint32_t id = nothing;
  double barycentric[3] = {0, 0, 0};  ///< on the triangle itself, summing to 1
  double x = 0, y = 0;                ///< samples
};

/// Finds the nearest triangle (or dot of `dot_radius` samples, where `triangles` is empty) at the middle of every
/// sample and calls `paint(column, row, sample)` once for each sample that shows something; from several threads at
/// once, but from a single one within a tile of `tile` x `tile` samples. Among equally near triangles the first wins.
/// @throws Cancelled between tiles.
void rasterize(const std::vector<ScreenPoint>& points, const std::vector<Triangle>& triangles, int width, int height,
               int tile, double dot_radius, Context& context,
               const std::function<void(int column, int row, const Sample& sample)>& paint);

}  // namespace tri

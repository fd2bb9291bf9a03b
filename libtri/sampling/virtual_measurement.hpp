#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <vector>

#include "libtri/model/shape.hpp"
#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// How the points of a virtual measurement lie on the model.
enum class SamplingPattern {
  random,  ///< uniform over the area, in random order
  scan,    ///< on parallel lines far apart, closely spaced along each line, in the order of the lines
  grid,    ///< regular in (u,v) on each face, face by face
};

/// "random", "scan" or "grid". @throws InvalidInput for any other name.
SamplingPattern sampling_pattern(std::string_view name);

/// How many points are measured where, and how well.
struct MeasurementOptions {
  std::uint64_t points = 10000;                       ///< exactly this many are made, 1 to 1e9, outliers included
  SamplingPattern pattern = SamplingPattern::random;  ///< where the points lie
  double line_ratio = 10;  ///< scan: distance between lines over distance along a line, in [1, 1000]
  double noise = 0;        ///< mm, standard deviation of a Gaussian along the normal, >= 0
  double outliers = 0;     ///< share of points moved away from the model by 1% to 10% of its diagonal, in [0, 1]

  /// Drop-outs: no true point lies within a ball of this radius (mm, >= 0) about any of the centres.
  double drop_out_radius = 0;
  int drop_outs = 0;                   ///< centres drawn on the model, uniformly over the area; >= 0
  std::vector<Vec3> drop_out_centres;  ///< further centres, in the model's frame

  /// Directions from the part to the sensor (any length). A point is measured if from one of them it is not hidden and
  /// seen at most `max_angle` off its normal, as its face is oriented in the shape (loose faces may look inward: sew
  /// them first). Empty: all sides are measured.
  std::vector<Vec3> views;
  double max_angle = 75 * std::numbers::pi / 180;  ///< rad, in (0, pi/2]

  bool move = false;       ///< a random rigid motion, its translation up to one diagonal along each axis
  bool shuffle = false;    ///< random order of the points
  std::uint64_t seed = 1;  ///< the same seed and model give the same points
};

/// Where a measured point truly lies, in the model's frame.
struct TruePoint {
  std::int32_t face = 0;  ///< 1-based, TopExp::MapShapes order of the shape as given
  bool outlier = false;   ///< the measured point was moved away from this place on purpose
  Vec2 uv{0, 0};          ///< on the face's own surface
  Vec3 point{0, 0, 0};    ///< S(u,v)
  Vec3 normal{0, 0, 0};   ///< unit, outward as the face is oriented; zero where the surface has none (a pole)
};

/// Points as a machine would measure them, and the truth about each.
struct VirtualMeasurement {
  std::vector<Vec3> points;      ///< as measured: with noise, outliers and motion
  std::vector<TruePoint> truth;  ///< one for each point, in the same order
  /// Row-major 4x4 rigid motion that takes the measured points back to the model; the identity unless `move`.
  std::array<std::array<double, 4>, 4> to_model{};
  std::vector<Vec3> drop_out_centres;  ///< drawn and given, in the model's frame
  double spacing = 0;       ///< mm: along a scan line; of the grid; for random points sqrt(measured area / points)
  double line_spacing = 0;  ///< mm between scan lines; 0 for the other patterns
  std::vector<int> unusable_faces;  ///< 1-based indices of faces that could not be sampled and hold no point
};

/// Measures a CAD model virtually, for tests and demonstrations: points exactly on its trimmed faces, then noise,
/// outliers, drop-outs, hidden sides and a motion as the options say, with the truth of every point.
///
/// The same shape, options and seed give the same result for any number of threads; the random numbers are the same on
/// every platform. Scan lines lie in parallel planes across the longest side of the model's box, slightly turned by the
/// seed; where the surface is within 37 degrees of those planes, in planes across the next side instead, so that every
/// side gets lines. To make the number of points exact where regular patterns cannot, up to about 1% of the pattern is
/// left out at random (of a grid more, where there are hardly more points than faces).
/// @throws InvalidInput if an option is out of range or the views and drop-outs leave nothing to measure.
/// @throws CadError if no face can be sampled.
/// @throws Cancelled at the granularity of 16384 points or one face.
VirtualMeasurement measure(const Shape& shape, const MeasurementOptions& options, Context& context);

}  // namespace tri

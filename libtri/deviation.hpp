#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libtri/registration.hpp"
#include "meshops/checks/value_statistics.hpp"
#include "meshops/mesh.hpp"

namespace tri {

/// What counts, and what is pointed out.
struct DeviationOptions {
  std::optional<Tolerance> tolerance;  ///< mm
  /// mm, > 0: points farther from the model are listed and take no part in the statistics. Without, every point does.
  std::optional<double> max_distance;
  std::size_t spots = 10;  ///< how many of the worst places to name, at most
};

/// The deviations of the points that lie on one face.
struct FaceDeviation {
  int face = 0;                ///< 1-based, CadFace::index
  std::string name;            ///< from the file, may be empty
  std::string surface_type;    ///< as `CadFace::surface_type`
  double area = 0;             ///< mm^2
  ValueStatistics statistics;  ///< indices are those of points
};

/// A place where the part is worse than all around it.
struct DeviationSpot {
  std::uint32_t point = 0;  ///< 0-based index
  Vec3 position{0, 0, 0};   ///< mm, the measured point
  Vec3 foot{0, 0, 0};       ///< mm, on the model
  double deviation = 0;     ///< mm, positive outside
  int face = 0;             ///< 1-based
};

/// How measured points deviate from a model.
struct Deviations {
  std::vector<double> values;           ///< mm, of every point, far ones too; positive outside
  std::vector<int> faces;               ///< 1-based CadFace::index of every point
  ValueStatistics overall;              ///< without far points; indices are those of points
  std::vector<FaceDeviation> per_face;  ///< in the order of CadModel::faces, those without points too
  std::vector<std::uint32_t> far;       ///< points beyond `max_distance`, ascending
  /// By how far they are outside the tolerance, or without one by size, worst first; no two within a tenth of the
  /// model's diagonal.
  std::vector<DeviationSpot> spots;
};

/// Statistics of the signed distances of points from a model, overall and for each face. The result does not depend on
/// the number of threads.
///
/// @param points  mm; as many as `feet`
/// @param feet    of these points, from Registration::register_points
/// @throws InvalidInput if an option is out of range, or a point is not finite (its foot has no face); Cancelled
Deviations deviations(const CadModel& model, std::span<const Vec3> points, std::span<const Foot> feet,
                      const DeviationOptions& options, const Context& context);

/// What the properties of a triangulated mesh say about its vertices, in their order (see `property` in
/// meshops/mesh.hpp): face, (u,v), deviation, and the foot with its outward normal, which are looked up. The edge is
/// not known.
/// @throws InvalidInput if a property is missing or a vertex has no face of the model
std::vector<Foot> feet_of(const Mesh& mesh, const CadModel& model);

/// The deviations of the points that count, in their order: without the far ones.
std::vector<double> counted_values(const Deviations& deviations);

}  // namespace tri

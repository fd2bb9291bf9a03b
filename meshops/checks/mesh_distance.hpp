#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// How exactly is measured.
struct MeshDistanceOptions {
  /// Random places on each surface that mean and rms are taken over; without, as many as the surface has vertices, but
  /// at least 100,000.
  std::optional<std::uint64_t> samples;
  std::uint64_t seed = 1;  ///< of the random places; the same seed gives the same numbers
  /// The greatest distance is narrowed down until its bounds differ by less than this share of it (> 0), or by a
  /// millionth of the diagonal.
  double relative_error = 0.01;
  /// Searches of a closest point that may be spent on that, for each direction; when they are used up the bounds that
  /// were reached are returned.
  std::uint64_t max_searches = 2'000'000;
};

/// How far one surface is from another: from every place of the first to the closest place of the second. Model units.
struct OneSidedDistance {
  /// For every vertex of the first mesh, used by a triangle or not: the distance, positive on the side that the
  /// second's triangles face, negative on the other (see SurfaceSide).
  std::vector<double> vertices;
  double mean = 0;            ///< of the unsigned distance over the area of the first surface, by the samples
  double rms = 0;             ///< root of its mean square, likewise
  double mean_error = 0;      ///< standard error of `mean`, from above
  std::uint64_t samples = 0;  ///< how many; 0 if the first has no area: mean and rms are then those of its vertices
  double area = 0;            ///< of the first surface
  double max = 0;             ///< greatest distance found: that of `place`
  double max_bound = 0;       ///< no place of the first surface is farther away than this
  Vec3 place{0, 0, 0};        ///< on the first surface
  Vec3 foot{0, 0, 0};         ///< on the second, closest to `place`
};

/// How far two surfaces are apart, in model units.
struct MeshDistance {
  OneSidedDistance forward;    ///< from the first mesh to the second
  OneSidedDistance backward;   ///< from the second to the first
  double hausdorff = 0;        ///< the greater of the two `max`
  double hausdorff_bound = 0;  ///< the greater of the two `max_bound`: the Hausdorff distance lies between
  double mean = 0;             ///< over both surfaces together, weighted by area
  double rms = 0;              ///< likewise
};

/// Compares two surfaces, whatever their triangles.
///
/// Samples lie stratified by area: the k-th of n at a random place within the k-th n-th of the area. The greatest
/// distance is searched by branch and bound [after Tang, Lee & Kim 2009]: over a piece of a triangle the distance to
/// any one triangle of the other surface is convex, so that it is largest at a corner; pieces that may hold more than
/// what was found are cut into four. Vertices that no triangle uses are no part of a surface. The result does not
/// depend on the number of threads.
/// @throws InvalidInput if an option is out of range, a mesh has no triangle or a coordinate is not finite; Cancelled
MeshDistance mesh_distance(const Soup& first, const Soup& second, const MeshDistanceOptions& options, Context& context);

}  // namespace tri

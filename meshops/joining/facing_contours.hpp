#pragma once

#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "meshops/mesh_view.hpp"

namespace tri {

class NearestPoints;

/// Two stretches of boundary found to face each other, both running the same way in space: `first` along its boundary
/// half-edges, `second` against its own. Of a closed pair the first vertex is repeated at the end.
struct ContourRun {
  std::vector<VertexHandle> first;
  std::vector<VertexHandle> second;
  bool closed = false;
};

/// How far and how bent a gap may be.
struct FacingLimits {
  double max_gap = 3;  ///< times the local spacing (the larger of both sides)
  double max_distance = std::numeric_limits<double>::infinity();  ///< model units; takes the place of `max_gap` when
                                                                  ///< finite
  double max_turn = 130 * std::numbers::pi / 180;  ///< [rad] between a new triangle and the face beside it
};

/// Finds stretches of boundary that face each other across a gap: near to each other, running against each other, each
/// on the open side of the other or abreast of it. Works on the mesh as it is at each call, so faces may be added
/// between calls.
class FacingContours {
 public:
  /// @param spacing  `local_spacing` of the mesh, by vertex index; must outlive this object.
  FacingContours(MeshView mesh, const std::vector<double>& spacing, const FacingLimits& limits);
  ~FacingContours();

  /// Two boundary half-edges whose starts face each other.
  struct Seed {
    HalfedgeHandle first, second;
    double nearness = 0;  ///< distance over the largest allowed; below 1
  };

  /// For every boundary vertex the nearest one that faces it; mutual ones first, then by nearness. O(n log n) for n
  /// boundary vertices. Starts that lie in the same place are passed over (that is for `weld`).
  std::vector<Seed> seeds() const;

  /// The stretch around a seed, grown both ways as long as the contours keep facing each other; empty if the mesh
  /// changed there so that the seed faces nothing any more. Linear in the stretch.
  std::optional<ContourRun> grow(const Seed& seed) const;

  /// The longest diagonal allowed between two vertices, model units.
  double reach(VertexHandle a, VertexHandle b) const;

 private:
  MeshView view_;
  const std::vector<double>& spacing_;
  FacingLimits limits_;
  std::vector<VertexHandle> vertices_;  ///< on the boundary when this object was made, by index in the tree
  std::vector<Vec3> points_;            ///< their places
  std::unique_ptr<NearestPoints> tree_;
};

/// Angle [rad] between the normal of triangle (a, b, c) and that of the face on the other side of `base`; pi if the
/// triangle has no area, 0 if the face has none.
double turn_at(MeshView mesh, HalfedgeHandle base, VertexHandle a, VertexHandle b, VertexHandle c);

}  // namespace tri

#pragma once

#include <limits>
#include <numbers>
#include <string>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/reference.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Which triangles are taken for bridges between parts of the surface; every test can be turned off.
struct RemoveRedundantOptions {
  /// A triangle goes if an edge is longer than this many times the local spacing (`local_spacing`, the larger of both
  /// ends'). Infinity: off.
  double length_factor = 5;
  /// Model units; a triangle goes if an edge is longer. Takes the place of `length_factor` when it is finite.
  double max_length = std::numeric_limits<double>::infinity();
  /// [rad] A triangle goes if its normal is farther from the reference normal (with normals at the vertices: from each
  /// corner's). Pi: off.
  double max_angle = 75 * std::numbers::pi / 180;
  /// [rad] Without reference normals: a triangle goes if its normal is farther from that of every neighbour, so it is
  /// folded over. Pi: off.
  double max_neighbor_angle = 120 * std::numbers::pi / 180;
  /// A triangle at the boundary goes if more than this share of its area is outside the reference's trimmed region. 1:
  /// off.
  double max_outside = 0.5;
  /// [rad] Without a reference: a triangle at the boundary goes if its angle opposite the boundary edge is larger,
  /// being a sliver between neighbours that a hull put there. Pi: off.
  double max_boundary_angle = 165 * std::numbers::pi / 180;
  /// No vertex loses its last face: the triangle with the shortest longest edge is spared there.
  bool keep_vertices = false;
  /// Vertex property (of `Vec3`) with reference normals; used if the mesh has it and `reference` is null. Zero says
  /// nothing.
  std::string normal_property = "v:reference_normal";
  /// The model; null for none. C++ only.
  const Reference* reference = nullptr;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Deletes triangles that a triangulation of points put where the part has no surface [Ristic et al. 2000, step (e)],
/// by edge length, by normal and by the shape of the boundary. The first two judge every triangle; the third peels the
/// boundary, from outside inward, as long as it finds a triangle that stands out. `figures` counts them: "too long",
/// "normal off", "outside the boundary".
///
/// No bow-tie is left where the mesh had none: where deletion leaves several fans of triangles at a vertex, only the
/// fan with the most triangles stays (then the larger area, then the lower face index) and the others go too, counted
/// as "at bow-ties"; with `keep_vertices` or a selection instead the narrowest gaps between fans are closed again, that
/// is, their triangles are spared, counted in `skipped`
/// ("spared for a bow-tie"; "spared for a vertex" are those that kept a vertex's last face).
///
/// Faces are marked as deleted, as are edges without a face and (without `keep_vertices`) vertices that lost their last
/// face; vertices that were isolated before stay. Positions and other handles keep. A second run may find more, since
/// the local spacing changed.
/// @throws Cancelled before anything is deleted. @throws InvalidInput if an option is out of range. Either way the mesh
/// is untouched.
Report remove_redundant(MeshView mesh, const RemoveRedundantOptions& options, Context& context);

}  // namespace tri

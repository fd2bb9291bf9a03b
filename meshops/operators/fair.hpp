#pragma once

#include <span>
#include <string>

#include "meshops/context.hpp"
#include "meshops/holes/fairing.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Which vertices move, and how smoothly the surface goes on at their rim.
struct FairOptions {
  /// How the new surface meets the old one at the rim.
  Continuity continuity = Continuity::tangent;
  FairingWeights weights = FairingWeights::cotangent;  ///< how neighbours are weighed
  /// Vertex property (int): vertices with a value above 0 move. Empty: the vertices that are selected (OpenMesh's
  /// status bit) move.
  std::string region;
  /// Move if not empty, whatever `region` and the selection say. C++ only.
  std::span<const VertexHandle> vertices = {};

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Moves chosen vertices to where the surface through them is fairest, while all others stay: least area, least
/// thin-plate energy or least variation of curvature (`faired_points`).
///
/// Links, handles and the number of elements stay. Vertices that the view's selection does not allow to move are passed
/// over. Vertices that cannot move are counted in `skipped`: "boundary
/// vertex", "isolated vertex", "no neighbour stays" (a whole component was chosen). Where cotangent weights fail, since
/// a triangle has no area or the system is singular, uniform weights take their place, with a note; if those fail as
/// well nothing moves, and the vertices are in `skipped` by the reason's name. Figure: "largest distance" (model
/// units). On cancel the mesh is untouched.
/// @throws InvalidInput if `region` names no int property, or a handle of `vertices` is invalid or deleted; the mesh is
/// untouched.
Report fair(MeshView mesh, const FairOptions& options, Context& context);

}  // namespace tri

#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// How smoothly a faired region goes on from what stays around it.
enum class Continuity {
  position,   ///< C0: least area, a soap film [solves L x = 0]
  tangent,    ///< C1: least thin-plate energy [L M^-1 L x = 0]
  curvature,  ///< C2: least variation of curvature [L M^-1 L M^-1 L x = 0]
};

/// How a vertex is weighed against its neighbours.
enum class FairingWeights {
  cotangent,  ///< by the geometry before; vertices hardly slide along the surface
  uniform,    ///< all alike; vertices spread evenly
};

/// Why vertices have new places, or have none.
enum class FairingOutcome {
  done,             ///< every vertex has a new place
  nothing_to_move,  ///< no vertices, or all of them in parts without a neighbour that stays
  no_area,          ///< cotangent weights of a triangle without area
  singular,         ///< the system has no unique solution, or not to 1e-6 in double precision
};

/// The outcome in words, for reports: "system is singular".
std::string_view to_string(FairingOutcome outcome);

/// New places of vertices; the mesh is not changed.
struct FairedPoints {
  FairingOutcome outcome = FairingOutcome::done;  ///< `points` has entries only if `done`
  std::vector<VertexHandle> vertices;             ///< those that may move, in the order given
  std::vector<Vec3> points;                       ///< their new places; empty unless `done`
  std::size_t without_rim = 0;                    ///< vertices left out since no neighbour of their part stays
};

/// Where vertices go when all others stay and the region's energy is least [Kobbelt et al. 1998; Botsch & Kobbelt 2004;
/// Desbrun et al. 1999 for the weights and the areas M, a third of the triangles around a vertex].
///
/// One linear system for each call, solved by sparse Cholesky decomposition (sparse_cholesky.hpp). The result turns,
/// moves and scales with the mesh. The mesh is not changed. At a vertex on the mesh's boundary curvature is not known
/// and does not count.
/// @param moving  interior vertices (not on the boundary, not isolated), each once
/// @throws Cancelled within some 80 ms
FairedPoints faired_points(MeshView mesh, std::span<const VertexHandle> moving, Continuity continuity,
                           FairingWeights weights, const Context& context);

}  // namespace tri

#pragma once

#include <cstdint>

#include "libtri/triangulation/shell/edit_mesh.hpp"
#include "meshops/context.hpp"

namespace tri {

struct VertexRemoval {
  std::size_t removed = 0;
  std::size_t kept = 0;  ///< vertices whose removal would change the topology
};

/// Removes every vertex that is no measured point, cheapest first, by the best retriangulation of its star.
///
/// Inside, the star's ring is triangulated with the least sum of area, misfit to the model's normals and edge lengths,
/// by dynamic programming over its chords. On the free boundary the fan is replaced by what covers the same area best;
/// the boundary recedes to the outermost points. A chord that is an edge elsewhere is forbidden, so the topology never
/// changes.
/// @throws Cancelled; the mesh then still holds some vertices of the model and is valid.
VertexRemoval remove_model_vertices(EditMesh& mesh, Context& context);

}  // namespace tri

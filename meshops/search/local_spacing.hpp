#pragma once

#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// The distance between neighbours that is usual around each vertex, in model units; 0 for isolated and deleted
/// vertices.
///
/// Each vertex takes the median of its edges' lengths, then the median of that over itself and its neighbours. So one
/// long edge does not change it, nor does a vertex whose edges are mostly too long, as at a notch that was triangulated
/// over. Even counts take the lower median. Linear time.
/// @param context  null: cannot be cancelled
/// @throws Cancelled
std::vector<double> local_spacing(MeshView mesh, const Context* context = nullptr);

}  // namespace tri

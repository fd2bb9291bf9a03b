#pragma once

#include "meshops/context.hpp"
#include "meshops/editing/mesh_before.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Measures how far an operator moved a surface, from the mesh as it was to what it is and back, by `mesh_distance`.
///
/// Figures, in model units: "hausdorff", the greatest distance that was found, and "hausdorff at most", which no place
/// exceeds (proven; a twentieth more, or above that where the search was given up). None if there is no triangle before
/// or after, or a corner of one is not finite. Heeds cancel, and tells no progress.
/// @throws Cancelled
void report_distance(const MeshBefore& before, MeshView now, Report& report, const Context& context);

}  // namespace tri

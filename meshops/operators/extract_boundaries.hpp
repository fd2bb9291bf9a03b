#pragma once

#include "meshops/context.hpp"
#include "meshops/holes/boundary_loops.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

namespace property {
inline constexpr const char* boundary_loop = "boundary_loop";  ///< int on vertices and edges, 0-based loop; -1 off the
                                                               ///< boundary
inline constexpr const char* boundary_outer = "boundary_outer";  ///< int on edges, 1 outer loop, 0 nested loop, -1 off
                                                                 ///< the boundary
}  // namespace property

/// Which properties the loops are written to; the report has them in any case.
struct ExtractBoundariesOptions {
  bool mark_vertices = true;  ///< write the vertex property `boundary_loop`
  bool mark_edges = true;     ///< write the edge properties `boundary_loop` and `boundary_outer`

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Finds every boundary loop and writes which loop each vertex and edge is on; `boundary_loops` gives the same as
/// polylines.
///
/// Loops are numbered as `boundary_loops` returns them; that header says what is an outer and what a nested loop. A
/// vertex on several loops gets the first. Properties of these names that are there already are overwritten; positions,
/// faces and handles stay. Figures: "loops", "outer loops", "nested loops", "boundary edges", "boundary length" (model
/// units). One note per loop, for the first 100.
/// @throws Cancelled before anything is written.
Report extract_boundaries(MeshView mesh, const ExtractBoundariesOptions& options, Context& context);

}  // namespace tri

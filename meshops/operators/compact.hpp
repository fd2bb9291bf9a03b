#pragma once

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

/// What goes beside what is marked as deleted.
struct CompactOptions {
  bool isolated_vertices = false;  ///< vertices without a face go as well

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Garbage collection as a step of its own: drops the elements marked as deleted, with all their properties.
///
/// Unlike OpenMesh's, which fills each gap with the last element, it keeps the order of the elements that stay. They
/// are renumbered, so handles held elsewhere become invalid: `Report::maps` takes old indices to new ones. Counts are
/// those of the elements dropped. A mesh without deleted elements is returned bit for bit, with empty maps.
/// O(elements).
///
/// Cancel is heeded before the first change only. @throws InvalidInput if the mesh has no status attributes a face
/// that stays uses a deleted vertex or edge, or the view has a selection; the mesh is untouched.
Report compact(MeshView mesh, const CompactOptions& options, Context& context);

}  // namespace tri

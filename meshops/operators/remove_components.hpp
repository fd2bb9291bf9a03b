#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// By default nothing is removed.
struct RemoveComponentsOptions {
  double min_area = 0;             ///< square model units; components of less go
  double min_volume = 0;           ///< cubic model units; components that enclose less (open ones: nothing) go
  std::int64_t min_triangles = 0;  ///< components of fewer go
  std::int64_t keep = 0;           ///< of what is left only so many stay, those of the largest area; 0: all

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Removes whole components, by area, volume, number of triangles or rank.
///
/// A component is what is joined over edges, of however many triangles. Its volume is the sum of those of its closed
/// shells, see `find_shells`, each taken as positive; nesting is not looked at. Vertices that only these triangles use
/// go with them. Of components with the same area the earlier one ranks first. Triangles that name a vertex twice are
/// one component of their own, without area.
///
/// Counts: `faces_removed`, `vertices_removed`. Figures: "components removed", "components kept", "area removed".
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report remove_components(Soup& soup, const RemoveComponentsOptions& options, Context& context);

}  // namespace tri

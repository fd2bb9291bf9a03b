#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Which way round the triangles of a shell face in the end.
struct OrientOptions {
  /// Closed shells face outward, those in an odd number of others (cavities) into the cavity; else they keep the
  /// orientation of most of their triangles, as open ones do.
  bool outward = true;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Turns triangles around so that neighbours agree and solids face outward.
///
/// Within each shell, a set of triangles joined over edges of two triangles, all run the same way afterwards. A shell
/// that is not closed keeps the direction of the majority of its triangles. A closed one gets a positive volume if an
/// even number of other closed shells is around it, a negative one if it is a cavity [even-odd rule; points in solids
/// decided exactly]. Shells whose volume is 0 keep their majority. Triangles that name a vertex twice are left alone.
/// Corner attributes and vertex normals keep to their corners and vertices; a vertex normal turns around if all
/// triangles at its vertex did. O(triangles), but for shells within shells.
///
/// Counts: `faces_reversed`. Figure: "closed shells turned outward". `skipped`: "edges of a surface with one side only"
/// (a Moebius strip cannot be oriented; everything else of it is). `touched_faces` are the reversed ones.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report orient(Soup& soup, const OrientOptions& options, Context& context);

}  // namespace tri

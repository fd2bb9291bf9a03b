#pragma once

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What becomes of two triangles with the same corners that face opposite ways.
enum class OppositePairs { automatic, keep, one, none };

/// What becomes of triangles that face each other.
struct RemoveDuplicatesOptions {
  /// `keep`: both stay. `one`: the first stays. `none`: both go. `automatic`: a patch of such pairs (joined over edges)
  /// is a wall between two solids if each edge of its rim has two more triangles, which run along it in opposite
  /// directions: then both go and the solids become one. Any other patch is a sheet drawn from both sides: the first
  /// stays.
  OppositePairs opposite = OppositePairs::automatic;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Removes triangles with the same three corners as an earlier one, whichever corner they begin with.
///
/// Of those that face the same way the first stays; what remains of a set is one triangle or an opposite pair, see
/// `RemoveDuplicatesOptions::opposite`. Triangles that name a vertex twice are left alone. Corners are compared by
/// index: `weld` first. Points and the order of what stays are kept. O(triangles log triangles).
///
/// Counts: `faces_removed`. Figures: "duplicates removed", "opposite pairs found", "opposite pairs made one", "opposite
/// pairs removed". Notes name the first of each kind.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report remove_duplicates(Soup& soup, const RemoveDuplicatesOptions& options, Context& context);

}  // namespace tri

#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What may be taken away, and in which precision the result has to hold.
struct MakeSolidOptions {
  /// Share of the diagonal of the bounding box: what lies inside the solid, or sticks out of it as a sheet, goes where
  /// it is nowhere farther than this from what stays.
  double max_deviation = 5e-4;
  /// What lies inside the solid and farther away than that stays as the two sides of a gap, and a sheet outside as a
  /// plate, both thinner than max_deviation; else it goes.
  bool keep_walls = true;
  /// All vertices get coordinates that single precision holds, and what touches is parted by more than its steps
  /// wherever that can be, so that the result is still a solid after it was written as STL and read again. Corners that
  /// cannot move apart lose their tips (`cut_tips`), what the rounding made touch is made a solid once more, and what
  /// it turned inside out is turned round; vertices that touch even so move apart by up to a sixteenth of
  /// `max_deviation`
  /// (`part_touching_vertices`).
  bool single_precision = false;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Turns triangles with any topology and any crossings into the boundary of a solid: closed, manifold, facing outward
/// and free of self-intersections.
///
/// Vertices within 2^-28 of the extent of each other count as one, triangles that are there twice as one. Holes are
/// closed (`close_surface`), triangles are cut along each other (`resolve_crossings`), the cells between them are
/// inside where the surface winds round them [Jacobson et al. 2013; Zhou et al. 2016], and each component of what then
/// hangs together becomes the boundary of its inside. Nothing of the surface is lost beyond `max_deviation`: walls
/// inside stay as thin gaps, open sheets as thin plates, and where their two sides cannot be parted they touch
/// (`skipped`). Things are taken to touch that are nearer than half of it, at most. A solid that is right already is
/// returned bit for bit; of others the parts without crossings and walls keep their coordinates, the rest moves to a
/// grid of 2^-28 of the extent, and by up to 2^-20 of it where triangles cross at small angles (rarely up to 2^-13).
/// Attributes are interpolated within the triangle that a new vertex lies on.
///
/// Figures: "holes closed", "crossing pairs", "rounds of cutting", "faces inside dropped", "faces kept as thin walls",
/// "duplicates dropped", "triangles reversed", "shells that rounding turned inward" (and that were turned round).
/// `skipped`: "pairs that still cross" (then the result is not free of self-intersections). `touched_faces` are those
/// that are new. Where a solid was made once more of the result, `figures["passes"]` says how often in all.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
Report make_solid(Soup& soup, const MakeSolidOptions& options, Context& context);

/// The same.
/// @param fillings  on return the triangles of the soup that close holes, or are pieces of such, increasing: nothing of
/// what was given lies where they do
Report make_solid_naming_fillings(Soup& soup, const MakeSolidOptions& options, std::vector<std::uint32_t>& fillings,
                                  Context& context);

}  // namespace tri

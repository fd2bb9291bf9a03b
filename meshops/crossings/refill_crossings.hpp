#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A place where triangles cross that was left as it is.
struct PlaceLeft {
  /// What the best filling fell short of.
  enum class Reason {
    shape,    ///< no patch of up to 2000 triangles around it is a disk with a simple rim
    crosses,  ///< every filling crosses something, or has triangles without area
    too_far,  ///< the fillings are too far from what they would replace, or the other way round
  };
  Vec3 at{0, 0, 0};       ///< the middle of one of its triangles
  std::size_t pairs = 0;  ///< of triangles that cross there
  Reason reason = Reason::shape;
};

/// What `refill_crossings` did.
struct RefillReport {
  std::size_t refilled = 0;     ///< places
  std::vector<PlaceLeft> left;  ///< the others
};

/// Cuts out triangles that cross and fills the holes, place by place.
///
/// A place is what hangs together by crossing and by sides of triangles that cross. Of its patches each alone is tried,
/// smaller ones first, then all together; then again grown by the triangles around, up to three times. A patch that is
/// a disk is replaced by triangles between the corners of its rim (`fill_ring`, `untangle_filling`), which runs the
/// same way and keeps its sides: no side that was open closes, none that was closed opens, and the surface keeps its
/// Euler characteristic. It is done only if then nothing of the place crosses and the new triangles meet nothing in
/// more than they share, if each has an area, and if every place of the patch is within `farthest` of its filling, and
/// the other way round (`reach_of`). No patch holds triangles of an earlier filling. Vertices keep their coordinates;
/// those within patches go. New triangles take their values from one of the patch with corners in common, at each
/// corner from one with this corner.
///
/// @param crossing   pairs of triangles that cross (`surface_contacts`)
/// @param farthest   model units
/// @param report     counts and `touched_faces` are set
/// @throws Cancelled; the soup is then as it was
RefillReport refill_crossings(Soup& soup, std::span<const std::array<std::uint32_t, 2>> crossing, double farthest,
                              Report& report, Context& context);

}  // namespace tri

#pragma once

#include <cstddef>
#include <cstdint>

#include "meshops/context.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What `split_crossings` did.
struct SplitReport {
  std::size_t cut = 0;     ///< faces that were cut
  std::size_t undone = 0;  ///< places at which that made no fewer pairs cross: they are as they were
  std::size_t left = 0;    ///< pairs of triangles that cross at the end
};

/// Cuts triangles along each other where they cross (`resolve_crossings`) and rounds to a grid of 2^-28 of the extent;
/// all pieces stay. Vertices that were there keep their coordinates, unless that makes their triangles cross: then they
/// move to the grid, too. A place, which is what hangs together by crossing and by sides of triangles that were cut, is
/// left alone where as many pairs would cross afterwards as before. Where fewer would, but some, it is done again.
///
/// @param crossing  how many pairs cross (`surface_contacts`), not 0
/// @param farthest  model units: no vertex moves farther
/// @param report    counts are added; `touched_faces` of the soup before become those after, with the new ones
/// @throws Cancelled; the soup is then as it was
SplitReport split_crossings(Soup& soup, std::size_t crossing, double farthest, Report& report, Context& context);

}  // namespace tri

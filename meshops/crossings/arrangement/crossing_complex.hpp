#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/crossings/arrangement/grid_geometry.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Triangles on the integer grid, of any topology, that are cut along each other until none crosses another.
struct CrossingComplex {
  struct Face {
    Triangle v;
    std::uint32_t source;  ///< whatever the maker counts by, say the triangle that the face is a piece of
    std::int32_t net;      ///< how often the face is there as it runs, less how often it is there reversed
    bool original;         ///< false for what was only added to close a hole
  };

  std::vector<GridPoint> points;  ///< no two are equal
  std::vector<Face> faces;        ///< no two have the same corners
};

/// What `resolve_crossings` did.
struct CrossingReport {
  std::size_t rounds = 0;  ///< in which something was cut
  std::size_t pairs = 0;   ///< that met in the first round
  std::size_t cut = 0;     ///< faces cut in all rounds
  std::size_t left = 0;    ///< pairs that meet at the end: 0 unless the rounds ran out or made it worse
  double reach = 0;        ///< grid steps within which things were taken to touch in the last round
};

/// Cuts faces along their common points until any two have only corners and sides in common.
///
/// Each round finds all common points and segments exactly, cuts the faces by constrained triangulations and rounds the
/// new points to the grid [iterated snap rounding: Lazard & Valque 2025; Hobby 1999]; what the rounding makes cross is
/// cut in the next, on a coarser grid after a few rounds. As a chain the surface stays what it was: where it was closed
/// it is closed, though faces that fall together become one with `net` their sum.
/// @param complex     points and faces may contain duplicates and faces without area at first
/// @param first_reach grid steps within which things are taken to touch in the second round; doubled in each of the
/// next seven
/// @param most_reach  grid steps; it is never more
CrossingReport resolve_crossings(CrossingComplex& complex, double first_reach, double most_reach, Context& context);

}  // namespace tri

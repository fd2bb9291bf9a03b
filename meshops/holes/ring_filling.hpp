#pragma once

#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/holes/polygon_triangulation.hpp"

namespace tri {

/// How a hole is triangulated.
enum class HoleStrategy {
  nearest_diagonal,       ///< cut the ear with the shortest diagonal, again and again [Ristic et al. 2000]
  minimum_area_dihedral,  ///< least (largest dihedral angle, area) [Barequet & Sharir 1995, Liepa 2003]
  minimum_area,           ///< least area
  least_bending,          ///< least area and bending together (`RingObjective::bending`)
};

/// A ring in space to be filled with triangles between its own vertices.
struct Ring {
  std::vector<Vec3> points;          ///< at least 3, in the direction in which the new triangles run
  std::vector<Vec3> edge_normals;    ///< unit normal of the surface beyond edge (i, i + 1), zero where there is none
  std::vector<Vec3> vertex_normals;  ///< unit normal of the surface around each vertex, zero where unknown; or empty
  ChordTest chord_allowed;           ///< chords for which it is false are in no triangle; empty: all are allowed
};

/// Triangles between the points of a ring.
struct RingFilling {
  std::vector<RingTriangle> triangles;  ///< points.size() - 2, or none if forbidden chords allow no triangulation
  bool in_pieces = false;               ///< the ring was longer than `max_dynamic_edges`, so the minimum is a local one
};

/// Triangulates a ring.
///
/// Up to `max_dynamic_edges` edges the minimum strategies search by dynamic programming. A longer ring is first cut
/// down to that many edges by nearest diagonals and what is left is searched; then the vertices come back in the
/// reverse order, with flips around each as long as they make the triangulation lighter, and at last connected pieces
/// around edges of more than 20 degrees are searched anew (`RingTriangulation`). That was near-linear in measurements
/// and ends in a minimum that is local, but starts from the whole ring's shape.
/// @throws Cancelled within a few milliseconds, for max_dynamic_edges up to 128; the time grows with its cube.
RingFilling fill_ring(const Ring& ring, HoleStrategy strategy, int max_dynamic_edges, const Context& context);

}  // namespace tri

#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "libtri/registration.hpp"
#include "libtri/triangulation/point_mesh.hpp"
#include "meshops/context.hpp"

namespace tri {

/// What bridges: triangles that are more than 60 degrees off the model's normal at the place nearest to their middle,
/// and there farther from the model than noise explains. They stand across a wall, a slot or a sharp edge, or face the
/// wrong way.
struct Bridges {
  std::uint64_t triangles = 0;
  double area = 0;        ///< mm^2, of those triangles
  double total_area = 0;  ///< mm^2, of the mesh

  double share() const { return total_area > 0 ? area / total_area : 0; }
};

/// Triangulates small regions around bridging triangles anew, so that less of the mesh bridges.
///
/// A region is a disc of triangles without a vertex inside. Its best triangulation is found by dynamic programming over
/// its chords [Barequet & Sharir 1995]: the least sum of area, misfit to the model's normals and shape
/// (`TriangleCost`), folds, and, weighing most, bridging area. It is taken where it lowers that sum and crosses no more
/// triangles than the old one, so the work ends. Where the points lie farther apart than a wall is thick, a rim without
/// points of its own is then closed by a slope and not by a step; what no triangulation of the points avoids stays. No
/// point moves; topology and boundary keep.
///
/// @param points  mm, measured positions: crossings are judged there
/// @param feet  one per point: all else is judged there
/// @param tolerance  mm, >= 0: distance from the model that noise explains
/// @return what still bridges
/// @throws Cancelled; the mesh is then as it was
Bridges lessen_bridges(std::span<const Vec3> points, std::span<const Foot> feet, const Registration& registration,
                       double tolerance, PointMesh& mesh, Context& context);

/// Triangulates regions around triangles that cross others anew where that leaves fewer crossings, as `lessen_bridges`
/// does for bridges: for crossings that no flip of one edge undoes. Parts of the mesh that are not connected keep the
/// crossings between them: solids of an assembly that touch have such places, and no triangulation is without.
///
/// @param pairs  the crossings, as `self_intersections` gives them
/// @return whether the mesh changed
/// @throws Cancelled; the mesh is then as it was
bool mend_crossings(std::span<const Vec3> points, std::span<const Foot> feet, const Registration& registration,
                    double tolerance, std::span<const std::array<std::uint32_t, 2>> pairs, PointMesh& mesh,
                    Context& context);

}  // namespace tri

#include "meshops/conversions.hpp"
#include "meshops/operators/compact.hpp"
#include "meshops/operators/decimate.hpp"
#include "meshops/operators/extract_boundaries.hpp"
#include "meshops/operators/fair.hpp"
#include "meshops/operators/fill_holes.hpp"
#include "meshops/operators/flip_diagonals.hpp"
#include "meshops/operators/make_solid.hpp"
#include "meshops/operators/orient.hpp"
#include "meshops/operators/remesh.hpp"
#include "meshops/operators/remove_components.hpp"
#include "meshops/operators/remove_degenerate.hpp"
#include "meshops/operators/remove_duplicates.hpp"
#include "meshops/operators/remove_outliers.hpp"
#include "meshops/operators/remove_redundant.hpp"
#include "meshops/operators/remove_self_intersections.hpp"
#include "meshops/operators/resolve_t_junctions.hpp"
#include "meshops/operators/smooth.hpp"
#include "meshops/operators/split_non_manifold.hpp"
#include "meshops/operators/stitch_boundaries.hpp"
#include "meshops/operators/stitch_contours.hpp"
#include "meshops/operators/subdivide.hpp"
#include "meshops/operators/thin.hpp"
#include "meshops/operators/weld.hpp"
#include "meshops/registry.hpp"

namespace tri {

void register_operators(Registry& registry) {
  registry.add_conversion("build-mesh", Domain::soup, Domain::mesh, build_mesh_step,
                          "Links triangles to a half-edge mesh; orients them and splits what is not manifold");
  registry.add_conversion("to-soup", Domain::mesh, Domain::soup, to_soup_step,
                          "Turns a mesh into points and triangles again, without deleted elements");
  registry.add("compact", compact, "Drops elements marked as deleted; the others keep their order",
               {.keeps_handles = false, .takes_selection = false});
  registry.add("decimate", decimate,
               "Fewer triangles for the same shape: collapses edges in order of their quadric error",
               {.leaves_good_mesh = false, .idempotent = false});
  registry.add("extract-boundaries", extract_boundaries, "Finds the boundary loops and writes them as properties");
  registry.add("fair", fair, "Moves chosen vertices to the fairest surface between those that stay");
  registry.add("fill-holes", fill_holes, "Triangulates boundary loops of bounded size");
  registry.add("flip-diagonals", flip_diagonals,
               "Flips edges: for smoothness and shape, to Delaunay, or to the least curvature");
  registry.add("make-solid", make_solid,
               "Closes, untangles and thickens: any triangles become the boundary of a solid");
  registry.add("orient", orient, "Turns triangles so that neighbours agree and solids face outward");
  registry.add("remesh", remesh, "Triangles of even shape and size, or sized by curvature, on the same surface",
               {.idempotent = false});
  registry.add("remove-components", remove_components,
               "Removes whole components by area, volume, size or rank, if asked to");
  registry.add("remove-degenerate", remove_degenerate, "Collapses needles and takes caps out, without leaving holes");
  registry.add("remove-duplicates", remove_duplicates, "Removes triangles with the same corners as another");
  registry.add("remove-outliers", remove_outliers, "Removes points that lie alone, by the distance to their neighbours",
               {.idempotent = false});
  registry.add("remove-redundant", remove_redundant, "Deletes triangles by edge length, normal and boundary shape",
               {.idempotent = false});
  registry.add("remove-self-intersections", remove_self_intersections,
               "Cuts out and refills, or cuts along each other, triangles that cross");
  registry.add("resolve-t-junctions", resolve_t_junctions,
               "Splits boundary edges where other boundary vertices lie on them");
  registry.add("smooth", smooth, "Takes noise off by moving vertices; keeps creases, corners and boundary",
               {.leaves_good_mesh = false, .idempotent = false});
  registry.add("split-non-manifold", split_non_manifold,
               "Takes sheets apart where edges and vertices are not manifold");
  registry.add("stitch-boundaries", stitch_boundaries,
               "Joins boundary edges that coincide or face each other across a gap");
  registry.add("stitch-contours", stitch_contours,
               "Joins boundary contours that face each other by strips of triangles", {.idempotent = false});
  registry.add("subdivide", subdivide, "Makes four triangles of each, smoothly or on the same surface",
               {.leaves_good_mesh = false, .idempotent = false});
  registry.add("thin", thin, "Keeps one measured point in each voxel of a grid");
  registry.add("weld", weld, "Makes vertices that lie together one, where that joins edges");
}

}  // namespace tri

#pragma once

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Which diagonal of a quadrilateral of two triangles is better.
enum class FlipRule {
  smooth_shape,  ///< the smoother one where normals differ much, else the one with the larger smallest angle
  delaunay,      ///< where the surface is smooth, the one with the smaller opposite angles
  curvature,     ///< the one that gives less curvature
};

/// Which of two diagonals is the better one.
struct FlipDiagonalsOptions {
  FlipRule criterion = FlipRule::smooth_shape;  ///< what decides
  /// Radians between two normals; smooth_shape: above it smoothness decides, not shape; delaunay: above it an edge
  /// stays.
  double sharp_angle = 0.5;

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Chooses the better diagonal of each quadrilateral of two triangles.
///
/// `smooth_shape` [Ristic, Brujic & Handayani 2000, step (g)]: if the two normals differ by more than `sharp_angle`,
/// the smoother diagonal is better, in the sense of [Choi, Shin, Yoon & Lee 1988] but by a formula of our own: the one
/// with the smaller sum, over itself and the four sides, of the angles between the normals of the triangles that meet
/// there. Only what exceeds `sharp_angle` counts in the sum, so that where radii are small against the point spacing
/// [the case of Oblonsek & Guid 1998] several moderate bends are preferred to one crease, and bends that are none
/// cannot outweigh it. Else the diagonal with the larger smallest angle of its two triangles is better. Equally good
/// ones stay as they are.
///
/// Termination: a flip is done only if it lowers one global order of meshes, lexicographically (1) the sum of that
/// excess over all inner edges, in whole microradians; (2) the smallest angles of all triangles, sorted, the larger the
/// better. Each is computed from the corners in the order of their indices, so it does not depend on how the mesh came
/// about, and no mesh can come back. A triangle without area counts as folded over (excess of pi) with smallest angle
/// 0. Figures: "sharp edges before", "sharp edges after" (inner edges above `sharp_angle`), "smallest angle before",
/// "smallest angle after" (degrees).
///
/// `delaunay` (see `delaunay_criterion`): an edge whose opposite angles add up to more than pi is flipped, unless it is
/// sharp, or a fold or another sharp edge would come of it; a planar mesh becomes its (constrained) Delaunay
/// triangulation. Figures: "edges not Delaunay before", "edges not Delaunay after".
///
/// `curvature` [Dyn, Hormann, Kim & Levin 2001; see `curvature_criterion`]: lowers the total absolute mean curvature,
/// the flip with the largest gain first; for coarse meshes of curved surfaces, whose edges it lays along the directions
/// of least bend. It does not look at the shape of triangles, and leaves what is flat alone. It ends in a minimum that
/// no single flip lowers, which from badly twisted starts need not be the least. Figures: "total absolute mean
/// curvature before", "total absolute mean curvature after" (model units).
///
/// All end, each by an order of its own that every flip lowers. A queue of edges, each entered again when a triangle of
/// it or beside it has changed: time grows with edges and flips. Flips are serial, and the result does not depend on
/// the number of threads; edges are taken by index, then in the order in which they were entered again. Positions,
/// boundary and all handles stay; a flipped edge keeps its handle and properties. Never makes an edge that is there
/// already. `touched_faces`: every face that changed. `skipped`, in the mesh as it is left: edges whose other diagonal
/// would be better by the rule but "would not lower the global order" (`delaunay`: "would fold, or make an edge
/// sharp"), or "is an edge already".
///
/// On cancel (checked every 1024 edges) the mesh is valid, with the flips done so far.
/// @throws InvalidInput if an option is out of range; the mesh is untouched.
Report flip_diagonals(MeshView mesh, const FlipDiagonalsOptions& options, Context& context);

}  // namespace tri

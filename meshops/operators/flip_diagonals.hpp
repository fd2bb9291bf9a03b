#pragma once

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"

namespace tri {

struct FlipDiagonalsOptions {
  double sharp_angle = 0.5;  ///< radians between two normals above which smoothness decides, not shape

  static const OptionSchema& schema();
};

/// Chooses the better diagonal of each quadrilateral of two triangles [Ristic, Brujic & Handayani 2000, step (g)].
///
/// If the two normals differ by more than `sharp_angle`, the smoother diagonal is better, in the
/// sense of [Choi, Shin, Yoon & Lee 1988] but by a formula of our own:
/// the one with the smaller sum, over itself and the four sides, of the angles between the normals of the triangles
/// that meet there. Only what exceeds `sharp_angle` counts in the sum, so that where radii are small against the point
/// spacing [the case of Oblonsek & Guid 1998] several moderate bends are preferred to one crease, and bends that are
/// none cannot outweigh it. Else the diagonal with the larger smallest angle of its two triangles is better. Equally
/// good ones stay as they are.
///
/// Termination: a flip is done only if it lowers one global order of meshes, lexicographically (1) the sum of that
/// excess over all inner edges, in whole microradians; (2) the smallest angles of all triangles, sorted, the larger the
/// better. Each is computed from the corners in the order of their indices, so it does not depend on how the mesh came
/// about, and no mesh can come back. A triangle without area counts as folded over (excess of pi) with smallest angle
/// 0.
///
/// A queue of edges, each entered again when a triangle of it or beside it has changed: time grows with edges and
/// flips. Serial; edges are taken by index, then in the order in which they were entered again. Positions, boundary and
/// all handles stay; a flipped edge keeps its handle and properties. Never makes an edge that is there already.
/// `touched_faces`: every face that changed. `skipped`, in the mesh as it is left: edges whose other diagonal would be
/// better by the rule but "would not lower the global order", or "is an edge already". Figures: "sharp edges before",
/// "sharp edges after" (inner edges above `sharp_angle`), "smallest angle before", "smallest angle after" (degrees).
///
/// On cancel (checked every 1024 edges) the mesh is valid, with the flips done so far.
/// @throws InvalidInput if an option is out of range; the mesh is untouched.
Report flip_diagonals(MeshView mesh, const FlipDiagonalsOptions& options, Context& context);

}  // namespace tri

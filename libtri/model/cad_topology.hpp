#pragma once

#include "libtri/model/cad_model.hpp"

namespace tri {

/// What the loops and edges of a model say about it as a surface, without any triangle.
///
/// Counted on the manifold that the faces form: edges with more than two uses, or with two uses that run the same way,
/// are cut open, and a vertex where several fans of faces meet counts once for each fan, as `tessellate` does it.
struct CadTopology {
  long components = 0;            ///< sets of faces joined along edges
  long loops = 0;                 ///< closed boundary curves, made of free edges
  long euler = 0;                 ///< vertices - edges + sum over faces of (2 - trimming loops of the face)
  long free_edges = 0;            ///< used once
  long seam_edges = 0;            ///< used twice by one face
  long degenerate_edges = 0;      ///< poles
  long nonmanifold_edges = 0;     ///< used more than twice
  long incoherent_edges = 0;      ///< used twice in the same direction: the faces disagree about the outside
  long nonmanifold_vertices = 0;  ///< where several fans of faces meet
};

/// The formula holds because a trimmed face, cut along its seams, is an open piece of a plane with as many ends as it
/// has trimming loops; a pole is one point, however long its parameter curve.
CadTopology cad_topology(const CadModel& model);

}  // namespace tri

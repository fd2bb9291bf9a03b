#pragma once

#include <functional>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Runs an operator that works on soups on a mesh, in place: what it leaves as it was keeps its handles and values, so
/// that an editor can weld or stitch its own mesh as it fills a hole.
///
/// The mesh, or the faces of the view's selection with their corners, becomes a soup, and what the operator made of it
/// a manifold mesh (`build_mesh`). Triangles that have their corners still keep their face; the others are deleted and
/// made anew at the end. New faces inherit from the triangle they came from; new vertices from the vertex they are a
/// copy of, else from the corners of a face around them by their place in it. Corner values are those of the soup.
///
/// With a selection, the faces around it keep their own corners: where the operator took a corner at the rim away, the
/// two sides part there ("parted at the rim" in the figures).
///
/// If the operator reports no change, the mesh is not touched. The report is the operator's, with the mesh's own
/// indices. O(elements of the mesh), also with a selection.
/// @throws what the operator and `build_mesh` throw, before the mesh is changed; InvalidInput if what the operator made
/// of a
///   selection does not fit to the rest (an edge would get three faces): the mesh is as it was.
Report run_on_mesh(const std::function<Report(Soup&)>& op, MeshView mesh, Context& context);

}  // namespace tri

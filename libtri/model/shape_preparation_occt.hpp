#pragma once

// Included only by the source files that wrap OpenCASCADE.
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "meshops/context.hpp"

namespace tri {

/// A shape on its way to a CadModel, with the way back to the faces as read.
struct PreparedShape {
  TopoDS_Shape shape;
  /// Entry i: face i + 1 of the shape as read, as it is in `shape`, or null if it got lost.
  std::vector<TopoDS_Face> faces;
  /// Entry i: why the face got lost; empty if it did not.
  std::vector<std::string> lost;
  std::vector<std::string> warnings;
};

/// The shape as read, every face known.
PreparedShape track_faces(const TopoDS_Shape& shape);

/// True if `sewn` would sew: neither a solid nor exactly one shell.
bool needs_sewing(const TopoDS_Shape& shape);

/// Sews at `tolerance` mm and follows every face. Orientation is made coherent within each shell by the sewing.
/// @throws Cancelled within a step of the sewing
void sew(PreparedShape& prepared, double tolerance, Context& context);

/// From the shape as read to one that every later step can use: faces without wires get their natural bounds, loose
/// faces are sewn at `sew_tolerance` mm, missing parameter curves are made, loops that do not close in (u,v) are
/// repaired. The topology is copied first, geometry is shared: the shape as read stays untouched, whatever is stored in
/// the result.
/// @throws Cancelled between faces
PreparedShape prepare_shape(const TopoDS_Shape& shape, double sew_tolerance, Context& context);

}  // namespace tri

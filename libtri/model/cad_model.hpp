#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libtri/model/shape.hpp"
#include "libtri/surfaces/curve.hpp"
#include "libtri/surfaces/surface.hpp"
#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// One use of an edge by a face: a trimming curve in the face's (u,v), run in the loop's direction.
struct Coedge {
  int edge = 0;                          ///< 0-based index into CadModel::edges
  bool reversed = false;                 ///< the loop runs against the edge's own direction
  std::shared_ptr<const Curve2> pcurve;  ///< (u,v) over [first, last], in the edge's own direction
  double first = 0;                      ///< least parameter of the part that is used
  double last = 0;                       ///< greatest one
  /// pcurve within the chord tolerance, in the loop's direction, both ends included. The next coedge may start a gap
  /// away, as wide as the file's tolerances: join the two with a straight segment.
  std::vector<Vec2> polyline;
};

/// A closed sequence of coedges; the face's material lies to its left in (u,v) (before `reversed` is applied).
struct TrimLoop {
  std::vector<Coedge> coedges;  ///< each begins where the one before ends, the first where the last does
  bool outer = false;           ///< bounds the material from outside; the others are holes
};

/// A trimmed face of any surface type. (u,v) are those of the surface as read.
struct CadFace {
  int index = 0;                           ///< 1-based, TopExp::MapShapes order of the shape as read, before sewing
  std::shared_ptr<const Surface> surface;  ///< untrimmed; (u,v) are its own parameters
  bool reversed = false;                   ///< the outward normal is -(du x dv)
  /// What bounds the face in (u,v).
  std::vector<TrimLoop> loops;
  double u_min = 0;          ///< parameter box of the trimmed face: least u
  double u_max = 0;          ///< greatest u
  double v_min = 0;          ///< least v
  double v_max = 0;          ///< greatest v
  double area = 0;           ///< mm^2
  std::string name;          ///< from the file, may be empty
  std::string surface_type;  ///< "plane", "cylinder", ... "b-spline"
  int shape_face = 0;        ///< 1-based, TopExp::MapShapes order of CadModel::shape (after sewing)
  int shell = 0;             ///< 0-based connected component of the sewn model
};

/// A curve where faces meet, or a free rim.
///
/// Entry i of CadModel::edges is edge i + 1 in TopExp::MapShapes order of CadModel::shape.
struct CadEdge {
  /// 0-based positions in CadModel::faces, one entry per use (a seam names its face twice); empty for a curve that
  /// bounds no usable face.
  std::vector<int> faces;
  /// The curve in space within the chord tolerance, in the edge's own direction; a single point for a degenerate edge;
  /// empty if the file gives the edge in (u,v) only and no curve in space could be made.
  std::vector<Vec3> polyline;
  double tolerance = 0;     ///< mm, as the file states or the sewing widened it
  bool degenerate = false;  ///< a pole: a point in space, a curve in (u,v)
  int start_vertex = -1;    ///< 0-based position in CadModel::vertices; -1 if the edge has none there
  int end_vertex = -1;      ///< the same of the other end
};

/// A face of the file that could not be used.
struct UnusableFace {
  int index = 0;       ///< 1-based, as CadFace::index
  std::string name;    ///< from the file, may be empty
  std::string reason;  ///< one sentence
};

/// The CAD model as trimmed faces in flat arrays, free of OpenCASCADE. Immutable; may be shared between threads.
struct CadModel {
  std::vector<CadFace> faces;  ///< those that can be used, by ascending CadFace::index
  /// Each once, however many faces meet in it.
  std::vector<CadEdge> edges;
  std::vector<Vec3> vertices;                ///< topological vertices, in TopExp::MapShapes order of `shape`
  std::vector<UnusableFace> unusable_faces;  ///< those of the file that are not in `faces`
  std::vector<std::string> warnings;  ///< what was repaired or is odd, one line each, naming faces by CadFace::index
  Vec3 box_min{0, 0, 0};              ///< mm, least coordinates of the tight bounding box
  Vec3 box_max{0, 0, 0};              ///< mm, its greatest ones
  double diagonal = 0;                ///< mm, of the tight bounding box
  Shape shape;                        ///< a copy of the shape after sewing and repair, for what still needs OpenCASCADE
};

/// Reads the faces, trimming loops and adjacency of `shape`, sewn as `sewn()` says where it has no topology of its own.
///
/// Polylines keep within 1e-5 of the model's diagonal, measured in space. The outward side of a face is the one that
/// its shell (after sewing) gives it; a model that is inside out stays so. Faces that cannot be used are named in
/// `unusable_faces`; whatever they shared with others becomes a free edge. `shape` itself is not changed.
/// @param sew_tolerance  mm, > 0
/// @throws InvalidInput if `shape` is empty or the tolerance is not positive.
/// @throws CadError if no face is usable.
/// @throws Cancelled between faces, and within the sewing.
CadModel make_cad_model(const Shape& shape, double sew_tolerance, Context& context);

/// The same, without progress and cancel.
CadModel make_cad_model(const Shape& shape, double sew_tolerance = 0.01);

}  // namespace tri

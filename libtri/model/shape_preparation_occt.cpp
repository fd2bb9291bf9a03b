#include "libtri/model/shape_preparation_occt.hpp"

#include <fmt/format.h>

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Precision.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Edge.hxx>
#include <ShapeFix_Face.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <cmath>

#include "libtri/model/trim_loops_occt.hpp"
#include "libtri/progress_occt.hpp"

namespace tri {
namespace {

/// Follows every face through one step, whatever that step calls its result.
template <class Follow>
void follow_faces(PreparedShape& prepared, const TopoDS_Shape& result, const char* step, Follow follow) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(result, TopAbs_FACE, map);
  for (std::size_t i = 0; i < prepared.faces.size(); ++i) {
    if (prepared.faces[i].IsNull()) continue;
    const TopoDS_Shape next = follow(prepared.faces[i]);
    int index = next.IsNull() ? 0 : map.FindIndex(next);
    if (index == 0 && !next.IsNull())  // a face may come back wrapped
      if (TopExp_Explorer inside(next, TopAbs_FACE); inside.More()) index = map.FindIndex(inside.Current());
    if (index > 0) {
      prepared.faces[i] = TopoDS::Face(map(index));
    } else {
      prepared.faces[i].Nullify();
      prepared.lost[i] = step;
    }
  }
  prepared.shape = result;
}

void copy_topology(PreparedShape& prepared) {
  BRepBuilderAPI_Copy copy(prepared.shape, Standard_False, Standard_False);
  follow_faces(prepared, copy.Shape(), "lost while copying",
               [&](const TopoDS_Shape& face) { return copy.ModifiedShape(face); });
}

bool has_wire(const TopoDS_Shape& face) {
  return TopExp_Explorer(face, TopAbs_EDGE).More();
}

bool has_finite_bounds(const Handle(Geom_Surface) & surface) {
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  for (const double bound : {u0, u1, v0, v1})
    if (!std::isfinite(bound) || Precision::IsInfinite(bound)) return false;
  return true;
}

void add_natural_bounds(PreparedShape& prepared) {
  const Handle(BRepTools_ReShape) reshape = new BRepTools_ReShape;
  bool any = false;
  for (const TopoDS_Shape& shape : prepared.faces) {
    if (shape.IsNull() || has_wire(shape)) continue;
    const TopoDS_Face face = TopoDS::Face(shape);
    TopLoc_Location location;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
    if (surface.IsNull() || !has_finite_bounds(surface)) continue;  // named as unusable by the reader of the faces
    BRepBuilderAPI_MakeFace make(surface, Precision::Confusion());
    if (!make.IsDone()) continue;
    TopoDS_Shape bounded = make.Face();
    bounded.Location(location);
    bounded.Orientation(face.Orientation());
    reshape->Replace(face, bounded);
    any = true;
  }
  if (any)
    follow_faces(prepared, reshape->Apply(prepared.shape), "lost while its natural bounds were added",
                 [&](const TopoDS_Shape& face) { return reshape->Value(face); });
}

/// Edges known by their parameter curves only get a curve in space; poles have none.
void add_missing_curves(PreparedShape& prepared, Context& context) {
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(prepared.shape, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i) {
    context.checkpoint();
    const TopoDS_Edge edge = TopoDS::Edge(edges(i));
    double first, last;
    if (BRep_Tool::Degenerated(edge) || !BRep_Tool::Curve(edge, first, last).IsNull()) continue;
    try {
      ShapeFix_Edge().FixAddCurve3d(edge);
    } catch (const Standard_Failure&) {
      // The edge's polyline stays empty.
    }
  }
}

void add_missing_pcurves(PreparedShape& prepared, Context& context) {
  for (const TopoDS_Shape& shape : prepared.faces) {
    context.checkpoint();
    if (shape.IsNull()) continue;
    const TopoDS_Face face = TopoDS::Face(shape.Oriented(TopAbs_FORWARD));
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Current());
      double first, last;
      if (!BRep_Tool::CurveOnSurface(edge, face, first, last).IsNull()) continue;
      try {
        ShapeFix_Edge fix;
        fix.FixAddPCurve(edge, face, Standard_False, 0);
        fix.FixSameParameter(edge);
      } catch (const Standard_Failure&) {
        // The face is named as unusable when its loops are read.
      }
    }
  }
}

void repair_open_loops(PreparedShape& prepared, Context& context) {
  const Handle(ShapeBuild_ReShape) reshape = new ShapeBuild_ReShape;
  std::vector<std::size_t> repaired;
  for (std::size_t i = 0; i < prepared.faces.size(); ++i) {
    context.checkpoint();
    const TopoDS_Face& face = prepared.faces[i];
    if (face.IsNull() || !has_wire(face) || loops_close(face)) continue;
    try {
      ShapeFix_Face fix(face);
      fix.SetContext(reshape);
      fix.SetPrecision(Precision::Confusion());
      fix.SetMaxTolerance(BRep_Tool::Tolerance(face) + 0.1);
      fix.Perform();
      repaired.push_back(i);
    } catch (const Standard_Failure&) {
      // As above.
    }
  }
  if (repaired.empty()) return;
  follow_faces(prepared, reshape->Apply(prepared.shape), "lost while its loops were repaired",
               [&](const TopoDS_Shape& face) { return reshape->Apply(face); });
  for (const std::size_t i : repaired)
    if (!prepared.faces[i].IsNull() && loops_close(prepared.faces[i]))
      prepared.warnings.push_back(
          fmt::format("face {}: its trimming loops did not close in (u,v) and were repaired", i + 1));
}

}  // namespace

bool needs_sewing(const TopoDS_Shape& shape) {
  int shells = 0;
  for (TopExp_Explorer it(shape, TopAbs_SHELL); it.More(); it.Next()) ++shells;
  const bool has_solid = TopExp_Explorer(shape, TopAbs_SOLID).More();
  return !has_solid && shells != 1;
}

void sew(PreparedShape& prepared, double tolerance, Context& context) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  sewing.Add(prepared.shape);
  const Handle(OcctProgress) progress = new OcctProgress(context, "sew");
  sewing.Perform(progress->Start());
  context.checkpoint();
  const std::string step = fmt::format("degenerates when the faces are sewn at {} mm", tolerance);
  follow_faces(prepared, sewing.SewedShape(), step.c_str(), [&](const TopoDS_Shape& face) {
    return sewing.IsModifiedSubShape(face) ? sewing.ModifiedSubShape(face) : face;
  });
}

PreparedShape track_faces(const TopoDS_Shape& shape) {
  PreparedShape prepared;
  prepared.shape = shape;
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, TopAbs_FACE, map);
  for (int i = 1; i <= map.Extent(); ++i) prepared.faces.push_back(TopoDS::Face(map(i)));
  prepared.lost.resize(prepared.faces.size());
  return prepared;
}

PreparedShape prepare_shape(const TopoDS_Shape& shape, double sew_tolerance, Context& context) {
  PreparedShape prepared = track_faces(shape);
  copy_topology(prepared);
  add_natural_bounds(prepared);
  add_missing_curves(prepared, context);
  if (needs_sewing(prepared.shape)) sew(prepared, sew_tolerance, context);
  add_missing_pcurves(prepared, context);
  repair_open_loops(prepared, context);
  return prepared;
}

}  // namespace tri

// Steps that the example parts have in common.
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <gp_Ax2.hxx>

#include "libtri/parts/parts.hpp"
#include "meshops/error.hpp"

namespace tri::parts {
namespace {

template <class Operation>
TopoDS_Shape boolean(const TopoDS_Shape& a, const TopoDS_Shape& b, const char* name) {
  Operation operation(a, b);
  if (!operation.IsDone() || operation.HasErrors()) throw CadError(std::string("example part: ") + name + " failed");
  return operation.Shape();
}

// Outward normal of the face at the point of the shell that is closest to `outside`, dotted with the way there.
double looks_to(const TopoDS_Shape& shell, const gp_Pnt& outside) {
  const TopoDS_Shape vertex = BRepBuilderAPI_MakeVertex(outside).Shape();
  BRepExtrema_DistShapeShape distance(vertex, shell);
  for (int i = 1; i <= distance.NbSolution(); ++i) {
    if (distance.SupportTypeShape2(i) != BRepExtrema_IsInFace) continue;
    const TopoDS_Face face = TopoDS::Face(distance.SupportOnShape2(i));
    double u, v;
    distance.ParOnFaceS2(i, u, v);
    gp_Pnt p;
    gp_Vec du, dv;
    BRepAdaptor_Surface(face).D1(u, v, p, du, dv);
    gp_Vec normal = du.Crossed(dv);
    if (face.Orientation() == TopAbs_REVERSED) normal.Reverse();
    return normal.Dot(gp_Vec(p, outside));
  }
  throw CadError("example part: no face in front of the viewer's place");
}

}  // namespace

TopoDS_Shape filleted(const TopoDS_Shape& shape, double radius, const EdgeFilter& wanted) {
  BRepFilletAPI_MakeFillet fillet(shape);
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges(i));
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepAdaptor_Curve curve(edge);
    gp_Pnt middle;
    gp_Vec tangent;
    curve.D1(0.5 * (curve.FirstParameter() + curve.LastParameter()), middle, tangent);
    if (wanted(middle, tangent.Normalized())) fillet.Add(radius, edge);
  }
  if (fillet.NbContours() == 0) throw CadError("example part: no edge to round");
  fillet.Build();
  if (!fillet.IsDone()) throw CadError("example part: a fillet failed");
  return fillet.Shape();
}

TopoDS_Shape box(double x, double y, double z, double dx, double dy, double dz) {
  return BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), dx, dy, dz).Shape();
}

TopoDS_Shape cylinder(double x, double y, double z, double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, z), gp_Dir(0, 0, 1)), radius, height).Shape();
}

TopoDS_Shape fused(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  return boolean<BRepAlgoAPI_Fuse>(a, b, "fuse");
}
TopoDS_Shape cut(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  return boolean<BRepAlgoAPI_Cut>(a, b, "cut");
}
TopoDS_Shape common(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  return boolean<BRepAlgoAPI_Common>(a, b, "common");
}

TopoDS_Shape joined(const std::vector<TopoDS_Shape>& faces, double tolerance, const gp_Pnt& outside) {
  TopoDS_Shape shell;
  if (faces.size() == 1) {  // sewing returns a single face as a face
    TopoDS_Shell single;
    BRep_Builder builder;
    builder.MakeShell(single);
    builder.Add(single, faces.front());
    shell = single;
  } else {
    BRepBuilderAPI_Sewing sewing(tolerance);
    for (const TopoDS_Shape& face : faces) sewing.Add(face);
    sewing.Perform();
    TopExp_Explorer shells(sewing.SewedShape(), TopAbs_SHELL);
    if (!shells.More()) throw CadError("example part: the faces do not join");
    shell = shells.Current();
    shells.Next();
    if (shells.More()) throw CadError("example part: the faces join into several shells");
  }
  if (looks_to(shell, outside) < 0) shell.Reverse();
  return shell;
}

TopoDS_Shape only_solid(const TopoDS_Shape& shape) {
  TopExp_Explorer solids(shape, TopAbs_SOLID);
  if (!solids.More()) throw CadError("example part: no solid");
  TopoDS_Shape solid = solids.Current();
  solids.Next();
  if (solids.More()) throw CadError("example part: several solids");
  return solid;
}

}  // namespace tri::parts

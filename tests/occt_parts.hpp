#pragma once

// Shapes that the CAD tests build with OpenCASCADE itself.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <functional>
#include <gp_Ax2.hxx>
#include <numbers>
#include <string>
#include <vector>

namespace tri::test {

/// A solid with what is known of it in closed form.
struct KnownSolid {
  std::string name;
  TopoDS_Shape shape;
  int faces = 0;
  double area = 0;  // mm^2
  long euler = 2;
};

inline TopoDS_Shape box_with_hole() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(20, 30, 10).Shape();
  const TopoDS_Shape drill = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(8, 12, -1), gp_Dir(0, 0, 1)), 4, 12).Shape();
  return BRepAlgoAPI_Cut(box, drill).Shape();
}

inline std::vector<KnownSolid> known_solids() {
  using std::numbers::pi;
  return {
      {"box", BRepPrimAPI_MakeBox(20, 30, 10).Shape(), 6, 2200, 2},
      {"cylinder", BRepPrimAPI_MakeCylinder(5, 12).Shape(), 3, 2 * pi * 25 + 2 * pi * 5 * 12, 2},
      {"cone", BRepPrimAPI_MakeCone(6, 0, 8).Shape(), 2, pi * 36 + pi * 6 * 10, 2},
      {"sphere", BRepPrimAPI_MakeSphere(7).Shape(), 1, 4 * pi * 49, 2},
      {"torus", BRepPrimAPI_MakeTorus(10, 3).Shape(), 1, 4 * pi * pi * 30, 0},
      {"box with hole", box_with_hole(), 7, 2200 - 2 * pi * 16 + 2 * pi * 4 * 10, 0},
  };
}

inline std::vector<TopoDS_Face> faces_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, TopAbs_FACE, map);
  std::vector<TopoDS_Face> faces;
  for (int i = 1; i <= map.Extent(); ++i) faces.push_back(TopoDS::Face(map(i)));
  return faces;
}

/// The faces of a shape without anything in common, as an IGES file brings them.
inline TopoDS_Compound loose_faces(const TopoDS_Shape& shape) {
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces_of(shape)) builder.Add(compound, BRepBuilderAPI_Copy(face).Shape());
  return compound;
}

}  // namespace tri::test

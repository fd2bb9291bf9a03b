// The car boot lid of [Ristic et al. 2000]: 16 trimmed NURBS faces. x runs across the car, y to the rear, z up.
#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <gp_Ax2.hxx>

#include "libtri/parts/parts.hpp"
#include "meshops/error.hpp"

namespace tri::parts {
namespace {

constexpr double rear_y = 560;  // where the rear panel stands at mid-width
constexpr double recess_depth = 22;

// A bicubic B-spline over [0,1] x [0,1] with 6 x 6 control points at the Greville abscissae of `position`;
// `weight` differs from 1 for a rational surface.
template <class Position, class Weight>
Handle(Geom_BSplineSurface) bicubic(const Position& position, const Weight& weight) {
  constexpr int n = 6;
  const double knot[] = {0, 1.0 / 3, 2.0 / 3, 1};
  const double greville[n] = {0, 1.0 / 9, 1.0 / 3, 2.0 / 3, 8.0 / 9, 1};
  TColgp_Array2OfPnt poles(1, n, 1, n);
  TColStd_Array2OfReal weights(1, n, 1, n);
  TColStd_Array1OfReal knots(1, 4);
  TColStd_Array1OfInteger multiplicities(1, 4);
  for (int i = 0; i < 4; ++i) {
    knots(i + 1) = knot[i];
    multiplicities(i + 1) = i == 0 || i == 3 ? 4 : 1;
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      poles(i + 1, j + 1) = position(greville[i], greville[j]);
      weights(i + 1, j + 1) = weight(greville[i], greville[j]);
    }
  }
  return new Geom_BSplineSurface(poles, weights, knots, knots, multiplicities, multiplicities, 3, 3);
}

double unweighted(double, double) {
  return 1;
}

// Everything behind a surface: the face swept along `sweep`.
TopoDS_Shape behind(const Handle(Geom_BSplineSurface) & surface, const gp_Vec& sweep) {
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(surface, 1e-6).Shape(), sweep).Shape();
}

// Crowned across, falling to the rear window, with the lip of a spoiler at the rear.
TopoDS_Shape below_deck() {
  return behind(bicubic(
                    [](double s, double t) {
                      const double x = -760 + 1520 * s, y = -120 + 850 * t;
                      const double lip = 1 / (1 + std::exp(-(y - 480) / 40));
                      return gp_Pnt(x, y,
                                    20 - 42 * std::pow(x / 650, 2) - 60 * std::pow((y - 180) / 560, 2) + 40 * lip);
                    },
                    unweighted),
                gp_Vec(0, 0, -1500));
}

// Bowed in plan and in profile, leaning outward towards the bumper.
Handle(Geom_BSplineSurface) rear_surface() {
  return bicubic(
      [](double s, double t) {
        const double x = -760 + 1520 * s, z = -560 + 700 * t;
        return gp_Pnt(x, rear_y - 75 * std::pow(x / 650, 2) - 0.16 * z - 30 * std::pow((z + 200) / 300, 2), z);
      },
      unweighted);
}

// `side` is -1 (left) or +1 (right). Weights vary along the car: a rational surface.
TopoDS_Shape inside_of_side(double side) {
  return behind(
      bicubic(
          [side](double s, double t) {
            const double y = -140 + 950 * s, z = -580 + 720 * t;
            return gp_Pnt(
                side * (638 - 30 * std::pow((y - 330) / 400, 2) - 0.07 * z - 9 * std::pow((z + 200) / 250, 2)), y, z);
          },
          [](double s, double t) { return 1 + 0.35 * s * (1 - s) + 0.2 * t; }),
      gp_Vec(-side * 1500, 0, 0));
}

// A wire of four sides in the plane y = const; the upper and lower ones are bowed upwards by `bow`.
TopoDS_Wire plate_outline(double y, double half_width, double bottom, double top, double bow) {
  const gp_Pnt a(-half_width, y, bottom), b(half_width, y, bottom), c(half_width, y, top), d(-half_width, y, top);
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(a, gp_Pnt(0, y, bottom + bow), b).Value()));
  wire.Add(BRepBuilderAPI_MakeEdge(b, c));
  wire.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(c, gp_Pnt(0, y, top + bow), d).Value()));
  wire.Add(BRepBuilderAPI_MakeEdge(d, a));
  return wire.Wire();
}

// The number-plate recess: drafted walls, the floor parallel to the rear panel. All its faces that remain in the lid
// are B-spline.
TopoDS_Shape recess() {
  BRepOffsetAPI_ThruSections walls(true, true);
  walls.AddWire(plate_outline(rear_y - 60, 262, -262, -142, 10));
  walls.AddWire(plate_outline(rear_y + 140, 302, -302, -102, 14));
  walls.Build();
  Handle(Geom_BSplineSurface) floor = rear_surface();
  floor->Translate(gp_Vec(0, -recess_depth, 0));
  return cut(walls.Shape(), behind(floor, gp_Vec(0, -1500, 0)));
}

// What is not lid: the space below the deck and before the rear panel, the rear window, the bumper.
TopoDS_Shape interior() {
  BRepBuilderAPI_MakeWire profile;
  const auto at = [](double y, double z) { return gp_Pnt(-1000, y, z); };
  profile.Add(BRepBuilderAPI_MakeEdge(at(-400, -85), at(370, -75)));
  profile.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(370, -75), at(425, -100), at(445, -150)).Value()));
  profile.Add(BRepBuilderAPI_MakeEdge(at(445, -150), at(470, -900)));
  profile.Add(BRepBuilderAPI_MakeEdge(at(470, -900), at(-400, -900)));
  profile.Add(BRepBuilderAPI_MakeEdge(at(-400, -900), at(-400, -85)));
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(profile.Wire()).Shape(), gp_Vec(2000, 0, 0)).Shape();
}

TopoDS_Shape rear_window() {
  // The lid's front rim is concave: the window bows into it.
  return cylinder(0, -1160, -1000, 1200, 2000);
}

TopoDS_Shape bumper() {
  // Below a rim that rises towards the middle, so that the rear panel's outline is concave as well.
  BRepBuilderAPI_MakeWire profile;
  const auto at = [](double x, double z) { return gp_Pnt(x, -500, z); };
  profile.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(-900, -455), at(0, -365), at(900, -455)).Value()));
  profile.Add(BRepBuilderAPI_MakeEdge(at(900, -455), at(900, -1500)));
  profile.Add(BRepBuilderAPI_MakeEdge(at(900, -1500), at(-900, -1500)));
  profile.Add(BRepBuilderAPI_MakeEdge(at(-900, -1500), at(-900, -455)));
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(profile.Wire()).Shape(), gp_Vec(0, 2000, 0)).Shape();
}

}  // namespace

TopoDS_Shape boot_lid() {
  TopoDS_Shape body = common(below_deck(), behind(rear_surface(), gp_Vec(0, -1500, 0)));
  body = common(common(body, inside_of_side(-1)), inside_of_side(1));
  // First the two rear corners seen from above, then the rim of the deck, which is one tangent chain by then.
  body = filleted(body, 65, [](const gp_Pnt& p, const gp_Vec& t) { return std::abs(t.Z()) > 0.9 && p.Y() > 300; });
  body = filleted(body, 24,
                  [](const gp_Pnt& p, const gp_Vec& t) { return std::abs(t.Z()) < 0.5 && p.Z() > -150 && p.Y() > 0; });
  body = cut(body, recess());
  const gp_Ax2 lock(gp_Pnt(0, rear_y - 200, -52), gp_Dir(0, 1, 0));
  body = cut(body, BRepPrimAPI_MakeCylinder(lock, 13, 400).Shape());
  body = cut(cut(cut(body, interior()), rear_window()), bumper());
  // The skin is what is B-spline; all that the tools left is plane, cylinder or extrusion.
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer it(body, TopAbs_FACE); it.More(); it.Next()) {
    if (BRepAdaptor_Surface(TopoDS::Face(it.Current())).GetType() == GeomAbs_BSplineSurface)
      faces.push_back(it.Current());
  }
  return joined(faces, 1e-3, gp_Pnt(250, 300, 600));
}

}  // namespace tri::parts

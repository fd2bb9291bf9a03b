// Trimmed domains against OpenCASCADE's face classifier and closed forms.
#include <doctest/doctest.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>
#include <gp_Circ.hxx>
#include <numbers>
#include <random>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/model/trim_region.hpp"

using namespace tri;
using std::numbers::pi;

TEST_CASE("trim region: agrees with OpenCASCADE's classifier away from the curves") {
  for (const char* part : {"boot-lid", "bracket", "housing", "blade", "sphere-cap"}) {
    CAPTURE(part);
    const CadModel model = make_cad_model(example_part(part));
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(occt(model.shape), TopAbs_FACE, faces);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(-0.05, 1.05);
    for (const CadFace& face : model.faces) {
      CAPTURE(face.index);
      const TrimRegion region(face);
      const TopoDS_Face shape = TopoDS::Face(faces(face.shape_face));
      for (int i = 0; i < 20; ++i) {
        const double u = region.u_min() + share(random) * (region.u_max() - region.u_min());
        const double v = region.v_min() + share(random) * (region.v_max() - region.v_min());
        const double eu = 1e-3 * (region.u_max() - region.u_min()), ev = 1e-3 * (region.v_max() - region.v_min());
        const TrimRegion::Side side = region.classify(u - eu, u + eu, v - ev, v + ev);
        if (side == TrimRegion::Side::crossing) continue;
        CHECK((side == TrimRegion::Side::inside) == region.contains(u, v));
        // The classifier moves parameters by periods; outside the box ours does not.
        if (side == TrimRegion::Side::outside && (face.surface->u_period() > 0 || face.surface->v_period() > 0))
          continue;
        const BRepClass_FaceClassifier truth(shape, gp_Pnt2d(u, v), 1e-9);
        CHECK(region.contains(u, v) == (truth.State() == TopAbs_IN));
      }
    }
  }
}

TEST_CASE("trim region: a curve that bulges beyond its chords is followed exactly") {
  const TopoDS_Edge circle = BRepBuilderAPI_MakeEdge(gp_Circ(gp::XOY(), 100));
  const CadModel model =
      make_cad_model(make_shape(BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(circle).Wire()).Face()));
  const TrimRegion region(model.faces[0]);
  for (int i = 0; i < 5000; ++i) {
    const double a = 0.001 + 2 * pi * i / 5000;
    for (const double r : {100 - 1e-9, 100 + 1e-9}) {
      Vec2 uv[2];
      REQUIRE(model.faces[0].surface->closest(Vec3(r * std::cos(a), r * std::sin(a), 0), uv) == 1);
      CHECK(region.contains(uv[0][0], uv[0][1]) == (r < 100));
    }
  }
}

TEST_CASE("trim region: parameters are shifted by whole periods into a closed face") {
  const CadModel model = make_cad_model(make_shape(BRepPrimAPI_MakeCylinder(4, 10).Shape()));
  for (const CadFace& face : model.faces) {
    if (face.surface_type != "cylinder") continue;
    const TrimRegion region(face);
    for (const double turns : {-3.0, -1.0, 0.0, 2.0}) {
      Vec2 uv(1.25 + 2 * pi * turns, 5);
      REQUIRE(region.locate(uv));
      CHECK(uv[0] == doctest::Approx(1.25));
      CHECK(uv[1] == 5);
      Vec2 above(1.25 + 2 * pi * turns, 10.5);
      CHECK_FALSE(region.locate(above));
    }
  }
}

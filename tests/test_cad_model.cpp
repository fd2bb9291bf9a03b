#include <doctest/doctest.h>

#include <BOPAlgo_Builder.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SphericalSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <cstdlib>
#include <filesystem>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>
#include <gp_Trsf.hxx>
#include <random>

#include "io/cad/cad_file.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/model/cad_model.hpp"
#include "libtri/model/cad_topology.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/model/tessellation.hpp"
#include "meshops/error.hpp"
#include "occt_parts.hpp"

using namespace tri;
using test::KnownSolid;

namespace {

double total_area(const CadModel& model) {
  double sum = 0;
  for (const CadFace& face : model.faces) sum += face.area;
  return sum;
}

/// Winding number of the face's loops around uv: 1 inside, 0 outside, if every loop has the material to its left.
int winding(const CadFace& face, const Vec2& uv) {
  int number = 0;
  for (const TrimLoop& loop : face.loops) {
    std::vector<Vec2> polygon;
    for (const Coedge& coedge : loop.coedges)
      polygon.insert(polygon.end(), coedge.polyline.begin(), coedge.polyline.end());
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const double side = (b[0] - a[0]) * (uv[1] - a[1]) - (b[1] - a[1]) * (uv[0] - a[0]);
      if (a[1] <= uv[1] && b[1] > uv[1] && side > 0) ++number;
      if (a[1] > uv[1] && b[1] <= uv[1] && side < 0) --number;
    }
  }
  return number;
}

/// A point inside the trimmed face, away from its loops' corners.
Vec2 inner_point(const CadFace& face) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.05, 0.95);
  for (int i = 0; i < 10000; ++i) {
    const Vec2 uv(face.u_min + unit(random) * (face.u_max - face.u_min),
                  face.v_min + unit(random) * (face.v_max - face.v_min));
    if (winding(face, uv) == 1) return uv;
  }
  FAIL("no point inside");
  return Vec2(0, 0);
}

Vec3 outward(const CadFace& face, const Vec2& uv) {
  const SurfacePoint s = face.surface->evaluate(uv[0], uv[1]);
  const Vec3 n = s.du % s.dv;
  return face.reversed ? -n : n;
}

/// Volume by the divergence theorem over the tessellation: positive if the faces look outward.
double volume(const CadModel& model) {
  Context context;
  const Tessellation t = tessellate(model, model.diagonal * 1e-3, 0.2, context);
  double sum = 0;
  for (const Triangle& triangle : t.triangles)
    sum += (t.points[triangle[0]] | (t.points[triangle[1]] % t.points[triangle[2]])) / 6;
  return sum;
}

template <class Vec>
double distance_to_segment(const Vec& p, const Vec& a, const Vec& b) {
  const Vec chord = b - a;
  const double cc = chord | chord;
  const double t = cc > 0 ? std::clamp(((p - a) | chord) / cc, 0.0, 1.0) : 0.0;
  return (p - a - t * chord).norm();
}

/// In space, from S(uv) to the image of the coedge's (u,v) polyline: best of some samples, then ternary search beside
/// it.
double distance_to_pieces(const CadFace& face, const Coedge& coedge, const Vec2& at) {
  const std::vector<Vec2>& line = coedge.polyline;
  std::size_t nearest = 0;
  for (std::size_t i = 1; i + 1 < line.size(); ++i)
    if (distance_to_segment(at, line[i], line[i + 1]) < distance_to_segment(at, line[nearest], line[nearest + 1]))
      nearest = i;
  const Vec3 p = face.surface->point(at[0], at[1]);
  const auto off = [&](double t) {
    const Vec2 uv = line[nearest] + (line[nearest + 1] - line[nearest]) * t;
    return (face.surface->point(uv[0], uv[1]) - p).norm();
  };
  int best = 0;
  for (int k = 1; k <= 16; ++k)
    if (off(k / 16.0) < off(best / 16.0)) best = k;
  double low = std::max(best - 1, 0) / 16.0, high = std::min(best + 1, 16) / 16.0;
  for (int k = 0; k < 40; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    off(a) < off(b) ? high = b : low = a;
  }
  return off(0.5 * (low + high));
}

void check_consistent(const CadModel& model) {
  std::vector<std::vector<int>> uses(model.edges.size());
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const CadFace& face = model.faces[f];
    CAPTURE(face.index);
    CHECK(face.area > 0);
    int outer = 0;
    for (const TrimLoop& loop : face.loops) {
      outer += loop.outer;
      REQUIRE(!loop.coedges.empty());
      for (std::size_t i = 0; i < loop.coedges.size(); ++i) {
        const Coedge& coedge = loop.coedges[i];
        const CadEdge& edge = model.edges.at(static_cast<std::size_t>(coedge.edge));
        uses[static_cast<std::size_t>(coedge.edge)].push_back(static_cast<int>(f));
        REQUIRE(coedge.polyline.size() >= 2);
        const Vec2 start = coedge.pcurve->point(coedge.reversed ? coedge.last : coedge.first);
        CHECK((coedge.polyline.front() - start).norm() == 0);
        // Ends of the parameter curve lie on the vertices.
        const int vertex = coedge.reversed ? edge.end_vertex : edge.start_vertex;
        if (vertex < 0) continue;
        const double off =
            (face.surface->point(start[0], start[1]) - model.vertices.at(static_cast<std::size_t>(vertex))).norm();
        CHECK(off < 1e-5 * model.diagonal + 3 * edge.tolerance);
        for (const Vec2& uv : coedge.polyline) {
          CHECK(uv[0] >= face.u_min);
          CHECK(uv[0] <= face.u_max);
          CHECK(uv[1] >= face.v_min);
          CHECK(uv[1] <= face.v_max);
        }
      }
    }
    CHECK(outer == 1);
  }
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    std::sort(uses[e].begin(), uses[e].end());
    std::vector<int> said = model.edges[e].faces;
    std::sort(said.begin(), said.end());
    CHECK(said == uses[e]);
    if (!said.empty()) CHECK((model.edges[e].polyline.size() == 1) == model.edges[e].degenerate);
  }
}

void check_topology_of_tessellation(const CadModel& model) {
  Context context;
  const Tessellation t = tessellate(model, model.diagonal * 1e-3, 0.3, context);
  const SurfaceTopology mesh = topology(t.triangles, t.neighbors);
  const CadTopology cad = cad_topology(model);
  CHECK(cad.components == mesh.components);
  CHECK(cad.loops == mesh.loops);
  CHECK(cad.euler == mesh.euler);
}

/// Two boxes that share a face, with that face between them once.
TopoDS_Shape joined(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  BOPAlgo_Builder builder;
  builder.AddArgument(a);
  builder.AddArgument(b);
  builder.Perform();
  return builder.Shape();
}

}  // namespace

TEST_CASE("make_cad_model: solids have their area, outward faces, closed edges and Euler characteristic") {
  for (const KnownSolid& solid : test::known_solids()) {
    CAPTURE(solid.name);
    const CadModel model = make_cad_model(make_shape(solid.shape));
    REQUIRE(static_cast<int>(model.faces.size()) == solid.faces);
    CHECK(model.unusable_faces.empty());
    CHECK(model.warnings.empty());
    CHECK(total_area(model) == doctest::Approx(solid.area).epsilon(1e-7));
    check_consistent(model);
    for (const CadEdge& edge : model.edges) CHECK(edge.faces.size() == (edge.degenerate ? 1 : 2));
    const CadTopology topology = cad_topology(model);
    CHECK(topology.components == 1);
    CHECK(topology.loops == 0);
    CHECK(topology.euler == solid.euler);
    CHECK(topology.incoherent_edges == 0);
    check_topology_of_tessellation(model);
    CHECK(volume(model) > 0);
    CHECK(volume(make_cad_model(make_shape(solid.shape.Reversed()))) < 0);
  }
}

TEST_CASE("make_cad_model: a box has 12 edges between two faces each, 8 vertices and planes that look outward") {
  const CadModel model = make_cad_model(make_shape(BRepPrimAPI_MakeBox(20, 30, 10).Shape()));
  CHECK(model.edges.size() == 12);
  CHECK(model.vertices.size() == 8);
  CHECK((model.box_min - Vec3(0, 0, 0)).norm() < 1e-12);
  CHECK((model.box_max - Vec3(20, 30, 10)).norm() < 1e-12);
  for (const CadFace& face : model.faces) {
    const Vec2 uv = inner_point(face);
    CHECK(((face.surface->point(uv[0], uv[1]) - Vec3(10, 15, 5)) | outward(face, uv)) > 0);
    CHECK(face.surface_type == "plane");
    CHECK(face.shell == 0);
  }
}

TEST_CASE("make_cad_model: the loops wind once around the material and nothing else, as OpenCASCADE classifies") {
  std::vector<TopoDS_Shape> shapes;
  for (const KnownSolid& solid : test::known_solids()) shapes.push_back(solid.shape);
  for (const char* name : {"bracket", "housing"}) shapes.push_back(occt(example_part(name)));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-0.05, 1.05);
  for (const TopoDS_Shape& shape : shapes) {
    const CadModel model = make_cad_model(make_shape(shape));
    const std::vector<TopoDS_Face> faces = test::faces_of(occt(model.shape));
    for (const CadFace& face : model.faces) {
      CAPTURE(face.index);
      int different = 0;
      for (int i = 0; i < 25; ++i) {
        const Vec2 uv(face.u_min + unit(random) * (face.u_max - face.u_min),
                      face.v_min + unit(random) * (face.v_max - face.v_min));
        BRepClass_FaceClassifier classifier(faces[static_cast<std::size_t>(face.shape_face) - 1],
                                            gp_Pnt2d(uv[0], uv[1]), 1e-4);
        if (classifier.State() == TopAbs_ON) continue;
        different += (classifier.State() == TopAbs_IN) != (winding(face, uv) == 1);
        CHECK((winding(face, uv) == 0 || winding(face, uv) == 1));
      }
      CHECK(different == 0);
    }
  }
}

TEST_CASE("make_cad_model: polylines follow their curves within 1e-5 of the diagonal, in space") {
  for (const char* name : {"blade", "elbow", "sphere-cap"}) {
    CAPTURE(name);
    const CadModel model = make_cad_model(example_part(name));
    double worst_uv = 0, worst_space = 0;
    for (const CadFace& face : model.faces)
      for (const TrimLoop& loop : face.loops)
        for (const Coedge& coedge : loop.coedges) {
          const std::vector<Vec3>& edge = model.edges[static_cast<std::size_t>(coedge.edge)].polyline;
          for (int k = 0; k <= 30; ++k) {
            const Vec2 uv = coedge.pcurve->point(coedge.first + (coedge.last - coedge.first) * k / 30);
            const Vec3 p = face.surface->point(uv[0], uv[1]);
            double to_edge = edge.size() == 1 ? (p - edge[0]).norm() : 1e300;
            for (std::size_t i = 0; i + 1 < edge.size(); ++i)
              to_edge = std::min(to_edge, distance_to_segment(p, edge[i], edge[i + 1]));
            worst_uv = std::max(worst_uv, distance_to_pieces(face, coedge, uv));
            worst_space = std::max(worst_space, to_edge - model.edges[static_cast<std::size_t>(coedge.edge)].tolerance);
          }
        }
    CHECK(worst_uv < 1.1e-5 * model.diagonal);
    CHECK(worst_space < 1.1e-5 * model.diagonal);
  }
}

TEST_CASE("make_cad_model: instances of one solid are parts of their own, each in its place") {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 2, 3).Shape();
  gp_Trsf shift;
  shift.SetTranslation(gp_Vec(10, 0, 0));
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  builder.Add(compound, box);
  builder.Add(compound, box.Moved(shift));
  const CadModel model = make_cad_model(make_shape(compound));
  CHECK(model.faces.size() == 12);
  CHECK(model.vertices.size() == 16);
  CHECK((model.box_max - Vec3(11, 2, 3)).norm() < 1e-12);
  CHECK(cad_topology(model).components == 2);
  for (const CadFace& face : model.faces) {
    CHECK(face.shell == (face.index > 6 ? 1 : 0));
    const Vec2 uv = inner_point(face);
    const Vec3 center(face.shell == 1 ? 10.5 : 0.5, 1, 1.5);
    CHECK(((face.surface->point(uv[0], uv[1]) - center) | outward(face, uv)) > 0);
  }
}

TEST_CASE("make_cad_model: the box is tight where faces bulge out between their edges") {
  const CadModel sphere = make_cad_model(make_shape(BRepPrimAPI_MakeSphere(gp_Pnt(1, 2, 3), 7).Shape()));
  CHECK((sphere.box_min - Vec3(-6, -5, -4)).norm() < 1e-6);
  CHECK((sphere.box_max - Vec3(8, 9, 10)).norm() < 1e-6);
  gp_Trsf tilt;
  tilt.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 0.5)), 0.7);
  const TopoDS_Shape torus = BRepBuilderAPI_Transform(BRepPrimAPI_MakeTorus(10, 3).Shape(), tilt, true).Shape();
  const CadModel model = make_cad_model(make_shape(torus));
  gp_Dir axis(0, 0, 1);
  axis.Transform(tilt);
  for (int k = 0; k < 3; ++k) {
    const double a = k == 0 ? axis.X() : k == 1 ? axis.Y() : axis.Z();
    const double reach = 10 * std::sqrt(1 - a * a) + 3;  // a circle of radius 10 seen aslant, thickened by 3
    CHECK(model.box_max[k] == doctest::Approx(reach).epsilon(1e-6));
    CHECK(model.box_min[k] == doctest::Approx(-reach).epsilon(1e-6));
  }
}

TEST_CASE("make_cad_model: loose faces are sewn, keep the index they were read with and look the same way round") {
  for (const KnownSolid& solid : test::known_solids()) {
    CAPTURE(solid.name);
    const TopoDS_Compound loose = test::loose_faces(solid.shape);
    const CadModel model = make_cad_model(make_shape(loose));
    REQUIRE(static_cast<int>(model.faces.size()) == solid.faces);
    check_consistent(model);
    const CadTopology topology = cad_topology(model);
    CHECK(topology.components == 1);
    CHECK(topology.loops == 0);
    CHECK(topology.euler == solid.euler);
    CHECK(topology.incoherent_edges == 0);
    check_topology_of_tessellation(model);
    const std::vector<TopoDS_Face> read = test::faces_of(loose);
    for (const CadFace& face : model.faces) {
      const Vec2 uv = inner_point(face);
      const gp_Pnt p = BRep_Tool::Surface(read.at(static_cast<std::size_t>(face.index) - 1))->Value(uv[0], uv[1]);
      CHECK((face.surface->point(uv[0], uv[1]) - Vec3(p.X(), p.Y(), p.Z())).norm() < 1e-9);
    }
  }
}

TEST_CASE("make_cad_model: faces farther apart than the sewing tolerance stay apart") {
  gp_Trsf shift;
  shift.SetTranslation(gp_Vec(0, 0, 0.1));
  std::vector<TopoDS_Face> faces = test::faces_of(BRepPrimAPI_MakeBox(20, 30, 10).Shape());
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const TopoDS_Shape copy = BRepBuilderAPI_Copy(faces[i]).Shape();
    builder.Add(compound, i + 1 == faces.size() ? BRepBuilderAPI_Transform(copy, shift, true).Shape() : copy);  // the
                                                                                                                // lid
  }
  const CadTopology apart = cad_topology(make_cad_model(make_shape(compound), 0.01));
  CHECK(apart.components == 2);
  CHECK(apart.loops == 2);
  CHECK(apart.free_edges == 8);
  CHECK(cad_topology(make_cad_model(make_shape(compound), 0.2)).free_edges == 0);
}

TEST_CASE("make_cad_model: an open shell has the loops of its free edges") {
  const std::vector<TopoDS_Face> faces = test::faces_of(test::box_with_hole());
  for (std::size_t left_out = 0; left_out < faces.size(); ++left_out) {
    CAPTURE(left_out);
    BRep_Builder builder;
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (i != left_out) builder.Add(shell, faces[i]);
    const CadModel model = make_cad_model(make_shape(shell));
    const CadTopology topology = cad_topology(model);
    CHECK(topology.components == 1);
    // A side wall leaves one loop; a face with a hole or the bore leave two.
    const bool side =
        faces.size() == 7 && BRep_Tool::Surface(faces[left_out])->IsKind(STANDARD_TYPE(Geom_Plane)) && [&] {
          int wires = 0;
          for (TopExp_Explorer it(faces[left_out], TopAbs_WIRE); it.More(); it.Next()) ++wires;
          return wires == 1;
        }();
    CHECK(topology.loops == (side ? 1 : 2));
    check_topology_of_tessellation(model);
  }
}

TEST_CASE("make_cad_model: edges of three faces are told, and the topology is that of the surface cut open there") {
  const TopoDS_Shape a = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 10, 10, 10).Shape();
  const CadModel wall =
      make_cad_model(make_shape(joined(a, BRepPrimAPI_MakeBox(gp_Pnt(10, 0, 0), 10, 10, 10).Shape())));
  CHECK(wall.faces.size() == 11);
  CHECK(cad_topology(wall).nonmanifold_edges == 4);
  check_topology_of_tessellation(wall);
  const CadModel corner =
      make_cad_model(make_shape(joined(a, BRepPrimAPI_MakeBox(gp_Pnt(10, 10, 10), 5, 5, 5).Shape())));
  CHECK(corner.faces.size() == 12);
  const CadTopology topology = cad_topology(corner);
  CHECK(topology.nonmanifold_vertices == 1);
  CHECK(topology.components == 2);
  CHECK(topology.euler == 4);
  check_topology_of_tessellation(corner);
}

TEST_CASE("make_cad_model: a face without wires gets its natural bounds; an infinite one is named as unusable") {
  BRep_Builder builder;
  TopoDS_Face whole, endless;
  builder.MakeFace(whole, new Geom_SphericalSurface(gp_Ax3(), 5), 1e-7);
  builder.MakeFace(endless, new Geom_Plane(gp_Ax3()), 1e-7);
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  builder.Add(compound, endless);
  builder.Add(compound, whole);
  const CadModel model = make_cad_model(make_shape(compound));
  REQUIRE(model.faces.size() == 1);
  CHECK(model.faces[0].index == 2);
  CHECK(model.faces[0].area == doctest::Approx(100 * std::numbers::pi).epsilon(1e-7));
  REQUIRE(model.unusable_faces.size() == 1);
  CHECK(model.unusable_faces[0].index == 1);
  CHECK(!model.unusable_faces[0].reason.empty());
  TopoDS_Compound hopeless;
  builder.MakeCompound(hopeless);
  builder.Add(hopeless, endless);
  CHECK_THROWS_WITH_AS(make_cad_model(make_shape(hopeless)), doctest::Contains("face 1"), CadError);
}

TEST_CASE("make_cad_model: missing parameter curves are made, and the shape as read is not touched") {
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(5, 12).Shape();
  TopoDS_Face side;
  for (const TopoDS_Face& face : test::faces_of(cylinder))
    if (BRep_Tool::Surface(face)->IsKind(STANDARD_TYPE(Geom_CylindricalSurface))) side = face;
  TopoDS_Edge rim;
  for (TopExp_Explorer it(side, TopAbs_EDGE); it.More(); it.Next())
    if (!BRep_Tool::IsClosed(TopoDS::Edge(it.Current()), side)) rim = TopoDS::Edge(it.Current());
  REQUIRE(!rim.IsNull());
  BRep_Builder().UpdateEdge(rim, Handle(Geom2d_Curve)(), side, 1e-7);
  double first, last;
  REQUIRE(BRep_Tool::CurveOnSurface(rim, side, first, last).IsNull());
  const CadModel model = make_cad_model(make_shape(cylinder));
  CHECK(model.faces.size() == 3);
  CHECK(total_area(model) == doctest::Approx(2 * std::numbers::pi * 5 * 17).epsilon(1e-6));
  check_topology_of_tessellation(model);
  CHECK(BRep_Tool::CurveOnSurface(rim, side, first, last).IsNull());
  TopLoc_Location location;
  CHECK(BRep_Tool::Triangulation(side, location).IsNull());
}

TEST_CASE("make_cad_model: a closed face without its seam, or without its pole, is repaired and said") {
  using std::numbers::pi;
  BRep_Builder builder;
  const auto circle = [](double radius, double height) {
    return BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(gp_Pnt(0, 0, height), gp_Dir(0, 0, 1)), radius)).Edge();
  };
  const auto wire_of = [&](const TopoDS_Shape& edge) {
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    builder.Add(wire, edge);
    return wire;
  };
  const auto shell_of = [&](const TopoDS_Face& face) {
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    builder.Add(shell, face);
    return make_shape(shell);
  };
  TopoDS_Face tube;
  builder.MakeFace(tube, new Geom_CylindricalSurface(gp_Ax3(), 5), 1e-7);
  builder.Add(tube, wire_of(circle(5, 0)));
  builder.Add(tube, wire_of(circle(5, 12).Reversed()));
  const CadModel cylinder = make_cad_model(shell_of(tube));
  REQUIRE(cylinder.faces.size() == 1);
  CHECK(cylinder.warnings.size() == 1);
  CHECK(cylinder.faces[0].area == doctest::Approx(2 * pi * 5 * 12).epsilon(1e-6));
  CHECK(cad_topology(cylinder).loops == 2);
  check_topology_of_tessellation(cylinder);

  TopoDS_Face dome;
  builder.MakeFace(dome, new Geom_SphericalSurface(gp_Ax3(), 5), 1e-7);
  builder.Add(dome, wire_of(circle(4, 3)));
  const CadModel cap = make_cad_model(shell_of(dome));
  REQUIRE(cap.faces.size() == 1);
  CHECK(cap.warnings.size() == 1);
  CHECK(cap.faces[0].area == doctest::Approx(2 * pi * 5 * 2).epsilon(1e-6));
  CHECK(cad_topology(cap).loops == 1);
  CHECK(cad_topology(cap).euler == 1);
  check_topology_of_tessellation(cap);
}

TEST_CASE("make_cad_model: a parameter curve that leaves its edge is told with the distance") {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(20, 30, 10).Shape();
  const TopoDS_Face face = test::faces_of(box)[2];
  const TopoDS_Edge edge = TopoDS::Edge(TopExp_Explorer(face, TopAbs_EDGE).Current());
  double first, last;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  gp_Pnt2d p;
  gp_Vec2d along;
  curve->D1(first, p, along);
  const gp_Vec2d aside = gp_Vec2d(-along.Y(), along.X()).Normalized() * 0.05;
  BRep_Builder().UpdateEdge(edge, Handle(Geom2d_Curve)::DownCast(curve->Translated(aside)), face, 1e-7);
  const CadModel model = make_cad_model(make_shape(box));
  CHECK(model.faces.size() == 6);
  REQUIRE(model.warnings.size() == 1);
  CHECK(model.warnings[0].find("face 3") == 0);
  CHECK(model.warnings[0].find("0.05 mm") != std::string::npos);
}

TEST_CASE("make_cad_model: a face without area is named") {
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  builder.Add(compound, BRepBuilderAPI_MakeFace(gp_Pln(), 0, 10, 0, 10).Face());
  // Out along a line and back along the same line.
  const TopoDS_Edge out = BRepBuilderAPI_MakeEdge(gp_Pnt(20, 0, 0), gp_Pnt(30, 0, 0)).Edge();
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  builder.Add(wire, out);
  builder.Add(wire, out.Reversed());
  TopoDS_Face sliver;
  builder.MakeFace(sliver, new Geom_Plane(gp_Ax3()), 1e-7);
  builder.Add(sliver, wire);
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  builder.Add(shell, sliver);
  builder.Add(compound, shell);  // one shell: nothing is sewn
  const CadModel model = make_cad_model(make_shape(compound));
  CHECK(model.faces.size() == 1);
  REQUIRE(model.unusable_faces.size() == 1);
  CHECK(model.unusable_faces[0].reason.find("area") != std::string::npos);
}

TEST_CASE("make_cad_model: refuses an empty shape and a tolerance that is not positive") {
  CHECK_THROWS_AS(make_cad_model(Shape()), InvalidInput);
  const Shape box = make_shape(BRepPrimAPI_MakeBox(1, 1, 1).Shape());
  CHECK_THROWS_AS(make_cad_model(box, 0), InvalidInput);
  CHECK_THROWS_AS(make_cad_model(box, std::nan("")), InvalidInput);
}

TEST_CASE("make_cad_model: the example parts have the topology they state") {
  for (const ExamplePart& part : example_parts()) {
    CAPTURE(part.name);
    const CadModel model = make_cad_model(example_part(part.name));
    CHECK(static_cast<int>(model.faces.size()) == part.faces);
    check_consistent(model);
    const CadTopology topology = cad_topology(model);
    CHECK(topology.components == part.components);
    CHECK(topology.loops == part.loops);
    CHECK(topology.euler == part.euler);
  }
}

TEST_CASE(
    "make_cad_model: every face of the real files is usable or named, and their topology is that of their meshes") {
  const char* data = std::getenv("TRI_DATA");
  if (!data) return;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "cad")) {
    CAPTURE(entry.path().string());
    Context context;
    const CadFile file = read_cad(entry.path().string(), context);
    CHECK(file.failed.empty());
    const CadModel model = make_cad_model(file.shape);
    CHECK(static_cast<int>(model.faces.size() + model.unusable_faces.size()) == file.faces);
    for (const UnusableFace& face : model.unusable_faces) CHECK(!face.reason.empty());
    check_consistent(model);
    check_topology_of_tessellation(model);
  }
}

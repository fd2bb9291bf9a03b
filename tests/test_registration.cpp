// Closest points on trimmed models: closed forms, OpenCASCADE's own distances, dense samplings.
#include <doctest/doctest.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <gp_Circ.hxx>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/model/trim_region.hpp"
#include "libtri/registration.hpp"
#include "meshops/error.hpp"
#include "points_around.hpp"

namespace {

using namespace tri;
using namespace tri::test;
using std::numbers::pi;

CadModel model_of(const TopoDS_Shape& shape) {
  return make_cad_model(make_shape(shape));
}

std::vector<Foot> feet_of(const CadModel& model, const std::vector<Vec3>& points, int threads = 1) {
  Context context;
  context.threads = threads;
  return Registration(model).register_points(points, context);
}

// What every foot owes, whatever the model.
void check_foot(const CadModel& model, const std::vector<TrimRegion>& regions, const Vec3& p, const Foot& foot) {
  REQUIRE(foot.face >= 0);
  REQUIRE(foot.face < static_cast<int>(model.faces.size()));
  const double scale = model.diagonal + p.norm();
  const CadFace& face = model.faces[foot.face];
  CHECK((face.surface->point(foot.uv[0], foot.uv[1]) - foot.point).norm() <= 1e-11 * scale);
  CHECK(std::abs((foot.point - p).norm() - std::abs(foot.deviation)) <= 1e-12 * scale);
  const Vec3 normal(foot.normal[0], foot.normal[1], foot.normal[2]);
  CHECK(std::abs(normal.norm() - 1) < 1e-5);
  if (foot.edge >= 0) {
    const auto& faces = model.edges[foot.edge].faces;
    CHECK(std::find(faces.begin(), faces.end(), foot.face) != faces.end());
  } else {
    // Inside, or within rounding of the trimming curves (seams and poles are no trimming edges).
    const TrimRegion& r = regions[foot.face];
    const double eu = 1e-9 * (r.u_max() - r.u_min()), ev = 1e-9 * (r.v_max() - r.v_min());
    CHECK(r.classify(foot.uv[0] - eu, foot.uv[0] + eu, foot.uv[1] - ev, foot.uv[1] + ev) != TrimRegion::Side::outside);
    // An inner foot is orthogonal, except on a kink of the surface.
    const SurfacePoint s = face.surface->evaluate(foot.uv[0], foot.uv[1]);
    const Vec3 n = s.du % s.dv;
    if (n.norm() > 1e-9 * s.du.norm() * s.dv.norm() && face.surface->u_breaks().empty() &&
        face.surface->v_breaks().empty())
      CHECK(((p - foot.point) % n.normalized()).norm() <= 1e-6 * scale);
  }
}

void check_feet(const CadModel& model, const std::vector<Vec3>& points, const std::vector<Foot>& feet) {
  std::vector<TrimRegion> regions;
  for (const CadFace& face : model.faces) regions.emplace_back(face);
  REQUIRE(feet.size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) check_foot(model, regions, points[i], feet[i]);
}

// The least distance to a fine grid of the surface's own rectangle is an upper bound that no foot may exceed.
void check_against_samples(const CadModel& model, const std::vector<Vec3>& points, const std::vector<Foot>& feet,
                           int n) {
  REQUIRE(model.faces.size() == 1);
  const CadFace& face = model.faces[0];
  std::vector<Vec3> samples;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      samples.push_back(face.surface->point(face.u_min + (face.u_max - face.u_min) * i / n,
                                            face.v_min + (face.v_max - face.v_min) * j / n));
  for (std::size_t k = 0; k < points.size(); ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& s : samples) least = std::min(least, (s - points[k]).norm());
    CAPTURE(k);
    CHECK(std::abs(feet[k].deviation) <= least + 1e-8 * model.diagonal);
  }
}

Handle(Geom_BSplineSurface) wavy_surface(int multiplicity, bool rational) {
  const int nu = 6 + multiplicity, nv = 7;
  TColgp_Array2OfPnt poles(1, nu, 1, nv);
  TColStd_Array2OfReal weights(1, nu, 1, nv);
  for (int i = 1; i <= nu; ++i)
    for (int j = 1; j <= nv; ++j) {
      poles(i, j) = gp_Pnt(10 * i + 2 * std::sin(3 * j), 12 * j, 8 * std::sin(2.1 * i + j));
      weights(i, j) = rational ? 1 + 0.6 * std::sin(i + 2 * j) : 1;
    }
  TColStd_Array1OfReal uk(1, 4), vk(1, 5);
  TColStd_Array1OfInteger um(1, 4), vm(1, 5);
  for (int i = 1; i <= 4; ++i) {
    uk(i) = i * 0.5;
    um(i) = i == 1 || i == 4 ? 4 : i == 2 ? multiplicity : 2;
  }
  for (int i = 1; i <= 5; ++i) {
    vk(i) = i;
    vm(i) = i == 1 || i == 5 ? 4 : 1;
  }
  return new Geom_BSplineSurface(poles, weights, uk, vk, um, vm, 3, 3);
}

}  // namespace

TEST_CASE("registration: the signed distance to a box, its edges and corners is the closed form") {
  const Vec3 low(1, 2, 3), high(31, 22, 13);
  const CadModel model = model_of(BRepPrimAPI_MakeBox(gp_Pnt(1, 2, 3), gp_Pnt(31, 22, 13)).Shape());
  const auto points = random_points(3000, Vec3(-10, -10, -10), Vec3(40, 40, 30), 1);
  const auto feet = feet_of(model, points);
  check_feet(model, points, feet);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3 outside(0, 0, 0);
    double inside = -1e300;
    for (int c = 0; c < 3; ++c) {
      const double d = std::max(low[c] - points[i][c], points[i][c] - high[c]);
      outside[c] = std::max(0.0, d);
      inside = std::max(inside, d);
    }
    const double expected = outside.norm() > 0 ? outside.norm() : inside;
    CHECK(feet[i].deviation == doctest::Approx(expected).epsilon(1e-12));
    const int beyond = (outside[0] > 0) + (outside[1] > 0) + (outside[2] > 0);
    CHECK((feet[i].edge >= 0) == (beyond >= 2));
  }
}

TEST_CASE("registration: sphere, cylinder and torus give their closed forms on the seam, at poles and at the centre") {
  SUBCASE("sphere") {
    const CadModel model = model_of(BRepPrimAPI_MakeSphere(gp_Pnt(1, 2, 3), 5).Shape());
    const Vec3 center(1, 2, 3);
    auto points = random_points(500, center - Vec3(9, 9, 9), center + Vec3(9, 9, 9), 2);
    points.push_back(center);
    for (const double r : {0.5, 5.0, 8.0})
      for (const double sign : {-1.0, 1.0}) {
        points.push_back(center + Vec3(0, 0, sign * r));        // over a pole
        points.push_back(center + Vec3(r, 0, 0.1 * sign * r));  // over the seam
        points.push_back(center + Vec3(r, sign * 1e-14, 0));    // on either side of it
        points.push_back(center + Vec3(1e-12, 0, sign * r));    // beside a pole
      }
    const auto feet = feet_of(model, points);
    check_feet(model, points, feet);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 out = points[i] - center;
      CHECK(feet[i].deviation == doctest::Approx(out.norm() - 5).epsilon(1e-11));
      CHECK(feet[i].edge == -1);
      const Vec3 normal(feet[i].normal[0], feet[i].normal[1], feet[i].normal[2]);
      if (out.norm() > 0.1) CHECK((normal | out.normalized()) > 1 - 1e-5);
    }
  }
  SUBCASE("cylinder") {
    const CadModel model = model_of(BRepPrimAPI_MakeCylinder(4, 10).Shape());
    auto points = random_points(1000, Vec3(-8, -8, -4), Vec3(8, 8, 14), 3);
    for (const double r : {0.0, 1.0, 4.0, 6.0})
      for (const double z : {-2.0, 0.0, 5.0, 10.0, 12.0}) {
        points.push_back(Vec3(r, 0, z));
        points.push_back(Vec3(r, -1e-15, z));
      }
    const auto feet = feet_of(model, points);
    check_feet(model, points, feet);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double dr = std::hypot(points[i][0], points[i][1]) - 4, dz = std::max(-points[i][2], points[i][2] - 10);
      const double expected = dr > 0 && dz > 0 ? std::hypot(dr, dz) : std::max(dr, dz);
      CHECK(feet[i].deviation == doctest::Approx(expected).epsilon(1e-12));
    }
  }
  SUBCASE("torus") {
    const CadModel model = model_of(BRepPrimAPI_MakeTorus(10, 3).Shape());
    auto points = random_points(1000, Vec3(-15, -15, -5), Vec3(15, 15, 5), 4);
    for (const double r : {0.0, 5.0, 10.0, 15.0}) {
      points.push_back(Vec3(r, 0, 0));
      points.push_back(Vec3(r, 0, 2));
    }
    const auto feet = feet_of(model, points);
    check_feet(model, points, feet);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double expected = std::hypot(std::hypot(points[i][0], points[i][1]) - 10, points[i][2]) - 3;
      CHECK(feet[i].deviation == doctest::Approx(expected).epsilon(1e-12));
      CHECK(feet[i].edge == -1);
    }
  }
}

TEST_CASE("registration: over the hole of a plate the foot is on the rim, and beyond the apex of a cone at the apex") {
  const gp_Pln plane(gp_Ax3(gp::XOY()));
  BRepBuilderAPI_MakeFace plate(plane, -20, 20, -10, 10);
  plate.Add(TopoDS::Wire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp::XOY(), 4))).Wire().Reversed()));
  const CadModel model = model_of(plate.Face());
  const auto points = random_points(1000, Vec3(-25, -15, -5), Vec3(25, 15, 5), 5);
  const auto feet = feet_of(model, points);
  check_feet(model, points, feet);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    const double r = std::hypot(p[0], p[1]);
    const double across =
        r < 4 ? 4 - r : std::hypot(std::max(0.0, std::abs(p[0]) - 20), std::max(0.0, std::abs(p[1]) - 10));
    CHECK(std::abs(feet[i].deviation) == doctest::Approx(std::hypot(across, p[2])).epsilon(1e-12));
    CHECK((feet[i].edge >= 0) == (across > 0));
  }

  const CadModel cone = model_of(BRepPrimAPI_MakeCone(5, 0, 10).Shape());
  const std::vector<Vec3> above{{0, 0, 12}, {0.3, 0.1, 13}, {0, 0, 10}};
  const auto tips = feet_of(cone, above);
  check_feet(cone, above, tips);
  for (std::size_t i = 0; i < above.size(); ++i) {
    CHECK(tips[i].deviation == doctest::Approx((above[i] - Vec3(0, 0, 10)).norm()).epsilon(1e-9));
    CHECK((tips[i].point - Vec3(0, 0, 10)).norm() < 1e-9);
  }
}

TEST_CASE("registration: the sign tells inside from outside of solids, at edges and corners too") {
  for (const char* part : {"bracket", "housing"}) {
    CAPTURE(part);
    const CadModel model = make_cad_model(example_part(part));
    const auto points = points_around(model, 300, 8);
    const auto feet = feet_of(model, points);
    TopExp_Explorer solid(occt(model.shape), TopAbs_SOLID);
    REQUIRE(solid.More());
    BRepClass3d_SolidClassifier classifier(solid.Current());
    for (std::size_t i = 0; i < points.size(); ++i) {
      classifier.Perform(gp_Pnt(points[i][0], points[i][1], points[i][2]), 1e-7);
      if (classifier.State() != TopAbs_IN && classifier.State() != TopAbs_OUT) continue;
      CAPTURE(i);
      CHECK((feet[i].deviation < 0) == (classifier.State() == TopAbs_IN));
    }
  }
}

TEST_CASE("registration: spline, swept, kinked and offset faces hold against dense samplings, near and far") {
  TColgp_Array1OfPnt poles(1, 5);
  for (int i = 1; i <= 5; ++i) poles(i) = gp_Pnt(20 + 6 * std::sin(2 * i), 3 * i % 4, 9 * i);
  const Handle(Geom_BezierCurve) profile = new Geom_BezierCurve(poles);
  const Handle(Geom_Surface) surfaces[] = {wavy_surface(1, false),
                                           wavy_surface(1, true),
                                           wavy_surface(3, false),  // a kink across the face
                                           new Geom_SurfaceOfRevolution(profile, gp::OZ()),
                                           new Geom_SurfaceOfLinearExtrusion(profile, gp_Dir(0.2, 1, 0.1)),
                                           new Geom_OffsetSurface(wavy_surface(1, false), 1.5),
                                           new Geom_OffsetSurface(new Geom_SurfaceOfRevolution(profile, gp::OZ()), -2)};
  for (const auto& surface : surfaces) {
    double u0, u1, v0, v1;
    surface->Bounds(u0, u1, v0, v1);
    if (Precision::IsInfinite(v0)) {
      v0 = -20;
      v1 = 30;
    }
    const std::string type = surface->DynamicType()->Name();
    CAPTURE(type);
    const CadModel model = model_of(BRepBuilderAPI_MakeFace(surface, u0, u1, v0, v1, 1e-7).Face());
    auto points = points_around(model, 60, 9);
    for (const Vec3& p : points_near(model, 60, 0.02 * model.diagonal, 10)) points.push_back(p);
    for (const Vec3& p : random_points(5, Vec3(-1, -1, -1) * 1e4, Vec3(1, 1, 1) * 1e4, 11)) points.push_back(p);
    const auto feet = feet_of(model, points);
    check_feet(model, points, feet);
    check_against_samples(model, points, feet, 250);
  }
}

TEST_CASE("registration: points on a shared edge go to the face with the lower index") {
  const CadModel model = model_of(BRepPrimAPI_MakeBox(10., 10., 10.).Shape());
  std::vector<Vec3> points;
  for (const CadEdge& edge : model.edges)
    for (int i = 1; i < 20; ++i)
      points.push_back(edge.polyline.front() + (edge.polyline.back() - edge.polyline.front()) * (i / 20.0));
  const auto feet = feet_of(model, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    REQUIRE(feet[i].edge >= 0);
    const auto& faces = model.edges[feet[i].edge].faces;
    CHECK(feet[i].face == *std::min_element(faces.begin(), faces.end()));
    CHECK(feet[i].edge == static_cast<int>(i / 19));
  }
}

TEST_CASE(
    "registration: the same result, bit for bit, for any number of threads; points that are not finite have no face") {
  const CadModel model = make_cad_model(example_part("housing"));
  auto points = points_near(model, 20000, 0.5, 12);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  points[7] = Vec3(nan, 0, 0);
  points[8] = Vec3(0, std::numeric_limits<double>::infinity(), 0);
  const auto one = feet_of(model, points, 1), three = feet_of(model, points, 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(one[i].face == three[i].face);
    CHECK(one[i].edge == three[i].edge);
    CHECK(one[i].uv == three[i].uv);
    CHECK(one[i].point == three[i].point);
    CHECK(one[i].deviation == three[i].deviation);
  }
  CHECK(one[7].face == -1);
  CHECK(one[8].face == -1);
  CHECK(one[9].face >= 0);
}

TEST_CASE("registration: finite points at any distance have a foot") {
  const CadModel model = model_of(BRepPrimAPI_MakeBox(10., 10., 10.).Shape());
  const std::vector<Vec3> points{{1e6, 5, 5}, {-1e12, 5, 5}, {5, 1e25, 5}, {5, 5, -1e60}};
  const auto feet = feet_of(model, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    REQUIRE(feet[i].face >= 0);
    CHECK(std::abs(feet[i].deviation) == doctest::Approx(points[i].norm()).epsilon(1e-4));
  }
}

TEST_CASE("registration: cancel stops it, progress runs from 0 to 1") {
  const CadModel model = model_of(BRepPrimAPI_MakeSphere(5).Shape());
  const auto points = random_points(50000, Vec3(-9, -9, -9), Vec3(9, 9, 9), 13);
  Context context;
  double last = -1;
  context.on_progress = [&](std::string_view, double share) {
    CHECK(share >= last);
    last = share;
  };
  const Registration registration(model);
  CHECK(registration.register_points(points, context).size() == points.size());
  CHECK(last == 1);
  context.cancel();
  CHECK_THROWS_AS(registration.register_points(points, context), Cancelled);
}

TEST_CASE("registration: reading a model and indexing it report progress and stop at every checkpoint when cancelled") {
  const Shape shape = example_part("fillet-block");
  const auto run = [&](Context& context) { return Registration(make_cad_model(shape, 0.01, context), context); };
  std::map<std::string, double> last;
  std::atomic<int> checkpoints{0};
  Context context;
  context.threads = 1;
  context.on_progress = [&](std::string_view step, double share) {
    double& before = last.try_emplace(std::string(step), 0).first->second;
    CHECK(share >= before);
    before = share;
  };
  context.on_checkpoint = [&] { ++checkpoints; };
  const Registration registration = run(context);
  CHECK(last.at("read faces") == 1);
  CHECK(last.at("index model") == 1);
  const int all = checkpoints;
  REQUIRE(all > 100);
  for (const int stop : {1, 2, all / 2, all - 1, all}) {
    CAPTURE(stop);
    Context cancelled;
    cancelled.threads = 1;
    int reached = 0;
    cancelled.on_checkpoint = [&] {
      if (++reached == stop) cancelled.cancel();
    };
    CHECK_THROWS_AS(run(cancelled), Cancelled);
    CHECK(reached <= stop + 1);
  }
}

TEST_CASE("registration: no points, no feet") {
  CHECK(feet_of(model_of(BRepPrimAPI_MakeSphere(5).Shape()), {}).empty());
}

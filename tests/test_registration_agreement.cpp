// Registration against OpenCASCADE's distance from a vertex to the faces, and against itself in another order.
#include <doctest/doctest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numeric>
#include <random>

#include "io/cad/cad_file.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/registration.hpp"
#include "points_around.hpp"

namespace {

using namespace tri;
using namespace tri::test;

gp_Pnt to_occt(const Vec3& p) {
  return {p[0], p[1], p[2]};
}

// On the model, off it up to a tenth of its size, close to edges and corners, anywhere in its box, in and over holes.
std::vector<Vec3> everywhere(const CadModel& model, int n, unsigned seed) {
  std::vector<Vec3> points = points_near(model, n / 6, 0, seed);
  for (const Vec3& p : points_near(model, n / 6, 0.1 * model.diagonal, seed + 1)) points.push_back(p);
  for (const Vec3& p : points_around(model, n / 6, seed + 2)) points.push_back(p);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  const auto beside = [&](const Vec3& p) {
    Vec3 away;
    do {
      for (int c = 0; c < 3; ++c) away[c] = 2 * share(random) - 1;
    } while (!(away.norm() > 0.1));
    points.push_back(p + away.normalized() * (model.diagonal * std::pow(10, -6 + 4.5 * share(random))));
  };
  for (int i = 0; i < n / 6; ++i) {
    const CadEdge& edge = model.edges[random() % model.edges.size()];
    if (!edge.faces.empty() && !edge.polyline.empty()) beside(edge.polyline[random() % edge.polyline.size()]);
    if (!model.vertices.empty()) beside(model.vertices[random() % model.vertices.size()]);
  }
  for (const CadFace& face : model.faces) {
    for (const TrimLoop& loop : face.loops) {
      if (loop.outer) continue;
      Vec3 center(0, 0, 0);
      double count = 0;
      for (const Coedge& coedge : loop.coedges)
        for (const Vec2& uv : coedge.polyline) center += face.surface->point(uv[0], uv[1]), ++count;
      if (static_cast<int>(points.size()) < 2 * n) beside(center / count);
    }
  }
  return points;
}

// The distance to the nearest of the faces, as OpenCASCADE has it. A face whose box is farther away than a known
// distance is not asked.
class OcctDistance {
 public:
  OcctDistance(const TopoDS_Shape& shape, const CadModel& model) {
    TopExp::MapShapes(shape, TopAbs_FACE, shapes_);
    for (const CadFace& face : model.faces) {
      faces_.push_back(TopoDS::Face(shapes_(face.index)));
      boxes_.emplace_back();
      BRepBndLib::Add(faces_.back(), boxes_.back());
      distances_.push_back(std::make_unique<BRepExtrema_DistShapeShape>());
      distances_.back()->SetFlag(Extrema_ExtFlag_MIN);
      distances_.back()->LoadS2(faces_.back());
    }
  }

  struct Result {
    double value = std::numeric_limits<double>::infinity();
    double tolerance = 0;  // of the edge or vertex that is nearest
    Vec3 at{0, 0, 0};
    std::size_t face = 0;
  };
  Result operator()(const Vec3& p, double known) const {
    Result best;
    Bnd_Box here;
    here.Set(to_occt(p));
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (boxes_[f].Distance(here) > std::min(best.value, known + boxes_[f].GetGap())) continue;
      BRepExtrema_DistShapeShape& d = *distances_[f];
      d.LoadS1(BRepBuilderAPI_MakeVertex(to_occt(p)).Vertex());
      d.Perform();
      if (!d.IsDone() || d.NbSolution() == 0 || d.Value() >= best.value) continue;
      const gp_Pnt at = d.PointOnShape2(1);
      best = {d.Value(), 0, Vec3(at.X(), at.Y(), at.Z()), f};
      if (d.SupportTypeShape2(1) == BRepExtrema_IsOnEdge)
        best.tolerance = BRep_Tool::Tolerance(TopoDS::Edge(d.SupportOnShape2(1)));
      if (d.SupportTypeShape2(1) == BRepExtrema_IsVertex)
        best.tolerance = BRep_Tool::Tolerance(TopoDS::Vertex(d.SupportOnShape2(1)));
    }
    return best;
  }
  const TopoDS_Face& face(std::size_t f) const { return faces_[f]; }

 private:
  TopTools_IndexedMapOfShape shapes_;
  std::vector<TopoDS_Face> faces_;
  std::vector<Bnd_Box> boxes_;
  std::vector<std::unique_ptr<BRepExtrema_DistShapeShape>> distances_;
};

// How far a place is from the nearest edge of a face, beyond that edge's tolerance.
double beyond_edges(const TopoDS_Face& face, const Vec3& place) {
  double least = std::numeric_limits<double>::infinity();
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Current());
    double t0, t1;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, t0, t1);
    for (const TopoDS_Vertex& v : {TopExp::FirstVertex(edge), TopExp::LastVertex(edge)})
      least = std::min(least, BRep_Tool::Pnt(v).Distance(to_occt(place)) - BRep_Tool::Tolerance(v));
    if (curve.IsNull()) continue;
    const GeomAPI_ProjectPointOnCurve projection(to_occt(place), curve, t0, t1);
    if (projection.NbPoints() > 0) least = std::min(least, projection.LowerDistance() - BRep_Tool::Tolerance(edge));
  }
  return least;
}

// In the trimmed domain, or on its edges, by OpenCASCADE's own classification.
bool in_domain(const TopoDS_Face& given, const Vec2& uv, const Vec3& place, double tolerance) {
  const TopoDS_Face face = TopoDS::Face(given.Oriented(TopAbs_FORWARD));
  const BRepAdaptor_Surface surface(face, Standard_False);
  BRepTopAdaptor_FClass2d domain(face, std::max(surface.UResolution(tolerance), surface.VResolution(tolerance)));
  return domain.Perform(gp_Pnt2d(uv[0], uv[1])) != TopAbs_OUT || beyond_edges(face, place) <= tolerance;
}

// The distance agrees, or is smaller and verified: S(u,v) is the foot, and (u,v) in the domain.
void check_agreement(const Shape& shape, int n, unsigned seed) {
  const CadModel model = make_cad_model(shape);
  const std::vector<Vec3> points = everywhere(model, n, seed);
  Context context;
  const std::vector<Foot> feet = Registration(model).register_points(points, context);
  const OcctDistance occt_distance(occt(shape), model);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Foot& foot = feet[i];
    CAPTURE(points[i]);
    REQUIRE(foot.face >= 0);
    const TopoDS_Face& face = occt_distance.face(static_cast<std::size_t>(foot.face));
    const double ours = std::abs(foot.deviation);
    CHECK(BRep_Tool::Surface(face)->Value(foot.uv[0], foot.uv[1]).Distance(to_occt(foot.point)) <=
          1e-9 * model.diagonal);
    CHECK(std::abs((foot.point - points[i]).norm() - ours) <= 1e-9 * model.diagonal);
    const OcctDistance::Result truth = occt_distance(points[i], ours);
    double tolerance = std::max(1e-7 * model.diagonal, truth.tolerance);
    if (foot.edge >= 0) tolerance = std::max(tolerance, model.edges[static_cast<std::size_t>(foot.edge)].tolerance);
    // A place inside a face that is on its edge within the edge's tolerance counts as on the edge.
    if (ours > truth.value + tolerance)
      tolerance += std::max(0.0, -beyond_edges(occt_distance.face(truth.face), truth.at));
    CHECK(ours <= truth.value + tolerance);
    if (i % 10 == 0 || ours < truth.value - tolerance) CHECK(in_domain(face, foot.uv, foot.point, tolerance));
  }
}

// Where edges meet, along them, and half-way between faces.
std::vector<Vec3> tied_points(const CadModel& model) {
  std::vector<Vec3> points = model.vertices;
  for (const CadEdge& edge : model.edges) {
    if (edge.polyline.size() < 2) continue;
    const CadFace& face = model.faces[static_cast<std::size_t>(edge.faces.at(0))];
    for (const TrimLoop& loop : face.loops)
      for (const Coedge& coedge : loop.coedges)
        if (&model.edges[static_cast<std::size_t>(coedge.edge)] == &edge)
          for (int k = 0; k <= 8; ++k) {
            const Vec2 uv = coedge.pcurve->point(coedge.first + (coedge.last - coedge.first) * k / 8);
            points.push_back(face.surface->point(uv[0], uv[1]));
          }
  }
  for (const Vec3& p : model.vertices)
    for (const Vec3& q : model.vertices) points.push_back((p + q) / 2);
  return points;
}

void check_order(const CadModel& model, const std::vector<Vec3>& points) {
  const Registration registration(model);
  Context context;
  context.threads = 1;
  const std::vector<Foot> feet = registration.register_points(points, context);
  const auto same = [&](const Foot& a, const Foot& b) {
    CHECK(a.face == b.face);
    CHECK(a.edge == b.edge);
    CHECK((a.point - b.point).norm() <= 1e-8 * model.diagonal);
    CHECK(std::abs(a.deviation - b.deviation) <= 1e-12 * model.diagonal);
  };
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::mt19937 random(4);
  for (const int threads : {1, 2, 4}) {
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Vec3> shuffled;
    for (const std::size_t i : order) shuffled.push_back(points[i]);
    context.threads = threads;
    const std::vector<Foot> again = registration.register_points(shuffled, context);
    for (std::size_t k = 0; k < order.size(); ++k) same(again[k], feet[order[k]]);
  }
  for (std::size_t i = 0; i < points.size(); i += 7) {
    CAPTURE(i);
    same(registration.register_points({&points[i], 1}, context)[0], feet[i]);
  }
}

}  // namespace

TEST_CASE(
    "registration: agrees with OpenCASCADE's vertex-to-shape distance, or is nearer and verified, on every example "
    "part") {
  for (const char* part : {"sphere-cap", "elbow", "bracket", "housing", "blade", "boot-lid", "fillet-block"}) {
    CAPTURE(part);
    check_agreement(example_part(part), 90, 21);
  }
}

TEST_CASE("registration: agrees with OpenCASCADE's vertex-to-shape distance on real CAD files") {
  const char* folder = std::getenv("TRI_DATA");
  if (!folder) return;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(folder) / "cad")) {
    const std::string path = entry.path().string();
    CAPTURE(path);
    Context context;
    check_agreement(read_cad(path, context).shape, 60, 22);
  }
}

TEST_CASE(
    "registration: ties go to the same face and edge in any order of the points, alone, and on any number of threads") {
  for (const char* part : {"bracket", "housing", "elbow"}) {
    CAPTURE(part);
    const CadModel model = make_cad_model(example_part(part));
    std::vector<Vec3> points = tied_points(model);
    for (const Vec3& p : points_near(model, 500, 0.01 * model.diagonal, 23)) points.push_back(p);
    check_order(model, points);
  }
}

TEST_CASE("registration: a tie of any kind goes to the face of the lowest index") {
  const CadModel model = make_cad_model(make_shape(BRepPrimAPI_MakeBox(gp_Pnt(-5, -5, -5), gp_Pnt(5, 5, 5)).Shape()));
  Context context;
  const auto lowest = [&](const Vec3& p) {
    // The faces of a cube about the origin: the distance of the plane of each, in its own direction.
    double least = std::numeric_limits<double>::infinity();
    std::int32_t face = -1;
    for (std::size_t f = 0; f < model.faces.size(); ++f) {
      const CadFace& one = model.faces[f];
      const Vec3 middle = one.surface->point((one.u_min + one.u_max) / 2, (one.v_min + one.v_max) / 2);
      Vec3 out = p - middle;
      for (int c = 0; c < 3; ++c)
        if (std::abs(middle[c]) < 1) out[c] = std::max(0.0, std::abs(p[c]) - 5);
      if (out.norm() < least - 1e-9) least = out.norm(), face = static_cast<std::int32_t>(f);
    }
    return face;
  };
  std::vector<Vec3> points;
  // The centre, the planes between faces inside, and what lies beyond faces, edges and corners.
  for (const double x : {-8.0, -5.0, -2.0, 0.0, 2.0, 5.0, 8.0})
    for (const double y : {-8.0, -5.0, -2.0, 0.0, 2.0, 5.0, 8.0})
      for (const double z : {-8.0, -5.0, -2.0, 0.0, 2.0, 5.0, 8.0}) points.emplace_back(x, y, z);
  const std::vector<Foot> feet = Registration(model).register_points(points, context);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CAPTURE(points[i]);
    CHECK(feet[i].face == lowest(points[i]));
  }
  check_order(model, points);
}

TEST_CASE("registration: where two solids touch each gets its share of the points, in any order of them") {
  BRep_Builder builder;
  TopoDS_Compound both;
  builder.MakeCompound(both);
  builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(10, 10, 10)).Shape());
  builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 10), gp_Pnt(10, 10, 20)).Shape());
  const CadModel model = make_cad_model(make_shape(both));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(1, 9), noise(-0.1, 0.1);
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i) points.emplace_back(place(random), place(random), 10 + noise(random));
  Context context;
  int lower = 0;
  for (const Foot& foot : Registration(model).register_points(points, context)) {
    CHECK(foot.point[2] == doctest::Approx(10));
    lower += foot.face < 6;
  }
  // Half of them, give or take six standard deviations.
  CHECK(std::abs(lower - 1000) < 135);
  check_order(model, points);
}

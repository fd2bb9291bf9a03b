#include <doctest/doctest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IntCurvesFace_ShapeIntersector.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Lin.hxx>
#include <map>
#include <set>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

constexpr SamplingPattern all_patterns[] = {SamplingPattern::random, SamplingPattern::scan, SamplingPattern::grid};

gp_Pnt to_pnt(const Vec3& p) {
  return {p[0], p[1], p[2]};
}

VirtualMeasurement measured_shape(const Shape& shape, const MeasurementOptions& options) {
  Context context;
  return measure(shape, options, context);
}

const Shape& lid() {
  static const Shape shape = example_part("boot-lid");
  return shape;
}

std::vector<TopoDS_Face> faces_of(const Shape& shape) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(occt(shape), TopAbs_FACE, map);
  std::vector<TopoDS_Face> faces;
  for (int i = 1; i <= map.Extent(); ++i) faces.push_back(TopoDS::Face(map(i)));
  return faces;
}

double shape_distance(const TopoDS_Shape& shape, const Vec3& point) {
  return BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(to_pnt(point)).Vertex(), shape).Value();
}

double face_area(const TopoDS_Face& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties, 1e-6);
  return properties.Mass();
}

double diagonal_of(const std::vector<TruePoint>& truth) {
  Vec3 low = truth[0].point, high = low;
  for (const TruePoint& t : truth) {
    low.minimize(t.point);
    high.maximize(t.point);
  }
  return (high - low).norm();
}

// Chi-square against expected counts, in standard deviations above its mean.
double excess(const std::vector<double>& counts, const std::vector<double>& expected) {
  double chi2 = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) chi2 += std::pow(counts[i] - expected[i], 2) / expected[i];
  const double freedom = double(counts.size()) - 1;
  return (chi2 - freedom) / std::sqrt(2 * freedom);
}

}  // namespace

TEST_CASE("measure: makes exactly as many points as asked for, and says their truth, for every part and pattern") {
  for (const ExamplePart& part : example_parts()) {
    const Shape shape = part.name == "boot-lid" ? lid() : example_part(part.name);
    for (const SamplingPattern pattern : all_patterns) {
      for (const std::uint64_t points : {1, 1234}) {
        CAPTURE(part.name);
        CAPTURE(int(pattern));
        const VirtualMeasurement m =
            measured_shape(shape, {.points = points, .pattern = pattern, .outliers = 0.1, .shuffle = true});
        CHECK(m.points.size() == points);
        CHECK(m.truth.size() == points);
        CHECK(m.unusable_faces.empty());
        for (const TruePoint& t : m.truth) CHECK_UNARY(t.face >= 1 && t.face <= part.faces);
      }
    }
  }
}

TEST_CASE(
    "measure: without noise a point is S(u,v) of its face, within the trimming loops, its normal across the surface") {
  for (const ExamplePart& part : example_parts()) {
    const Shape shape = part.name == "boot-lid" ? lid() : example_part(part.name);
    const std::vector<TopoDS_Face> faces = faces_of(shape);
    for (const SamplingPattern pattern : all_patterns) {
      CAPTURE(part.name);
      CAPTURE(int(pattern));
      const VirtualMeasurement m = measured_shape(shape, {.points = 60, .pattern = pattern});
      for (std::size_t i = 0; i < m.points.size(); ++i) {
        const TruePoint& t = m.truth[i];
        CHECK(m.points[i] == t.point);
        gp_Pnt p;
        gp_Vec du, dv;
        BRepAdaptor_Surface(faces[t.face - 1]).D1(t.uv[0], t.uv[1], p, du, dv);
        CHECK(p.Distance(to_pnt(t.point)) == 0);
        const gp_Vec normal(t.normal[0], t.normal[1], t.normal[2]);
        CHECK(std::abs(normal.Magnitude() - 1) < 1e-12);
        CHECK(std::abs(normal.Dot(du)) < 1e-9 * du.Magnitude());
        CHECK(std::abs(normal.Dot(dv)) < 1e-9 * dv.Magnitude());
        CHECK(shape_distance(faces[t.face - 1], t.point) < 1e-6);
      }
    }
  }
}

TEST_CASE("measure: points go up to round rims and not beyond") {
  // The base of the bracket has two holes of 3.25 mm radius; rings just outside them hold their share of the points.
  constexpr double hole = 3.25, ring = 0.02;
  const VirtualMeasurement m = measured_shape(example_part("bracket"), {.points = 300000});
  double in_ring = 0, on_base = 0;
  for (const TruePoint& t : m.truth) {
    if (std::abs(t.normal[2]) < 0.999 || t.point[2] > 1.5) continue;
    ++on_base;
    const double r = std::hypot(t.point[0] - 14, t.point[1] - 11);
    CHECK_UNARY(r > hole - 1e-9);
    if (r < hole + ring) ++in_ring;
  }
  // Both sides of the base: 47 x 40 mm, less its two rounded corners of 6 mm and the holes.
  const double pi = std::numbers::pi;
  const double base = 2 * (47 * 40 - 2 * (1 - pi / 4) * 36 - 2 * pi * hole * hole);
  const double expected = on_base * 2 * pi * (std::pow(hole + ring, 2) - hole * hole) / base;
  CHECK(std::abs(in_ring - expected) < 5 * std::sqrt(expected));
}

TEST_CASE("measure: random points are uniform over the area, between faces and within a face") {
  for (const char* name : {"boot-lid", "blade", "bracket", "fillet-block"}) {
    CAPTURE(name);
    const Shape shape = std::string(name) == "boot-lid" ? lid() : example_part(name);
    constexpr double n = 200000;
    std::vector<double> expected, counts;
    double total = 0;
    for (const TopoDS_Face& face : faces_of(shape)) total += expected.emplace_back(face_area(face));
    for (double& e : expected) e *= n / total;
    counts.resize(expected.size());
    for (const TruePoint& t : measured_shape(shape, {.points = std::uint64_t(n)}).truth) ++counts[t.face - 1];
    CHECK(excess(counts, expected) < 5);
  }
  // On a sphere heights are uniform [Archimedes]; the cap reaches from half the radius to the pole.
  constexpr int bands = 25;
  constexpr double n = 100000;
  std::vector<double> counts(bands);
  for (const TruePoint& t : measured_shape(example_part("sphere-cap"), {.points = std::uint64_t(n)}).truth) {
    ++counts.at(std::min(bands - 1, int((t.point[2] - 25) / 25 * bands)));
  }
  CHECK(excess(counts, std::vector<double>(bands, n / bands)) < 5);
}

TEST_CASE("measure: closed faces, poles, an apex and a seam are sampled evenly") {
  constexpr int bands = 20;
  constexpr double n = 60000;
  const auto check_uniform = [&](const TopoDS_Shape& shape, const auto& share) {
    std::vector<double> counts(bands);
    double on_face = 0;
    for (const TruePoint& t : measured_shape(make_shape(shape), {.points = std::uint64_t(n)}).truth) {
      const double x = share(t);
      if (x < 0) continue;
      ++on_face;
      ++counts.at(std::min(bands - 1, int(x * bands)));
    }
    REQUIRE(on_face > n / 4);
    CHECK(excess(counts, std::vector<double>(bands, on_face / bands)) < 5);
  };
  const double full = 2 * std::numbers::pi;
  const auto turn = [&](const TruePoint& t) {
    return std::fmod(std::atan2(t.point[1], t.point[0]) + full, full) / full;
  };
  const TopoDS_Shape sphere = BRepPrimAPI_MakeSphere(10).Shape();
  check_uniform(sphere, [](const TruePoint& t) { return (t.point[2] + 10) / 20; });
  check_uniform(sphere, turn);
  // The mantle of a cone with its apex at height 20: the area below the apex grows with the square of the depth.
  const TopoDS_Shape cone = BRepPrimAPI_MakeCone(8, 0, 20).Shape();
  check_uniform(cone, [](const TruePoint& t) { return t.point[2] < 1e-9 ? -1 : std::pow((20 - t.point[2]) / 20, 2); });
  // A torus, by the angle about its tube: its area is R phi + r sin phi.
  const TopoDS_Shape torus = BRepPrimAPI_MakeTorus(10, 4).Shape();
  check_uniform(torus, [&](const TruePoint& t) {
    const double phi = std::fmod(std::atan2(t.point[2], std::hypot(t.point[0], t.point[1]) - 10) + full, full);
    return std::clamp((10 * phi + 4 * std::sin(phi)) / (10 * full), 0.0, 1.0);
  });
}

TEST_CASE("measure: a window across the seam of a cylinder stays empty, in every pattern") {
  // The seam of the cylinder is at +x, where a bore of radius 3 along x leaves a hole.
  const TopoDS_Shape bore = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 20), gp_Dir(1, 0, 0)), 3, 20).Shape();
  const Shape shape = make_shape(BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(10, 40).Shape(), bore).Shape());
  for (const SamplingPattern pattern : all_patterns) {
    CAPTURE(int(pattern));
    int around = 0;
    for (const TruePoint& t : measured_shape(shape, {.points = 30000, .pattern = pattern}).truth) {
      if (std::abs(std::hypot(t.point[0], t.point[1]) - 10) > 1e-9 || t.point[0] < 0) continue;
      const double r = std::hypot(t.point[1], t.point[2] - 20);
      CHECK_UNARY(r > 3 - 1e-6);
      around += r < 4;
    }
    CHECK(around > 20);
  }
}

TEST_CASE("measure: all points may be outliers, and noise comes with every pattern") {
  const Shape shape = example_part("bracket");
  const VirtualMeasurement far = measured_shape(shape, {.points = 200, .noise = 0.1, .outliers = 1});
  for (const TruePoint& t : far.truth) CHECK_UNARY(t.outlier);
  for (const SamplingPattern pattern : all_patterns) {
    const VirtualMeasurement m = measured_shape(shape, {.points = 2000, .pattern = pattern, .noise = 0.1});
    double variance = 0;
    for (std::size_t i = 0; i < m.points.size(); ++i) variance += (m.points[i] - m.truth[i].point).sqrnorm() / 2000;
    CHECK(std::abs(variance / 0.01 - 1) < 5 * std::sqrt(2.0 / 2000));
  }
}

TEST_CASE("measure: a drop-out of no radius leaves nothing out") {
  const Shape shape = example_part("elbow");
  CHECK(measured_shape(shape, {.points = 500, .drop_outs = 3}).points == measured_shape(shape, {.points = 500}).points);
}

TEST_CASE("measure: normals of a solid point outward") {
  const Shape shape = example_part("housing");
  const VirtualMeasurement m = measured_shape(shape, {.points = 200});
  BRepClass3d_SolidClassifier where(occt(shape));
  for (const TruePoint& t : m.truth) {
    where.Perform(to_pnt(t.point + t.normal * 0.01), 1e-6);
    CHECK(where.State() == TopAbs_OUT);
    where.Perform(to_pnt(t.point - t.normal * 0.01), 1e-6);
    CHECK(where.State() == TopAbs_IN);
  }
}

TEST_CASE("measure: noise is Gaussian along the normal with the deviation asked for") {
  constexpr double sigma = 0.05, n = 50000;
  const VirtualMeasurement m = measured_shape(lid(), {.points = std::uint64_t(n), .noise = sigma});
  double mean = 0, variance = 0, beyond = 0;
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    const Vec3 d = m.points[i] - m.truth[i].point;
    const double along = d | m.truth[i].normal;
    CHECK_UNARY((d - m.truth[i].normal * along).norm() < 1e-11);
    mean += along / n;
    variance += along * along / n;
    beyond += std::abs(along) > 2 * sigma ? 1 / n : 0;
  }
  const double tolerance = 5 / std::sqrt(n), tail = std::erfc(std::sqrt(2.0));
  CHECK(std::abs(mean) < tolerance * sigma);
  CHECK(std::abs(variance / (sigma * sigma) - 1) < tolerance * std::sqrt(2.0));
  CHECK(std::abs(beyond - tail) < tolerance * std::sqrt(tail * (1 - tail)));
}

TEST_CASE("measure: the share of outliers is exact; they are 1% to 10% of the diagonal away, the others untouched") {
  const Shape shape = example_part("housing");
  const VirtualMeasurement m = measured_shape(shape, {.points = 5000, .outliers = 0.012});
  const double diagonal = diagonal_of(m.truth);
  const TopoDS_Shape shell = TopExp_Explorer(occt(shape), TopAbs_SHELL).Current();  // of a solid the inside is at
                                                                                    // distance 0
  int outliers = 0;
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    const double moved = (m.points[i] - m.truth[i].point).norm();
    if (!m.truth[i].outlier) {
      CHECK_UNARY(moved == 0);
      continue;
    }
    ++outliers;
    CHECK(moved > 0.0099 * diagonal);
    CHECK(moved < 0.101 * diagonal);
    CHECK(shape_distance(shell, m.points[i]) > 0.0099 * diagonal);
  }
  CHECK(outliers == 60);
}

TEST_CASE("measure: no true point lies in a drop-out, and the number of points is still exact") {
  for (const SamplingPattern pattern : all_patterns) {
    CAPTURE(int(pattern));
    MeasurementOptions options{.points = 4000, .pattern = pattern, .drop_out_radius = 45, .drop_outs = 3};
    options.drop_out_centres = {{100, 250, 20}};
    const VirtualMeasurement m = measured_shape(lid(), options);
    CHECK(m.points.size() == 4000);
    REQUIRE(m.drop_out_centres.size() == 4);
    CHECK(m.drop_out_centres[3] == options.drop_out_centres[0]);
    std::vector<int> around(4);
    for (const TruePoint& t : m.truth) {
      for (int k = 0; k < 4; ++k) {
        const double r = (t.point - m.drop_out_centres[k]).norm();
        CHECK_UNARY(r >= 45);
        around[k] += r < 90;
      }
    }
    for (int k = 0; k < 4; ++k) CHECK(around[k] > 10);
    for (int k = 0; k < 3; ++k) CHECK(shape_distance(occt(lid()), m.drop_out_centres[k]) < 1e-6);
  }
}

TEST_CASE("measure: the seed decides everything, the number of threads nothing") {
  for (const SamplingPattern pattern : all_patterns) {
    const MeasurementOptions options{.points = 3000,
                                     .pattern = pattern,
                                     .noise = 0.1,
                                     .outliers = 0.01,
                                     .drop_out_radius = 30,
                                     .drop_outs = 1,
                                     .move = true,
                                     .shuffle = true,
                                     .seed = 5};
    Context one, four;
    one.threads = 1;
    four.threads = 4;
    const VirtualMeasurement a = measure(lid(), options, one), b = measure(lid(), options, four);
    CHECK(a.points == b.points);
    CHECK(a.to_model == b.to_model);
    CHECK(a.spacing == b.spacing);
    bool same = true;
    for (std::size_t i = 0; i < a.truth.size(); ++i) {
      same = same && a.truth[i].face == b.truth[i].face && a.truth[i].uv == b.truth[i].uv &&
             a.truth[i].outlier == b.truth[i].outlier;
    }
    CHECK(same);
    MeasurementOptions other = options;
    other.seed = 6;
    CHECK(measure(lid(), other, one).points != a.points);
  }
}

TEST_CASE("measure: a view shows what faces it and nothing hidden") {
  const Shape shape = example_part("housing");
  IntCurvesFace_ShapeIntersector rays;
  rays.Load(occt(shape), 1e-7);
  for (const SamplingPattern pattern : all_patterns) {
    CAPTURE(int(pattern));
    const Vec3 view = Vec3(0.4, -0.5, 1).normalize();
    const VirtualMeasurement m = measured_shape(shape, {.points = 300, .pattern = pattern, .views = {view * 3.0}});
    CHECK(m.points.size() == 300);
    for (const TruePoint& t : m.truth) {
      CHECK((t.normal | view) >= std::cos(75 * std::numbers::pi / 180) - 1e-12);
      // The facets stand for the surface, to 1/1000 of the diagonal of 160 mm.
      rays.Perform(gp_Lin(to_pnt(t.point + t.normal * 0.5), gp_Dir(view[0], view[1], view[2])), 0, 1000);
      CHECK(rays.NbPnt() == 0);
    }
  }
  const VirtualMeasurement above = measured_shape(shape, {.points = 5000, .views = {{0, 0, 1}}});
  for (const TruePoint& t : above.truth)
    CHECK_UNARY(t.point[2] > 4.99 || t.point[1] < 0);  // the outside below the floor is hidden
}

TEST_CASE("measure: scan lines are evenly spaced along and between lines") {
  for (const double ratio : {5.0, 20.0}) {
    const VirtualMeasurement m =
        measured_shape(example_part("elbow"), {.points = 20000, .pattern = SamplingPattern::scan, .line_ratio = ratio});
    CHECK(m.line_spacing / m.spacing == doctest::Approx(ratio).epsilon(0.05));
    int even = 0;
    for (std::size_t i = 1; i < m.truth.size(); ++i) {
      even += std::abs((m.truth[i].point - m.truth[i - 1].point).norm() / m.spacing - 1) < 0.03;
    }
    CHECK(even > 0.93 * 20000);
    // The last straight is 50 mm wide and 80 mm long along z; cut across or at 37 degrees to its axis at the flattest,
    // it shows in a slice of one line distance points of some line.
    std::set<int> slices;
    for (const TruePoint& t : m.truth) {
      if (t.face == 5) slices.insert(int(std::floor((t.point[2] - 116) / (1.7 * m.line_spacing))));
    }
    CHECK(int(slices.size()) >= int(80 / (1.7 * m.line_spacing)));
  }
}

TEST_CASE("measure: a grid is regular in the parameters of each face") {
  const VirtualMeasurement m =
      measured_shape(example_part("elbow"), {.points = 5000, .pattern = SamplingPattern::grid});
  std::map<int, std::set<std::pair<double, double>>> places;
  for (const TruePoint& t : m.truth) places[t.face].insert({t.uv[0], t.uv[1]});
  CHECK(places.size() == 5);
  std::size_t all = 0;
  for (const auto& [face, uvs] : places) {
    std::set<double> us, vs;
    for (const auto& [u, v] : uvs) {
      us.insert(u);
      vs.insert(v);
    }
    all += us.size() * vs.size();
    const double step = (*us.rbegin() - *us.begin()) / double(us.size() - 1);
    for (auto a = us.begin(), b = std::next(a); b != us.end(); ++a, ++b) CHECK(*b - *a == doctest::Approx(step));
  }
  CHECK(all >= 5000);
  CHECK(all <= 5051);  // about 1% is left out to make the number exact
}

TEST_CASE("measure: the pose beside a moved measurement takes it back to the model") {
  const VirtualMeasurement m = measured_shape(example_part("blade"), {.points = 500, .move = true});
  const auto& t = m.to_model;
  double moved = 0;
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    Vec3 back;
    for (int r = 0; r < 3; ++r)
      back[r] = t[r][0] * m.points[i][0] + t[r][1] * m.points[i][1] + t[r][2] * m.points[i][2] + t[r][3];
    CHECK((back - m.truth[i].point).norm() < 1e-10);
    moved = std::max(moved, (m.points[i] - m.truth[i].point).norm());
  }
  CHECK(moved > 1);
  const Vec3 a(t[0][0], t[0][1], t[0][2]), b(t[1][0], t[1][1], t[1][2]), c(t[2][0], t[2][1], t[2][2]);
  CHECK(((a % b) - c).norm() < 1e-14);
  CHECK(std::abs(a | b) < 1e-14);
  CHECK(t[3] == std::array<double, 4>{0, 0, 0, 1});
}

TEST_CASE("measure: faces placed by a location or turned inside out are measured where they are") {
  gp_Trsf motion;
  motion.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 0)), 0.7);
  motion.SetTranslationPart(gp_Vec(300, 0, -50));
  const Shape elbow = example_part("elbow");
  TopoDS_Compound both;
  BRep_Builder builder;
  builder.MakeCompound(both);
  builder.Add(both, occt(elbow));
  builder.Add(both, occt(elbow).Moved(TopLoc_Location(motion)).Reversed());
  const Shape shape = make_shape(both);
  const VirtualMeasurement m = measured_shape(shape, {.points = 400});
  const VirtualMeasurement alone = measured_shape(elbow, {.points = 1});
  const std::vector<TopoDS_Face> faces = faces_of(shape);
  REQUIRE(faces.size() == 10);
  int moved = 0;
  const gp_Trsf inverse = motion.Inverted();
  for (const TruePoint& t : m.truth) {
    CHECK(shape_distance(faces[t.face - 1], t.point) < 1e-6);
    // Beyond the ends of the first straight the pipe's axis is y = 0, z = 0: the outside is away from it.
    if (t.face == 1) CHECK(std::hypot(t.point[1] + t.normal[1], t.point[2] + t.normal[2]) > 25.5);
    if (t.face == 6) {
      ++moved;
      const gp_Pnt in = to_pnt(t.point + t.normal).Transformed(inverse);
      CHECK(std::hypot(in.Y(), in.Z()) < 24.5);
    }
  }
  CHECK(moved > 10);
}

TEST_CASE("measure: the shape given stays without a tessellation") {
  const Shape shape = example_part("elbow");
  measured_shape(shape, {.points = 100, .outliers = 0.1});
  TopLoc_Location location;
  for (const TopoDS_Face& face : faces_of(shape)) CHECK(BRep_Tool::Triangulation(face, location).IsNull());
}

TEST_CASE("measure: options out of range, an empty model and nothing to measure are errors") {
  const Shape shape = example_part("elbow");
  const auto refuses = [&](const MeasurementOptions& options) {
    CHECK_THROWS_AS(measured_shape(shape, options), InvalidInput);
  };
  refuses({.points = 0});
  refuses({.line_ratio = 0.5});
  refuses({.noise = -0.1});
  refuses({.noise = std::nan("")});
  refuses({.outliers = 1.5});
  refuses({.drop_out_radius = -1});
  refuses({.drop_outs = -1});
  refuses({.views = {{0, 0, 0}}});
  refuses({.max_angle = 0});
  for (const SamplingPattern pattern : all_patterns) {
    refuses({.pattern = pattern, .drop_out_radius = 1e4, .drop_out_centres = {{0, 0, 0}}});
  }
  CHECK_THROWS_AS(measured_shape(Shape(), {}), CadError);
  CHECK_THROWS_AS(sampling_pattern("spiral"), InvalidInput);
  CHECK(sampling_pattern("scan") == SamplingPattern::scan);
}

TEST_CASE("measure: stops when it is cancelled, before it starts and while it samples") {
  Context cancelled;
  cancelled.cancel();
  CHECK_THROWS_AS(measure(example_part("elbow"), {}, cancelled), Cancelled);
  Context later;
  later.on_progress = [&](std::string_view step, double) {
    if (step == "sample") later.cancel();
  };
  CHECK_THROWS_AS(measure(example_part("elbow"), {}, later), Cancelled);
}

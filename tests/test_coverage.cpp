// clang-format off: OpenMesh does not compile after OpenCASCADE
#include "libtri/triangulation/coverage.hpp"
// clang-format on

#include <doctest/doctest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/triangulation/shell/connect.hpp"
#include "link_check.hpp"
#include "measured_part.hpp"
#include "meshops/error.hpp"
#include "occt_parts.hpp"

using namespace tri;
using std::numbers::pi;

namespace {

constexpr double hole_size = 3;

struct Sampling {
  SamplingPattern pattern;
  std::uint64_t points;
  double line_ratio;
  std::string name;
};
const Sampling samplings[] = {{SamplingPattern::random, 4000, 10, "random"}, {SamplingPattern::scan, 12000, 5, "scan"}};

// A shape, and places on it away from its rims, where gaps may be planted.
struct Ground {
  std::string name;
  Shape shape;
  std::vector<Vec3> places;
};
std::vector<Ground> grounds() {
  return {{"plane", make_shape(BRepBuilderAPI_MakeFace(gp_Pln(), 0, 100, 0, 80).Face()), {{30, 40, 0}, {75, 35, 0}}},
          {"cylinder", make_shape(BRepPrimAPI_MakeCylinder(20, 100).Shape()), {{20, 0, 60}, {0, -20, 45}}}};  // one on
                                                                                                              // the
                                                                                                              // seam
}

struct Covered {
  test::MeasuredPart part;
  PointMesh mesh;
  Coverage coverage;
  double scale = 0;  // mm: spacing of random points, of scan lines
};

MeasurementOptions options_for(const Sampling& s) {
  MeasurementOptions options;
  options.points = s.points;
  options.pattern = s.pattern;
  options.line_ratio = s.line_ratio;
  return options;
}

double scale_of(const VirtualMeasurement& m) {
  return m.line_spacing > 0 ? m.line_spacing : m.spacing;
}

double scale_without_gaps(const Shape& shape, const Sampling& s) {
  Context context;
  return scale_of(measure(shape, options_for(s), context));
}

PointMesh connected(const test::MeasuredPart& part) {
  Context context;
  const Tessellation tessellation = tessellate(part.model, 1e-3 * part.model.diagonal, 0.35, context);
  ShellConnection shell = connect_by_shell(part.model, tessellation, part.feet, context);
  REQUIRE(shell.open_stars == 0);
  return std::move(shell.mesh);
}

Covered covered(const Shape& shape, const MeasurementOptions& options, double size = hole_size) {
  Covered result{test::measured_part(shape, options), {}, {}, 0};
  result.scale = scale_of(result.part.measurement);
  result.mesh = connected(result.part);
  Context context;
  const Registration registration(result.part.model);
  result.coverage = find_unmeasured(result.part.model, registration, result.mesh, result.part.feet, size, context);
  return result;
}

Covered with_gaps(const Shape& shape, const Sampling& s, const std::vector<Vec3>& places, double radius,
                  double size = hole_size) {
  MeasurementOptions options = options_for(s);
  options.drop_out_centres = places;
  options.drop_out_radius = radius;
  return covered(shape, options, size);
}

void check_nothing_open(const Covered& c) {
  CHECK(c.coverage.regions.empty());
  CHECK(c.coverage.open_triangles.empty());
}

double covered_area(const Covered& c, std::uint32_t t) {
  const Triangle& q = c.mesh.triangles[t];
  const Vec3& a = c.part.feet[q[0]].point;
  return 0.5 * ((c.part.feet[q[1]].point - a) % (c.part.feet[q[2]].point - a)).norm();
}

// One hole per region: manifold, every vertex kept, one loop more and one less of Euler's number each.
void check_opened(const Covered& c, long regions) {
  REQUIRE(static_cast<long>(c.coverage.regions.size()) == regions);
  CHECK(std::is_sorted(c.coverage.open_triangles.begin(), c.coverage.open_triangles.end()));
  CHECK(std::is_sorted(c.coverage.regions.begin(), c.coverage.regions.end(),
                       [](const UnmeasuredRegion& a, const UnmeasuredRegion& b) { return a.radius > b.radius; }));
  const test::LinkedTriangles before = test::check_links(c.mesh.triangles, c.mesh.neighbors);
  PointMesh open = c.mesh;
  drop_triangles(open, c.coverage.open_triangles);
  CHECK(open.triangles.size() + c.coverage.open_triangles.size() == c.mesh.triangles.size());
  const test::LinkedTriangles after = test::check_links(open.triangles, open.neighbors);
  CHECK_LINKS(after);
  CHECK((after.vertices == before.vertices));
  CHECK(after.components == before.components);
  CHECK(after.loops == before.loops + regions);
  CHECK(after.euler == before.euler - regions);
}

}  // namespace

TEST_CASE("find_unmeasured: nothing is open where there is no gap") {
  for (const Ground& ground : grounds())
    for (const Sampling& s : samplings) {
      CAPTURE(ground.name);
      CAPTURE(s.name);
      check_nothing_open(covered(ground.shape, options_for(s)));
    }
}

TEST_CASE("find_unmeasured: where scan lines end and crowd, they are as far apart as elsewhere") {
  MeasurementOptions options;
  options.points = 20000;
  options.pattern = SamplingPattern::scan;  // the lines' ends circle the pole, close to each other
  options.seed = 5;
  check_nothing_open(covered(example_part("sphere-cap"), options));
}

TEST_CASE("find_unmeasured: nothing is open on an example part that was measured all over") {
  for (const std::string name : {"boot-lid", "bracket", "elbow"})
    for (const SamplingPattern pattern : {SamplingPattern::random, SamplingPattern::scan}) {
      CAPTURE(name);
      MeasurementOptions options;
      options.points = 10000;
      options.pattern = pattern;
      check_nothing_open(covered(example_part(name), options));
    }
}

TEST_CASE("find_unmeasured: gaps of two spacings are closed, gaps of six are one region each, there and nowhere else") {
  for (const Ground& ground : grounds())
    for (const Sampling& s : samplings) {
      CAPTURE(ground.name);
      CAPTURE(s.name);
      const double scale = scale_without_gaps(ground.shape, s);
      check_nothing_open(with_gaps(ground.shape, s, ground.places, 2 * scale));
      for (const Vec3& place : ground.places) {
        CAPTURE(place);
        const double radius = 6 * scale;
        const Covered c = with_gaps(ground.shape, s, {place}, radius);
        check_opened(c, 1);
        const UnmeasuredRegion& region = c.coverage.regions[0];
        CHECK((region.center - place).norm() < scale);
        CHECK(region.radius > radius - scale);
        CHECK(region.radius < radius + scale);
        CHECK(region.spacing > 0.5 * scale);
        CHECK(region.spacing < 2 * scale);
        CHECK(region.faces == std::vector<int>{1});
        double open = 0;
        for (const std::uint32_t t : c.coverage.open_triangles) {
          open += covered_area(c, t);
          for (const std::uint32_t v : c.mesh.triangles[t])
            CHECK((c.part.feet[v].point - place).norm() < radius + 3 * scale);
        }
        CHECK(open > 0.75 * pi * radius * radius);
        CHECK(open < 1.5 * pi * radius * radius);
      }
    }
}

TEST_CASE("find_unmeasured: two gaps are two regions, the larger disc first") {
  const Ground plane = grounds()[0];
  for (const Sampling& s : samplings) {
    CAPTURE(s.name);
    const Covered c = with_gaps(plane.shape, s, plane.places, 6 * scale_without_gaps(plane.shape, s));
    check_opened(c, 2);
  }
}

TEST_CASE("find_unmeasured: the hole size decides") {
  const Ground plane = grounds()[0];
  const double radius = 6 * scale_without_gaps(plane.shape, samplings[0]);
  check_nothing_open(with_gaps(plane.shape, samplings[0], {plane.places[0]}, radius, 9));
  check_opened(with_gaps(plane.shape, samplings[0], {plane.places[0]}, radius, 4), 1);
}

TEST_CASE("find_unmeasured: a disc ends at a free edge") {
  const Ground plane = grounds()[0];
  for (const Sampling& s : samplings) {
    CAPTURE(s.name);
    const double scale = scale_without_gaps(plane.shape, s);
    // A half disc holds a disc of half its radius.
    check_nothing_open(with_gaps(plane.shape, s, {Vec3(50, 0, 0)}, 4 * scale));
    const Covered c = with_gaps(plane.shape, s, {Vec3(50, 0, 0)}, 11 * scale);
    REQUIRE(c.coverage.regions.size() == 1);
    CHECK(c.coverage.regions[0].radius > 4.5 * scale);
    CHECK(c.coverage.regions[0].radius < 7 * scale);
  }
}

TEST_CASE("find_unmeasured: a gap around a corner or across an edge of the part is found") {
  const Shape box = make_shape(BRepPrimAPI_MakeBox(60, 50, 40).Shape());
  for (const Sampling& s : samplings)
    for (const Vec3& place : {Vec3(60, 50, 40), Vec3(60, 25, 40)}) {
      CAPTURE(s.name);
      CAPTURE(place);
      const double radius = 6 * scale_without_gaps(box, s);
      const Covered c = with_gaps(box, s, {place}, radius);
      check_opened(c, 1);
      CHECK((c.coverage.regions[0].center - place).norm() < radius);
    }
}

TEST_CASE("find_unmeasured: points on the other side of a thin wall do not fill a gap") {
  const Shape plate = make_shape(BRepPrimAPI_MakeBox(100, 80, 0.5).Shape());
  Sampling s = samplings[0];
  s.points = 8000;
  const double scale = scale_without_gaps(plate, s);
  test::MeasuredPart part = test::measured_part(plate, options_for(s));
  const Vec3 place(40, 40, 0.5);
  for (Foot& foot : part.feet)
    if (foot.normal[2] > 0.5f && (foot.point - place).norm() < 6 * scale) foot.face = -1;
  Covered c{std::move(part), {}, {}, scale};
  c.mesh = connected(c.part);
  Context context;
  c.coverage = find_unmeasured(c.part.model, Registration(c.part.model), c.mesh, c.part.feet, hole_size, context);
  check_opened(c, 1);
  CHECK((c.coverage.regions[0].center - place).norm() < scale);
}

TEST_CASE("find_unmeasured: a side of a box without points is one region on that face") {
  const Shape box = make_shape(BRepPrimAPI_MakeBox(60, 50, 40).Shape());
  for (const Sampling& s : samplings) {
    CAPTURE(s.name);
    test::MeasuredPart part = test::measured_part(box, options_for(s));
    for (Foot& foot : part.feet)
      if (foot.face == 2) foot.face = -1;
    Covered c{std::move(part), {}, {}, 0};
    c.mesh = connected(c.part);
    Context context;
    c.coverage = find_unmeasured(c.part.model, Registration(c.part.model), c.mesh, c.part.feet, hole_size, context);
    check_opened(c, 1);
    const auto& faces = c.coverage.regions[0].faces;
    CHECK(std::count(faces.begin(), faces.end(), c.part.model.faces[2].index) == 1);
    double open = 0;
    for (const std::uint32_t t : c.coverage.open_triangles) open += covered_area(c, t);
    CHECK(open > 0.8 * c.part.model.faces[2].area);
    CHECK(open < 1.3 * c.part.model.faces[2].area);
  }
}

TEST_CASE("point_spacing: the square root of the area per point on scattered points, the distance of scan lines") {
  for (const Ground& ground : grounds())
    for (const Sampling& s : samplings) {
      CAPTURE(ground.name);
      CAPTURE(s.name);
      const test::MeasuredPart part = test::measured_part(ground.shape, options_for(s));
      std::vector<Vec3> places;
      for (const Foot& f : part.feet) places.push_back(f.point);
      std::vector<float> spacing = point_spacing(connected(part), places);
      REQUIRE(spacing.size() == places.size());
      std::sort(spacing.begin(), spacing.end());
      const double scale = scale_of(part.measurement);
      CHECK(spacing[spacing.size() / 2] > 0.7 * scale);
      CHECK(spacing[spacing.size() / 2] < 1.4 * scale);
      CHECK(spacing[spacing.size() / 20] > 0.4 * scale);
      CHECK(spacing[spacing.size() * 19 / 20] < 2.5 * scale);
    }
}

TEST_CASE("point_spacing: 0 for points in no triangle") {
  PointMesh mesh;
  mesh.triangles = {{0, 1, 3}};
  mesh.neighbors = {{-1, -1, -1}};
  const std::vector<Vec3> places{{0, 0, 0}, {1, 0, 0}, {9, 9, 9}, {0, 1, 0}};
  const std::vector<float> spacing = point_spacing(mesh, places);
  REQUIRE(spacing.size() == 4);
  CHECK(spacing[2] == 0);
  CHECK(spacing[0] > 0);
}

TEST_CASE("drop_triangles: links what is left anew") {
  MeasurementOptions options;
  options.points = 300;
  const test::MeasuredPart part = test::measured_part(make_shape(BRepPrimAPI_MakeBox(20, 30, 10).Shape()), options);
  const PointMesh mesh = connected(part);
  PointMesh same = mesh;
  drop_triangles(same, {});
  CHECK((same.triangles == mesh.triangles));
  CHECK((same.neighbors == mesh.neighbors));
  PointMesh one = mesh;
  drop_triangles(one, std::vector<std::uint32_t>{7});
  const test::LinkedTriangles linked = test::check_links(one.triangles, one.neighbors);
  CHECK_LINKS(linked);
  CHECK(linked.loops == 1);
  CHECK(linked.euler == 1);
  PointMesh none = mesh;
  std::vector<std::uint32_t> all;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) all.push_back(t);
  drop_triangles(none, all);
  CHECK(none.triangles.empty());
  CHECK(none.neighbors.empty());
}

TEST_CASE("find_unmeasured: no mesh has no region; a cancelled context throws") {
  const Ground plane = grounds()[0];
  const Covered c =
      with_gaps(plane.shape, samplings[0], {plane.places[0]}, 6 * scale_without_gaps(plane.shape, samplings[0]));
  const Registration registration(c.part.model);
  Context context;
  CHECK(find_unmeasured(c.part.model, registration, {}, {}, hole_size, context).regions.empty());
  context.cancel();
  CHECK_THROWS_AS(find_unmeasured(c.part.model, registration, c.mesh, c.part.feet, hole_size, context), Cancelled);
}

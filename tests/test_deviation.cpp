#include <doctest/doctest.h>

// OpenMesh's headers do not compile after OpenCASCADE's.
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <cmath>
#include <limits>
#include <random>

#include "libtri/deviation.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "libtri/triangulation/triangulate.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

struct Measured {
  CadModel model;
  std::vector<Vec3> points;
  std::vector<Foot> feet;
};

Measured measured_points(const TopoDS_Shape& shape, std::vector<Vec3> points) {
  Measured m{make_cad_model(make_shape(shape)), std::move(points), {}};
  Context context;
  m.feet = Registration(m.model).register_points(m.points, context);
  return m;
}

Deviations deviations_of(const Measured& m, const DeviationOptions& options, int threads = 0) {
  Context context;
  context.threads = threads;
  return deviations(m.model, m.points, m.feet, options, context);
}

// Points over the sides x = 0 (0.1 outside), z = 10 (0.2 inside; one 0.4 outside) of a box of 20 x 30 x 10.
Measured measured_box() {
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i) points.push_back({-0.1, 5.0 + 2 * i, 5});
  for (int i = 0; i < 9; ++i) points.push_back({10, 5.0 + 2 * i, 9.8});
  points.push_back({10, 25, 10.4});
  return measured_points(BRepPrimAPI_MakeBox(20, 30, 10).Shape(), points);
}

}  // namespace

TEST_CASE("deviations: signed distances of a box by face, with the faces that have none") {
  const Measured m = measured_box();
  const Deviations d = deviations_of(m, {.tolerance = Tolerance{-0.25, 0.15}});
  REQUIRE(d.values.size() == 20);
  CHECK(d.values[3] == doctest::Approx(0.1));
  CHECK(d.values[12] == doctest::Approx(-0.2));
  CHECK(d.values[19] == doctest::Approx(0.4));
  CHECK(d.overall.count == 20);
  CHECK(d.overall.mean == doctest::Approx((10 * 0.1 - 9 * 0.2 + 0.4) / 20));
  CHECK(d.overall.rms == doctest::Approx(std::sqrt((10 * 0.01 + 9 * 0.04 + 0.16) / 20)));
  CHECK(d.overall.in_tolerance == 19);
  CHECK(d.overall.max_index == 19);
  REQUIRE(d.per_face.size() == 6);
  int measured_faces = 0;
  for (const FaceDeviation& face : d.per_face) {
    CHECK(face.surface_type == "plane");
    if (face.statistics.count == 0) continue;
    ++measured_faces;
    CHECK(face.statistics.count == 10);
    const bool top = face.face == d.faces[19];
    CHECK(face.area == doctest::Approx(top ? 600 : 300));
    CHECK(face.statistics.mean == doctest::Approx(top ? (-9 * 0.2 + 0.4) / 10 : 0.1));
    CHECK(face.statistics.in_tolerance == (top ? 9 : 10));
    CHECK(d.faces[face.statistics.max_index] == face.face);
    if (top) {
      CHECK(face.statistics.max_index == 19);
      CHECK(face.statistics.min_index == 10);
    } else {
      CHECK(face.statistics.standard_deviation <= 1e-15);
    }
  }
  CHECK(measured_faces == 2);
  CHECK(d.far.empty());
}

TEST_CASE("deviations: points beyond max_distance are listed and do not count; without it every point counts") {
  const Measured m = measured_box();
  const Deviations d = deviations_of(m, {.max_distance = 0.3});
  CHECK(d.far == std::vector<std::uint32_t>{19});
  CHECK(d.values.size() == 20);
  CHECK(d.values[19] == doctest::Approx(0.4));
  CHECK(counted_values(d) == std::vector<double>(d.values.begin(), d.values.begin() + 19));
  CHECK(d.overall.count == 19);
  CHECK(d.overall.max == doctest::Approx(0.1));
  for (const DeviationSpot& spot : d.spots) CHECK(spot.point != 19);
  CHECK(deviations_of(m, {}).overall.count == 20);
  const Deviations none = deviations_of(m, {.max_distance = 1e-3});
  CHECK(none.far.size() == 20);
  CHECK(none.overall.count == 0);
  CHECK(none.spots.empty());
}

TEST_CASE("deviations: the worst places are apart, and ranked by tolerance where there is one") {
  const Measured m = measured_box();
  const Deviations plain = deviations_of(m, {.spots = 3});
  REQUIRE(plain.spots.size() == 3);
  CHECK(plain.spots[0].point == 19);
  CHECK(plain.spots[0].deviation == doctest::Approx(0.4));
  CHECK((plain.spots[0].foot - Vec3(10, 25, 10)).norm() < 1e-9);
  CHECK(plain.spots[1].deviation == doctest::Approx(-0.2));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      CHECK((plain.spots[i].position - plain.spots[j].position).norm() > 0.1 * m.model.diagonal);
  // 0.1 is farther outside [-0.3, 0.05] than -0.2.
  const Deviations ranked = deviations_of(m, {.tolerance = Tolerance{-0.3, 0.05}, .spots = 2});
  CHECK(ranked.spots[0].point == 19);
  CHECK(ranked.spots[1].deviation == doctest::Approx(0.1));
}

TEST_CASE("deviations: on a sphere they are the differences of the radii, the same for any number of threads") {
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Vec3> points;
  std::vector<double> expected;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    expected.push_back(0.05 * normal(random));
    points.push_back(direction * (7 + expected.back()));
  }
  const Measured m = measured_points(BRepPrimAPI_MakeSphere(7).Shape(), points);
  const Deviations one = deviations_of(m, {}, 1), two = deviations_of(m, {}, 2);
  for (std::size_t i = 0; i < points.size(); ++i) CHECK(std::abs(one.values[i] - expected[i]) < 1e-9);
  CHECK(one.overall.mean == two.overall.mean);
  CHECK(one.overall.standard_deviation == two.overall.standard_deviation);
  CHECK(one.per_face[0].statistics.rms == one.overall.rms);
  CHECK(counted_values(one) == one.values);
}

TEST_CASE("deviations: refuses what it cannot count, and heeds a cancel") {
  const Measured m = measured_box();
  CHECK_THROWS_AS(deviations_of(m, {.max_distance = 0.0}), InvalidInput);
  CHECK_THROWS_AS(deviations_of(m, {.tolerance = Tolerance{1, -1}}), InvalidInput);
  Measured broken = m;
  broken.feet.pop_back();
  CHECK_THROWS_AS(deviations_of(broken, {}), InvalidInput);
  const Measured infinite = measured_points(BRepPrimAPI_MakeBox(1, 1, 1).Shape(),
                                            {{0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}});
  CHECK_THROWS_AS(deviations_of(infinite, {}), InvalidInput);
  CHECK_THROWS_AS(feet_of(Mesh(), m.model), InvalidInput);
  Context cancelled;
  cancelled.cancel();
  CHECK_THROWS_AS(deviations(m.model, m.points, m.feet, {}, cancelled), Cancelled);
}

TEST_CASE("feet_of: the vertices of a triangulated cap have its normals") {
  const Shape shape = example_part("sphere-cap");
  const CadModel model = make_cad_model(shape);
  MeasurementOptions options;
  options.points = 300;
  Context context;
  const VirtualMeasurement m = measure(shape, options, context);
  const TriangulateResult result = triangulate(model, m.points, {}, context);
  const std::vector<Foot> feet = feet_of(result.mesh, model);
  REQUIRE(feet.size() == result.mesh.n_vertices());
  // The sphere is about the origin.
  for (const Foot& foot : feet)
    CHECK((Vec3(foot.normal[0], foot.normal[1], foot.normal[2]) - foot.point.normalized()).norm() < 1e-6);
}

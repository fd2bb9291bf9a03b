// clang-format off: OpenMesh does not compile after OpenCASCADE
#include "libtri/triangulation/triangulate.hpp"
// clang-format on

#include <doctest/doctest.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "mesh_check.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

VirtualMeasurement measured(const Shape& shape, const MeasurementOptions& options) {
  Context context;
  return measure(shape, options, context);
}

TriangulateResult triangulated(const CadModel& model, const std::vector<Vec3>& points,
                               const TriangulateOptions& options = {}, int threads = 0) {
  Context context;
  context.threads = threads;
  return triangulate(model, points, options, context);
}

template <class T>
T& property_of(const TriangulateResult& result, OpenMesh::VPropHandleT<T>& handle, const char* name, VertexHandle v) {
  Mesh& mesh = const_cast<Mesh&>(result.mesh);
  if (!handle.is_valid()) REQUIRE(mesh.get_property_handle(handle, name));
  return mesh.property(handle, v);
}

std::vector<int> point_indices(const TriangulateResult& result) {
  OpenMesh::VPropHandleT<int> handle;
  std::vector<int> indices;
  for (const auto v : result.mesh.vertices()) indices.push_back(property_of(result, handle, property::point_index, v));
  return indices;
}

// Each point is a vertex once at its measured position, an outlier or a duplicate; the properties tell where it lies.
void check_points(const CadModel& model, const std::vector<Vec3>& points, const TriangulateResult& result) {
  std::vector<int> uses(points.size(), 0);
  for (const std::uint32_t i : result.outliers) ++uses.at(i);
  for (const std::uint32_t i : result.duplicates) ++uses.at(i);
  CHECK(std::is_sorted(result.outliers.begin(), result.outliers.end()));
  CHECK(std::is_sorted(result.duplicates.begin(), result.duplicates.end()));
  std::vector<std::size_t> position(
      1 + static_cast<std::size_t>(
              std::max_element(model.faces.begin(), model.faces.end(), [](const CadFace& a, const CadFace& b) {
                return a.index < b.index;
              })->index));
  for (std::size_t f = 0; f < model.faces.size(); ++f) position[static_cast<std::size_t>(model.faces[f].index)] = f;
  OpenMesh::VPropHandleT<int> index, face;
  OpenMesh::VPropHandleT<Vec2> uv;
  OpenMesh::VPropHandleT<double> deviation;
  std::vector<std::uint64_t> per_face(model.faces.size(), 0);
  double foot_error = 0;
  for (const auto v : result.mesh.vertices()) {
    const auto i = static_cast<std::size_t>(property_of(result, index, property::point_index, v));
    REQUIRE(i < points.size());
    ++uses[i];
    REQUIRE(result.mesh.point(v) == points[i]);
    const std::size_t f = position.at(static_cast<std::size_t>(property_of(result, face, property::cad_face, v)));
    ++per_face[f];
    const Vec2 at = property_of(result, uv, property::uv, v);
    const double distance = (model.faces[f].surface->point(at[0], at[1]) - points[i]).norm();
    foot_error =
        std::max(foot_error, std::abs(distance - std::abs(property_of(result, deviation, property::deviation, v))));
  }
  CHECK(foot_error < 1e-6);
  CHECK(std::count(uses.begin(), uses.end(), 1) == static_cast<long>(points.size()));
  REQUIRE(result.faces.size() == model.faces.size());
  std::vector<int> without;
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    CHECK(result.faces[f].face == model.faces[f].index);
    CHECK(result.faces[f].points == per_face[f]);
    if (per_face[f] == 0) without.push_back(model.faces[f].index);
  }
  CHECK(result.unmeasured_faces == without);
  CHECK(result.checks.unused_points == 0);
}

int components(const Mesh& mesh) {
  std::vector<bool> seen(mesh.n_faces(), false);
  int count = 0;
  for (const auto start : mesh.faces()) {
    if (seen[static_cast<std::size_t>(start.idx())]) continue;
    ++count;
    std::vector<FaceHandle> stack{start};
    seen[static_cast<std::size_t>(start.idx())] = true;
    while (!stack.empty()) {
      const FaceHandle f = stack.back();
      stack.pop_back();
      for (const auto n : mesh.ff_range(f))
        if (!seen[static_cast<std::size_t>(n.idx())])
          seen[static_cast<std::size_t>(n.idx())] = true, stack.push_back(n);
    }
  }
  return count;
}

void check_mesh(const TriangulateResult& result, const SurfaceTopology& expected) {
  CHECK_VALID_MESH(result.mesh);
  CHECK(components(result.mesh) == expected.components);
  CHECK(test::boundary_loops(result.mesh) == expected.loops);
  CHECK(test::euler_characteristic(result.mesh) == expected.euler);
}

CadModel box_model() {
  return make_cad_model(make_shape(BRepPrimAPI_MakeBox(60, 50, 40).Shape()));
}
constexpr SurfaceTopology closed{1, 0, 2};

std::vector<Vec3> box_points(std::uint64_t n, double noise = 0) {
  MeasurementOptions options;
  options.points = n;
  options.noise = noise;
  return measured(make_shape(BRepPrimAPI_MakeBox(60, 50, 40).Shape()), options).points;
}

template <class Change>
TriangulateOptions changed(Change change) {
  TriangulateOptions options;
  change(options);
  return options;
}

}  // namespace

TEST_CASE("triangulate: on every example part each point is a vertex, outliers are told, the topology is the part's") {
  for (const ExamplePart& part : example_parts()) {
    const Shape shape = example_part(part.name);
    const CadModel model = make_cad_model(shape);
    const SurfaceTopology expected{part.components, part.loops, part.euler};
    for (const SamplingPattern pattern : {SamplingPattern::random, SamplingPattern::scan}) {
      CAPTURE(part.name);
      CAPTURE((pattern == SamplingPattern::scan));
      MeasurementOptions options;
      options.points = 3400;
      options.pattern = pattern;
      options.noise = 0.01;
      options.outliers = 0.01;
      const VirtualMeasurement m = measured(shape, options);
      const TriangulateResult result = triangulated(model, m.points);
      check_points(model, m.points, result);
      CHECK(result.checks.model == expected);
      CHECK(result.checks.mesh == expected);
      CHECK(result.holes.empty());
      check_mesh(result, expected);
      std::size_t planted = 0, missed = 0, called = 0;
      for (std::uint32_t i = 0; i < m.truth.size(); ++i) {
        const bool out = std::binary_search(result.outliers.begin(), result.outliers.end(), i);
        planted += m.truth[i].outlier;
        missed += m.truth[i].outlier && !out;
        called += !m.truth[i].outlier && out;
      }
      CHECK(planted >= 20);
      CHECK(missed == 0);
      CHECK(called <= (m.truth.size() - planted) / 1000);
    }
  }
}

TEST_CASE("triangulate: either method alone keeps every point and the topology of a box and a sphere") {
  for (const Method method : {Method::patches, Method::shell})
    for (const bool round : {false, true}) {
      CAPTURE((method == Method::shell));
      CAPTURE(round);
      const Shape shape =
          make_shape(round ? BRepPrimAPI_MakeSphere(20).Shape() : BRepPrimAPI_MakeBox(60, 50, 40).Shape());
      const CadModel model = make_cad_model(shape);
      MeasurementOptions options;
      options.points = 2500;
      options.noise = 0.02;
      const VirtualMeasurement m = measured(shape, options);
      const TriangulateResult result = triangulated(model, m.points, changed([&](auto& o) { o.method = method; }));
      CHECK((result.method == method));
      CHECK(result.sigma == doctest::Approx(0.02).epsilon(0.1));
      check_points(model, m.points, result);
      check_mesh(result, closed);
      CHECK(result.checks.self_intersections == 0);
    }
}

TEST_CASE("triangulate: a gap is a hole, or spanned when that is asked for") {
  const CadModel model = box_model();
  std::vector<Vec3> points;
  const Vec3 place(30, 25, 40);
  for (const Vec3& p : box_points(5000, 0.005))
    if ((p - place).norm() > 10) points.push_back(p);
  const TriangulateResult open = triangulated(model, points);
  check_points(model, points, open);
  REQUIRE(open.holes.size() == 1);
  CHECK((open.holes[0].center - place).norm() < 2);
  check_mesh(open, {1, 1, 1});
  CHECK(open.checks.mesh == closed);
  const TriangulateResult spanned =
      triangulated(model, points, changed([](auto& o) { o.unmeasured = Unmeasured::span; }));
  CHECK(spanned.holes.empty());
  check_points(model, points, spanned);
  check_mesh(spanned, closed);
  const TriangulateResult tolerant = triangulated(model, points, changed([](auto& o) { o.hole_size = 50; }));
  CHECK(tolerant.holes.empty());
  check_mesh(tolerant, closed);
}

TEST_CASE("triangulate: all points on one face") {
  const CadModel model = box_model();
  std::vector<Vec3> points;
  for (const Vec3& p : box_points(5000))
    if (p[2] == 40) points.push_back(p);
  REQUIRE(points.size() > 200);
  const TriangulateResult open = triangulated(model, points);
  check_points(model, points, open);
  CHECK(open.unmeasured_faces.size() == 5);
  CHECK_VALID_MESH(open.mesh);
  CHECK_FALSE(open.holes.empty());
  CHECK(components(open.mesh) == 1);
  // What is left covers the face, facing up; what stood for the other five is gone.
  double up = 0, down = 0;
  for (const auto f : open.mesh.faces()) {
    const auto h = open.mesh.halfedge_handle(f);
    const Vec3 a = open.mesh.point(open.mesh.from_vertex_handle(h)), b = open.mesh.point(open.mesh.to_vertex_handle(h)),
               c = open.mesh.point(open.mesh.to_vertex_handle(open.mesh.next_halfedge_handle(h)));
    const double area = 0.5 * ((b - a) % (c - a))[2];
    (area > 0 ? up : down) += std::abs(area);
  }
  const double spacing = std::sqrt(3000 / static_cast<double>(points.size()));
  CHECK(up > (60 - 2 * spacing) * (50 - 2 * spacing));
  CHECK(up < 1.01 * 3000);
  CHECK(down < 0.02 * 3000);
  const TriangulateResult spanned =
      triangulated(model, points, changed([](auto& o) { o.unmeasured = Unmeasured::span; }));
  check_points(model, points, spanned);
  check_mesh(spanned, closed);
}

TEST_CASE("triangulate: points measured twice are vertices once, in any order of the points") {
  const CadModel model = box_model();
  std::vector<Vec3> points = box_points(600, 0.01);
  const std::size_t distinct = points.size();
  for (std::size_t i = 0; i < distinct; i += 5) points.push_back(points[i]);
  const TriangulateResult result = triangulated(model, points);
  check_points(model, points, result);
  CHECK(result.duplicates.size() == distinct / 5);
  for (const std::uint32_t d : result.duplicates) CHECK(d >= distinct);
  check_mesh(result, closed);
  std::shuffle(points.begin(), points.end(), std::mt19937(4));
  const TriangulateResult shuffled = triangulated(model, points);
  check_points(model, points, shuffled);
  CHECK(shuffled.mesh.n_vertices() == result.mesh.n_vertices());
  check_mesh(shuffled, closed);
}

TEST_CASE("triangulate: the patches before stitching are asked for, one for each face") {
  const CadModel model = box_model();
  const std::vector<Vec3> points = box_points(1500);
  CHECK_FALSE(triangulated(model, points).patches.has_value());
  for (const Method method : {Method::automatic, Method::patches, Method::shell}) {
    const TriangulateResult result =
        triangulated(model, points, changed([&](auto& o) { o.keep_patches = true, o.method = method; }));
    REQUIRE(result.patches.has_value());
    CHECK_VALID_MESH(*result.patches);
    CHECK(components(*result.patches) == 6);
    CHECK(test::boundary_loops(*result.patches) == 6);
    check_mesh(result, closed);
  }
}

TEST_CASE("triangulate: a given outlier distance alone decides") {
  const CadModel model = box_model();
  std::vector<Vec3> points = box_points(800);
  points[10] += Vec3(0, 0, 100) * (points[10][2] > 20 ? 1.0 : -1.0);  // far above or below the box
  const TriangulateResult usual = triangulated(model, points);
  CHECK(usual.outliers == std::vector<std::uint32_t>{10});
  const TriangulateResult patient = triangulated(model, points, changed([](auto& o) { o.outlier_distance = 1000; }));
  CHECK(patient.outliers.empty());
  check_points(model, points, patient);
  check_mesh(patient, closed);
}

TEST_CASE("triangulate: bit for bit the same result on one and two threads") {
  for (const std::string name : {"elbow", "bracket"})
    for (const Method method : {Method::patches, Method::shell}) {
      const Shape shape = example_part(name);
      const CadModel model = make_cad_model(shape);
      MeasurementOptions options;
      options.points = 6000;
      options.pattern = SamplingPattern::scan;
      options.noise = 0.02;
      options.outliers = 0.005;
      options.drop_outs = 2;
      options.drop_out_radius = 12;
      const VirtualMeasurement m = measured(shape, options);
      TriangulateResult one = triangulated(model, m.points, changed([&](auto& o) { o.method = method; }), 1);
      TriangulateResult two = triangulated(model, m.points, changed([&](auto& o) { o.method = method; }), 2);
      check_points(model, m.points, one);
      CHECK(one.outliers == two.outliers);
      CHECK(one.holes.size() == two.holes.size());
      CHECK(one.notes == two.notes);
      CHECK(one.sigma == two.sigma);
      CHECK(point_indices(one) == point_indices(two));
      MeshLease a(one.mesh), b(two.mesh);
      CHECK((test::snapshot(a) == test::snapshot(b)));
    }
}

TEST_CASE("triangulate: cancelled at any checkpoint it throws, and progress never goes back within a step") {
  const CadModel model = box_model();
  const std::vector<Vec3> points = box_points(3000);
  for (const Method method : {Method::patches, Method::shell}) {
    TriangulateOptions options;
    options.method = method;
    Context counting;
    std::atomic<int> checkpoints{0};
    counting.on_checkpoint = [&] { ++checkpoints; };
    std::string step;
    double share = 0;
    counting.on_progress = [&](std::string_view name, double s) {
      CHECK(s >= 0);
      CHECK(s <= 1);
      if (name == step) CHECK(s >= share);
      step = name, share = s;
    };
    triangulate(model, points, options, counting);
    const int all = checkpoints;
    REQUIRE(all > 3);
    for (const int stop : {1, 2, all / 4, all / 2, 3 * all / 4}) {
      CAPTURE(stop);
      CAPTURE(all);
      Context context;
      std::atomic<int> count{0};
      context.on_checkpoint = [&] {
        if (++count == stop) context.cancel();
      };
      CHECK_THROWS_AS(triangulate(model, points, options, context), Cancelled);
    }
  }
}

TEST_CASE("triangulate: what cannot be a measurement of the model is refused") {
  const CadModel model = box_model();
  const std::vector<Vec3> good = box_points(100);
  const auto refused = [&](const std::vector<Vec3>& points, const TriangulateOptions& options = {}) {
    CHECK_THROWS_AS(triangulated(model, points, options), InvalidInput);
  };
  refused({});
  refused({good[0], good[1]});
  refused(std::vector<Vec3>(50, good[0]));
  refused({good[0], good[1], good[0], good[1], good[1]});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()})
    for (int k = 0; k < 3; ++k) {
      std::vector<Vec3> points = good;
      points[50][k] = bad;
      refused(points);
    }
  std::vector<Vec3> far = good;
  for (Vec3& p : far) p += Vec3(10000, 0, 0);
  refused(far);
  for (Vec3& p : far) p = (p - Vec3(10000, 0, 0)) * 25.4;  // inches taken for millimetres
  refused(far);
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    refused(good, changed([&](auto& o) { o.hole_size = bad; }));
    refused(good, changed([&](auto& o) { o.outlier_distance = bad; }));
  }
}

TEST_CASE("triangulate: a handful of points gives a small valid mesh or none, and says what is missing") {
  const CadModel model = box_model();
  for (const std::uint64_t n : {3, 4, 5, 8, 20}) {
    CAPTURE(n);
    const std::vector<Vec3> points = box_points(n);
    for (const Method method : {Method::automatic, Method::patches, Method::shell}) {
      const TriangulateResult result =
          triangulated(model, points, changed([&](auto& o) { o.method = method, o.unmeasured = Unmeasured::span; }));
      CHECK_VALID_MESH(result.mesh);
      const std::vector<int> indices = point_indices(result);
      std::set<int> once(indices.begin(), indices.end());
      CHECK(once.size() == indices.size());
      CHECK(result.checks.unused_points + indices.size() + result.outliers.size() == points.size());
      if (result.checks.mesh != result.checks.model || result.checks.unused_points > 0)
        CHECK_FALSE(result.notes.empty());
    }
  }
}

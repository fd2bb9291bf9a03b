#include <doctest/doctest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>
#include <random>
#include <set>
#include <vector>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/triangulation/shell/connect.hpp"
#include "libtri/triangulation/shell/delaunay_flips.hpp"
#include "libtri/triangulation/shell/insertion.hpp"
#include "libtri/triangulation/shell/vertex_removal.hpp"
#include "link_check.hpp"
#include "measured_part.hpp"
#include "meshops/error.hpp"
#include "occt_parts.hpp"

using namespace tri;

namespace {

Tessellation tessellation_of(const CadModel& model) {
  return tessellate(model, 1e-3 * model.diagonal, 0.35, Context());
}

Shape rectangle(double width, double height) {
  return make_shape(BRepBuilderAPI_MakeFace(gp_Pln(), 0, width, 0, height).Face());
}

Shape box() {
  return make_shape(BRepPrimAPI_MakeBox(20, 30, 10).Shape());
}

std::size_t registered(const std::vector<Foot>& feet) {
  return static_cast<std::size_t>(std::count_if(feet.begin(), feet.end(), [](const Foot& f) { return f.face >= 0; }));
}

// Links, topology of the tessellation, its vertices in their order and then every registered point once, at its foot.
void check_inserted(const EditMesh& mesh, const Tessellation& tessellation, const std::vector<Foot>& feet) {
  const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
  CHECK_LINKS(linked);
  CHECK(SurfaceTopology{linked.components, linked.loops, linked.euler} ==
        topology(tessellation.triangles, tessellation.neighbors));
  REQUIRE(mesh.vertices.size() == tessellation.points.size() + registered(feet));
  CHECK(linked.vertices.size() == mesh.vertices.size());
  for (std::size_t v = 0; v < tessellation.points.size(); ++v) {
    REQUIRE(mesh.vertices[v].point == -1);
    REQUIRE(mesh.vertices[v].p == tessellation.points[v]);
  }
  std::int32_t last = -1;
  for (std::size_t v = tessellation.points.size(); v < mesh.vertices.size(); ++v) {
    const std::int32_t p = mesh.vertices[v].point;
    REQUIRE(p > last);
    REQUIRE(p < static_cast<std::int32_t>(feet.size()));
    REQUIRE(mesh.vertices[v].p == feet[p].point);
    last = p;
  }
}

// Links, and every registered point exactly once.
test::LinkedTriangles check_connected(const ShellConnection& shell, const std::vector<Foot>& feet) {
  const test::LinkedTriangles linked = test::check_links(shell.mesh.triangles, shell.mesh.neighbors);
  CHECK_LINKS(linked);
  CHECK(linked.double_edges.empty());
  CHECK(linked.vertices.size() == registered(feet));
  for (const std::uint32_t v : linked.vertices) {
    REQUIRE(v < feet.size());
    REQUIRE(feet[v].face >= 0);
  }
  return linked;
}

// All of it, with the topology of the model.
void check_shell_complete(const CadModel& model, const std::vector<Foot>& feet) {
  Context context;
  const Tessellation tessellation = tessellation_of(model);
  check_inserted(insert_feet(model, tessellation, feet, context), tessellation, feet);
  const ShellConnection shell = connect_by_shell(model, tessellation, feet, context);
  CHECK(shell.open_stars == 0);
  CHECK(shell.lost_shells == 0);
  const test::LinkedTriangles linked = check_connected(shell, feet);
  CHECK(SurfaceTopology{linked.components, linked.loops, linked.euler} ==
        topology(tessellation.triangles, tessellation.neighbors));
}

// Few points cannot carry every topology: what cannot be is left open and said.
void check_what_is_possible(const CadModel& model, const std::vector<Foot>& feet) {
  Context context;
  const Tessellation tessellation = tessellation_of(model);
  check_inserted(insert_feet(model, tessellation, feet, context), tessellation, feet);
  const ShellConnection shell = connect_by_shell(model, tessellation, feet, context);
  const test::LinkedTriangles linked = test::check_links(shell.mesh.triangles, shell.mesh.neighbors);
  CHECK_LINKS(linked);
  CHECK(linked.double_edges.empty());
  for (const std::uint32_t v : linked.vertices) REQUIRE((v < feet.size() && feet[v].face >= 0));
  const bool same = SurfaceTopology{linked.components, linked.loops, linked.euler} ==
                    topology(tessellation.triangles, tessellation.neighbors);
  CHECK((same || shell.open_stars > 0 || shell.lost_shells > 0));
}

// Random places on the plane faces of a box, in (u,v) of the face.
std::vector<Foot> feet_on(const CadModel& model, int face, int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  const CadFace& f = model.faces[static_cast<std::size_t>(face)];
  std::uniform_real_distribution<double> u(f.u_min, f.u_max), v(f.v_min, f.v_max);
  std::vector<Foot> feet;
  for (int i = 0; i < count; ++i) {
    const double x = u(random), y = v(random);
    feet.push_back(test::foot_at(model, face, Vec2(x, y)));
  }
  return feet;
}

// Signed by how far d lies inside the circle through a, b, c; positive inside, relative to the sizes of the terms.
long double in_circle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  using F = long double;
  const F ax = F(a[0]) - d[0], ay = F(a[1]) - d[1], bx = F(b[0]) - d[0], by = F(b[1]) - d[1], cx = F(c[0]) - d[0],
          cy = F(c[1]) - d[1];
  const F a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const F x = a2 * (bx * cy - cx * by), y = b2 * (cx * ay - ax * cy), z = c2 * (ax * by - bx * ay);
  return (x + y + z) / (std::abs(x) + std::abs(y) + std::abs(z) + 1e-300L);
}

}  // namespace

TEST_CASE("insert_feet and delaunay_flips: on a rectangle no circumcircle holds a point") {
  const CadModel model = make_cad_model(rectangle(30, 20));
  const Tessellation tessellation = tessellation_of(model);
  for (const int count : {1, 2, 10, 400}) {
    CAPTURE(count);
    const std::vector<Foot> feet = feet_on(model, 0, count, 5);
    Context context;
    EditMesh mesh = insert_feet(model, tessellation, feet, context);
    check_inserted(mesh, tessellation, feet);
    delaunay_flips(mesh, {}, context);
    check_inserted(mesh, tessellation, feet);
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 &a = mesh.vertices[t[0]].p, &b = mesh.vertices[t[1]].p, &c = mesh.vertices[t[2]].p;
      const double twice = ((b - a) % (c - a))[2];
      REQUIRE(twice > 0);
      area += 0.5 * twice;
      for (const EditMesh::Vertex& v : mesh.vertices) REQUIRE(in_circle(a, b, c, v.p) < 1e-7L);
    }
    CHECK(area == doctest::Approx(600));
    CHECK(delaunay_flips(mesh, {}, context) == 0);
  }
}

TEST_CASE("delaunay_flips: a grid in the plane ends, with right-angled triangles only") {
  const CadModel model = make_cad_model(rectangle(20, 20));
  const Tessellation tessellation = tessellation_of(model);
  std::vector<Foot> feet;
  for (int i = 1; i < 20; ++i)
    for (int j = 1; j < 20; ++j) feet.push_back(test::foot_at(model, 0, Vec2(i, j)));
  Context context;
  EditMesh mesh = insert_feet(model, tessellation, feet, context);
  delaunay_flips(mesh, {}, context);
  check_inserted(mesh, tessellation, feet);
  for (const Triangle& t : mesh.triangles) {
    const auto of_grid = [&](std::uint32_t v) { return mesh.vertices[v].point >= 0; };
    if (!of_grid(t[0]) || !of_grid(t[1]) || !of_grid(t[2])) continue;
    const Vec3& a = mesh.vertices[t[0]].p;
    CHECK(((mesh.vertices[t[1]].p - a) % (mesh.vertices[t[2]].p - a))[2] == doctest::Approx(1));
  }
}

TEST_CASE("remove_model_vertices: only points are left, and the topology stays") {
  for (const auto& solid : test::known_solids()) {
    CAPTURE(solid.name);
    MeasurementOptions options;
    options.points = 800;
    const test::MeasuredPart part = test::measured_part(make_shape(solid.shape), options);
    const Tessellation tessellation = tessellation_of(part.model);
    Context context;
    EditMesh mesh = insert_feet(part.model, tessellation, part.feet, context);
    delaunay_flips(mesh, {}, context);
    measure_vertex_areas(mesh);
    double area = 0, vertex_area = 0;
    for (const Triangle& t : mesh.triangles)
      area +=
          0.5 *
          ((mesh.vertices[t[1]].p - mesh.vertices[t[0]].p) % (mesh.vertices[t[2]].p - mesh.vertices[t[0]].p)).norm();
    for (const EditMesh::Vertex& v : mesh.vertices) vertex_area += v.area;
    CHECK(vertex_area == doctest::Approx(area).epsilon(1e-4));
    const VertexRemoval removal = remove_model_vertices(mesh, context);
    CHECK(removal.removed == tessellation.points.size());
    CHECK(removal.kept == 0);
    const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
    CHECK_LINKS(linked);
    CHECK(linked.double_edges.empty());
    CHECK(linked.vertices.size() == part.feet.size());
    for (const std::uint32_t v : linked.vertices) REQUIRE(mesh.vertices[v].point >= 0);
    CHECK(SurfaceTopology{linked.components, linked.loops, linked.euler} == SurfaceTopology{1, 0, solid.euler});
  }
}

TEST_CASE("cost_flips and split_encroached_edges: links, points and topology stay") {
  MeasurementOptions options;
  options.points = 1500;
  options.pattern = SamplingPattern::scan;
  const test::MeasuredPart part = test::measured_part(make_shape(test::box_with_hole()), options);
  const Tessellation tessellation = tessellation_of(part.model);
  Context context;
  EditMesh mesh = insert_feet(part.model, tessellation, part.feet, context);
  delaunay_flips(mesh, {}, context);
  const std::size_t vertices = mesh.vertices.size();
  std::vector<float> shortest(vertices, 0.5f);
  const std::size_t splits = split_encroached_edges(mesh, shortest, context);
  CHECK(splits > 0);
  CHECK(mesh.vertices.size() == vertices + splits);
  CHECK(shortest.size() == mesh.vertices.size());
  for (std::size_t v = vertices; v < mesh.vertices.size(); ++v) CHECK(mesh.vertices[v].point == -1);
  measure_vertex_areas(mesh);
  cost_flips(mesh, {}, context);
  CHECK(cost_flips(mesh, {}, context) == 0);
  const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
  CHECK_LINKS(linked);
  CHECK(linked.double_edges.empty());
  CHECK(linked.vertices.size() == mesh.vertices.size());
  CHECK(SurfaceTopology{linked.components, linked.loops, linked.euler} == SurfaceTopology{1, 0, 0});
}

TEST_CASE("connect_by_shell: solids of planes, cylinders, cones, spheres and tori") {
  for (const auto& solid : test::known_solids())
    for (const SamplingPattern pattern : {SamplingPattern::random, SamplingPattern::scan})
      for (const int points : {300, 2000}) {
        CAPTURE(solid.name);
        CAPTURE(points);
        MeasurementOptions options;
        options.points = static_cast<std::uint64_t>(points);
        options.pattern = pattern;
        const test::MeasuredPart part = test::measured_part(make_shape(solid.shape), options);
        check_shell_complete(part.model, part.feet);
      }
}

TEST_CASE("connect_by_shell: every example part keeps its topology and every point") {
  for (const ExamplePart& example : example_parts()) {
    CAPTURE(example.name);
    const Shape shape = example_part(example.name);
    for (const SamplingPattern pattern : {SamplingPattern::random, SamplingPattern::scan}) {
      MeasurementOptions options;
      options.points = 3400;
      options.pattern = pattern;
      const test::MeasuredPart part = test::measured_part(shape, options);
      check_shell_complete(part.model, part.feet);
    }
  }
}

TEST_CASE("connect_by_shell: points without a face are left out") {
  MeasurementOptions options;
  options.points = 600;
  test::MeasuredPart part = test::measured_part(box(), options);
  for (std::size_t i = 0; i < part.feet.size(); i += 3) part.feet[i].face = -1;
  check_shell_complete(part.model, part.feet);
}

TEST_CASE("connect_by_shell: points that share their foot are all vertices") {
  MeasurementOptions options;
  options.points = 300;
  test::MeasuredPart part = test::measured_part(box(), options);
  for (int copy = 0; copy < 3; ++copy) part.feet.push_back(part.feet[10]);
  for (int copy = 0; copy < 40; ++copy) part.feet.push_back(part.feet[20]);
  check_shell_complete(part.model, part.feet);
}

TEST_CASE("connect_by_shell: feet on corners and edges of the model, again and again") {
  MeasurementOptions options;
  options.points = 300;
  test::MeasuredPart part = test::measured_part(box(), options);
  for (int face = 0; face < 6; ++face) {
    const CadFace& f = part.model.faces[static_cast<std::size_t>(face)];
    const double u = 0.5 * (f.u_min + f.u_max), v = 0.5 * (f.v_min + f.v_max);
    for (const Vec2& uv : {Vec2(f.u_min, f.v_min), Vec2(f.u_max, f.v_max), Vec2(f.u_min, v), Vec2(u, f.v_max)})
      for (int copy = 0; copy < 2; ++copy) part.feet.push_back(test::foot_at(part.model, face, uv));
  }
  check_shell_complete(part.model, part.feet);
}

TEST_CASE("connect_by_shell: feet on the poles and along the seam of a sphere") {
  MeasurementOptions options;
  options.points = 400;
  test::MeasuredPart part = test::measured_part(make_shape(BRepPrimAPI_MakeSphere(7).Shape()), options);
  const CadFace& f = part.model.faces[0];
  for (int i = 0; i < 6; ++i) {
    part.feet.push_back(test::foot_at(part.model, 0, Vec2(i, f.v_min)));
    part.feet.push_back(test::foot_at(part.model, 0, Vec2(i, f.v_max)));
    part.feet.push_back(test::foot_at(part.model, 0, Vec2(f.u_min, f.v_min + 0.1 + 0.4 * i)));
    part.feet.push_back(test::foot_at(part.model, 0, Vec2(f.u_max, f.v_min + 0.3 + 0.4 * i)));
  }
  check_shell_complete(part.model, part.feet);
}

TEST_CASE("connect_by_shell: all points on one face of a closed box keep it closed") {
  const CadModel model = make_cad_model(box());
  for (int face = 0; face < 6; face += 2) {
    CAPTURE(face);
    check_shell_complete(model, feet_on(model, face, 60, 8));
  }
}

TEST_CASE("connect_by_shell: few or collinear points give what is possible") {
  const CadModel solid = make_cad_model(box()), sheet = make_cad_model(rectangle(30, 20));
  for (const CadModel* model : {&solid, &sheet}) {
    check_what_is_possible(*model, {});
    for (const int count : {1, 2, 3, 4, 5, 8}) {
      CAPTURE(count);
      check_what_is_possible(*model, feet_on(*model, 0, count, 3));
    }
    std::vector<Foot> line;
    const CadFace& f = model->faces[0];
    for (int i = 0; i < 12; ++i)
      line.push_back(
          test::foot_at(*model, 0, Vec2(f.u_min + (f.u_max - f.u_min) * (0.05 + 0.07 * i), 0.5 * (f.v_min + f.v_max))));
    check_what_is_possible(*model, line);
  }
  // Three points that are not collinear are one triangle of a sheet.
  Context context;
  const std::vector<Foot> three = feet_on(sheet, 0, 3, 3);
  const ShellConnection shell = connect_by_shell(sheet, tessellation_of(sheet), three, context);
  REQUIRE(shell.mesh.triangles.size() == 1);
  CHECK(check_connected(shell, three).loops == 1);
}

TEST_CASE("connect_by_shell: a part of the model without points is left out and counted") {
  BRep_Builder builder;
  TopoDS_Compound both;
  builder.MakeCompound(both);
  builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 10, 10, 10).Shape());
  builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(50, 0, 0), 10, 10, 10).Shape());
  MeasurementOptions options;
  options.points = 600;
  test::MeasuredPart part = test::measured_part(make_shape(both), options);
  check_shell_complete(part.model, part.feet);
  for (Foot& foot : part.feet)
    if (foot.point[0] > 30) foot.face = -1;
  Context context;
  const ShellConnection shell = connect_by_shell(part.model, tessellation_of(part.model), part.feet, context);
  CHECK(shell.lost_shells == 1);
  CHECK(shell.open_stars == 0);
  const test::LinkedTriangles linked = check_connected(shell, part.feet);
  CHECK(linked.components == 1);
  CHECK(linked.euler == 2);
}

TEST_CASE("connect_by_shell: the same mesh for any number of threads; a cancelled context throws") {
  MeasurementOptions options;
  options.points = 20000;
  options.pattern = SamplingPattern::scan;
  const test::MeasuredPart part = test::measured_part(example_part("elbow"), options);
  const Tessellation tessellation = tessellation_of(part.model);
  Context context;
  context.threads = 1;
  const ShellConnection one = connect_by_shell(part.model, tessellation, part.feet, context);
  context.threads = 2;
  const ShellConnection two = connect_by_shell(part.model, tessellation, part.feet, context);
  CHECK((one.mesh.triangles == two.mesh.triangles));
  CHECK((one.mesh.neighbors == two.mesh.neighbors));
  context.cancel();
  CHECK_THROWS_AS(connect_by_shell(part.model, tessellation, part.feet, context), Cancelled);
  CHECK_THROWS_AS(insert_feet(part.model, tessellation, part.feet, context), Cancelled);
}

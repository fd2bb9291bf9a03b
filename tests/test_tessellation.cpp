#include <doctest/doctest.h>

#include <BOPAlgo_Builder.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Trsf.hxx>
#include <numbers>
#include <set>

#include "libtri/example_parts.hpp"
#include "libtri/model/cad_topology.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/model/tessellation.hpp"
#include "link_check.hpp"
#include "meshops/error.hpp"
#include "occt_parts.hpp"

using namespace tri;

namespace {

using std::numbers::pi;

constexpr double angle = 0.35;

struct Tessellated {
  CadModel model;
  Tessellation mesh;
};

Tessellated tessellated(const Shape& shape, double share = 1e-3) {
  Tessellated result{make_cad_model(shape), {}};
  result.mesh = tessellate(result.model, share * result.model.diagonal, angle, Context());
  return result;
}

Vec3 cross_of(const Tessellation& mesh, std::size_t t) {
  const Triangle& q = mesh.triangles[t];
  return (mesh.points[q[1]] - mesh.points[q[0]]) % (mesh.points[q[2]] - mesh.points[q[0]]);
}

// Linked both ways, one fan per vertex, every vertex used, and counted the same by `topology`.
test::LinkedTriangles check_structure(const Tessellation& mesh) {
  REQUIRE(mesh.neighbors.size() == mesh.triangles.size());
  REQUIRE(mesh.faces.size() == mesh.triangles.size());
  REQUIRE(mesh.corner_uv.size() == mesh.triangles.size());
  const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
  CHECK_LINKS(linked);
  CHECK(linked.vertices.size() == mesh.points.size());
  CHECK(topology(mesh.triangles, mesh.neighbors) == SurfaceTopology{linked.components, linked.loops, linked.euler});
  return linked;
}

// Corners evaluate to their points on the faces' own surfaces, middles are within the deflection, normals agree.
void check_geometry(const Tessellated& t, double corner_tolerance) {
  double corner_error = 0;
  std::size_t turned = 0;
  for (std::size_t i = 0; i < t.mesh.triangles.size(); ++i) {
    REQUIRE(t.mesh.faces[i] >= 0);
    REQUIRE(t.mesh.faces[i] < static_cast<int>(t.model.faces.size()));
    const CadFace& face = t.model.faces[t.mesh.faces[i]];
    const auto& uv = t.mesh.corner_uv[i];
    Vec3 normal(0, 0, 0);
    for (int k = 0; k < 3; ++k) {
      const SurfacePoint s = face.surface->evaluate(uv[k][0], uv[k][1]);
      corner_error = std::max(corner_error, (s.p - t.mesh.points[t.mesh.triangles[i][k]]).norm());
      normal += (s.du % s.dv) * (face.reversed ? -1.0 : 1.0);
    }
    turned += (cross_of(t.mesh, i) | normal) < 0;
  }
  CHECK(corner_error < corner_tolerance);
  CHECK(static_cast<double>(turned) <= 0.001 * static_cast<double>(t.mesh.triangles.size()));
}

void check_topology(const Tessellated& t) {
  const test::LinkedTriangles linked = check_structure(t.mesh);
  const CadTopology cad = cad_topology(t.model);
  CHECK(linked.components == cad.components);
  CHECK(linked.loops == cad.loops);
  CHECK(linked.euler == cad.euler);
}

double area_of(const Tessellation& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += 0.5 * cross_of(mesh, t).norm();
  return sum;
}

TopoDS_Shape moved(const TopoDS_Shape& shape, double x, double y, double z) {
  gp_Trsf move;
  move.SetTranslation(gp_Vec(x, y, z));
  return BRepBuilderAPI_Transform(shape, move, true).Shape();
}

}  // namespace

TEST_CASE("tessellate: every example part has the topology of its table, on its surfaces, linked both ways") {
  for (const ExamplePart& part : example_parts()) {
    CAPTURE(part.name);
    const Tessellated t = tessellated(example_part(part.name));
    check_topology(t);
    const SurfaceTopology counted = topology(t.mesh.triangles, t.mesh.neighbors);
    CHECK(counted == SurfaceTopology{part.components, part.loops, part.euler});
    check_geometry(t, 1e-6 * t.model.diagonal);
    std::set<int> faces(t.mesh.faces.begin(), t.mesh.faces.end());
    CHECK(static_cast<int>(faces.size()) == part.faces);
  }
}

TEST_CASE("tessellate: solids of planes, cylinders, cones, spheres and tori, whole and as loose faces") {
  for (const auto& solid : test::known_solids())
    for (const bool loose : {false, true}) {
      CAPTURE(solid.name);
      CAPTURE(loose);
      const Tessellated t = tessellated(make_shape(loose ? TopoDS_Shape(test::loose_faces(solid.shape)) : solid.shape));
      check_topology(t);
      CHECK(topology(t.mesh.triangles, t.mesh.neighbors) == SurfaceTopology{1, 0, solid.euler});
      check_geometry(t, 1e-6);
      CHECK(area_of(t.mesh) == doctest::Approx(solid.area).epsilon(0.02));
    }
}

TEST_CASE("tessellate: vertices lie on the shape and middles of triangles within the deflection") {
  for (const auto& solid : test::known_solids()) {
    CAPTURE(solid.name);
    const Tessellated t = tessellated(make_shape(solid.shape));
    CHECK(t.mesh.deflection == doctest::Approx(1e-3 * t.model.diagonal));
    const TopoDS_Shape surface = test::loose_faces(solid.shape);  // the distance to a solid is 0 inside it
    const auto distance = [&](const Vec3& p) {
      return BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(gp_Pnt(p[0], p[1], p[2])).Vertex(), surface).Value();
    };
    double vertex_error = 0, middle_error = 0;
    for (std::size_t v = 0; v < t.mesh.points.size(); v += 1 + t.mesh.points.size() / 20)
      vertex_error = std::max(vertex_error, distance(t.mesh.points[v]));
    for (std::size_t i = 0; i < t.mesh.triangles.size(); i += 1 + t.mesh.triangles.size() / 20) {
      const Triangle& q = t.mesh.triangles[i];
      middle_error =
          std::max(middle_error, distance((t.mesh.points[q[0]] + t.mesh.points[q[1]] + t.mesh.points[q[2]]) / 3));
    }
    CHECK(vertex_error < 1e-6);
    CHECK(middle_error < 2 * t.mesh.deflection);
  }
}

TEST_CASE("tessellate: a pole is one vertex, a seam is inside") {
  const double r = 7;
  const Tessellated t = tessellated(make_shape(BRepPrimAPI_MakeSphere(r).Shape()));
  for (const double z : {-r, r}) {
    long poles = 0;
    for (const Vec3& p : t.mesh.points) poles += (p - Vec3(0, 0, z)).norm() < 1e-9;
    CHECK(poles == 1);
  }
  for (const auto& row : t.mesh.neighbors)
    for (const std::int32_t n : row) CHECK(n >= 0);
  for (std::size_t i = 0; i < t.mesh.triangles.size(); ++i) CHECK(cross_of(t.mesh, i).norm() > 0);
  for (const Vec3& p : t.mesh.points) CHECK(p.norm() == doctest::Approx(r));
}

TEST_CASE("tessellate: the volume enclosed is positive, so the triangles face outward") {
  const std::vector<double> volumes{6000,           pi * 25 * 12, pi * 36 * 8 / 3, 4.0 / 3 * pi * 343, 2 * pi * pi * 90,
                                    6000 - pi * 160};
  const auto solids = test::known_solids();
  REQUIRE(solids.size() == volumes.size());
  for (std::size_t s = 0; s < solids.size(); ++s) {
    CAPTURE(solids[s].name);
    const Tessellated t = tessellated(make_shape(solids[s].shape));
    double volume = 0;
    for (const Triangle& q : t.mesh.triangles)
      volume += (t.mesh.points[q[0]] | (t.mesh.points[q[1]] % t.mesh.points[q[2]])) / 6;
    CHECK(volume == doctest::Approx(volumes[s]).epsilon(0.03));
  }
}

TEST_CASE("tessellate: solids that touch stay apart") {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(10, 10, 10).Shape();
  for (const auto& shift : {Vec3(10, 0, 0), Vec3(10, 10, 0), Vec3(10, 10, 10), Vec3(10, 3, 4)}) {  // a face, an edge, a
                                                                                                   // corner, part of a
                                                                                                   // face
    CAPTURE(shift);
    BRep_Builder builder;
    TopoDS_Compound both;
    builder.MakeCompound(both);
    builder.Add(both, box);
    builder.Add(both, moved(box, shift[0], shift[1], shift[2]));
    const Tessellated t = tessellated(make_shape(both));
    check_topology(t);
    CHECK(topology(t.mesh.triangles, t.mesh.neighbors) == SurfaceTopology{2, 0, 4});
  }
}

TEST_CASE("tessellate: edges of three and four faces are cut open, and every vertex keeps one fan") {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(10, 10, 10).Shape();
  for (const auto& [shift, edges] : {std::pair(Vec3(10, 0, 0), 4), {Vec3(10, 10, 0), 1}, {Vec3(10, 10, 10), 0}}) {
    CAPTURE(edges);
    BOPAlgo_Builder builder;
    builder.AddArgument(box);
    builder.AddArgument(moved(box, shift[0], shift[1], shift[2]));
    builder.Perform();
    const Tessellated t = tessellated(make_shape(builder.Shape()));
    CHECK(cad_topology(t.model).nonmanifold_edges == edges);
    check_topology(t);
  }
}

TEST_CASE("tessellate: finer is closer, and no face of the model is forgotten when it is coarse") {
  const Shape shape = example_part("elbow");
  const Tessellated coarse = tessellated(shape, 0.05), fine = tessellated(shape, 2e-4);
  check_topology(coarse);
  check_topology(fine);
  CHECK(fine.mesh.triangles.size() > coarse.mesh.triangles.size());
  CHECK(std::set<int>(coarse.mesh.faces.begin(), coarse.mesh.faces.end()).size() == coarse.model.faces.size());
  double model_area = 0;
  for (const CadFace& f : fine.model.faces) model_area += f.area;
  CHECK(area_of(fine.mesh) == doctest::Approx(model_area).epsilon(5e-3));
}

TEST_CASE("tessellate: a cancelled context throws") {
  const CadModel model = make_cad_model(make_shape(BRepPrimAPI_MakeBox(1, 2, 3).Shape()));
  Context context;
  context.cancel();
  CHECK_THROWS_AS(tessellate(model, 0.01, angle, context), Cancelled);
}

TEST_CASE("topology: counted on small meshes by hand") {
  CHECK(topology({}, {}) == SurfaceTopology{0, 0, 0});
  CHECK(topology({{0, 1, 2}}, {{-1, -1, -1}}) == SurfaceTopology{1, 1, 1});
  CHECK(topology({{0, 1, 2}, {7, 8, 9}}, {{-1, -1, -1}, {-1, -1, -1}}) == SurfaceTopology{2, 2, 2});
  // A tetrahedron.
  CHECK(topology({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, {{2, 1, 3}, {2, 3, 0}, {3, 1, 0}, {1, 2, 0}}) ==
        SurfaceTopology{1, 0, 2});
}

TEST_CASE("topology: a cancelled context ends the count of many triangles") {
  constexpr std::uint32_t n = 100'000;
  std::vector<Triangle> triangles(n);
  for (std::uint32_t t = 0; t < n; ++t) triangles[t] = {3 * t, 3 * t + 1, 3 * t + 2};
  const std::vector<std::array<std::int32_t, 3>> neighbors(n, {-1, -1, -1});
  Context context;
  CHECK(topology(triangles, neighbors, &context) == SurfaceTopology{n, n, n});
  context.cancel();
  CHECK_THROWS_AS(topology(triangles, neighbors, &context), Cancelled);
}

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>

#include "meshops/error.hpp"
#include "meshops/operators/remove_redundant.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

constexpr double off = pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Everything off; tests switch on what they test.
RemoveRedundantOptions nothing() {
  return {.length_factor = infinity,
          .max_angle = off,
          .max_neighbor_angle = off,
          .max_outside = 1,
          .max_boundary_angle = off};
}

/// A region of the plane z = 0 as a model: `inside` decides at the place itself.
struct PlanarReference : Reference {
  Mesh* mesh = nullptr;
  std::function<bool(const Vec3&)> contains = [](const Vec3&) { return true; };
  std::function<Vec3(const Vec3&)> normal_at = [](const Vec3&) { return Vec3(0, 0, 1); };

  Vec3 normal(VertexHandle a, VertexHandle b, VertexHandle c) const override {
    return normal_at((mesh->point(a) + mesh->point(b) + mesh->point(c)) / 3);
  }
  bool inside(VertexHandle a, VertexHandle b, VertexHandle c, const std::array<double, 3>& w) const override {
    return contains(mesh->point(a) * w[0] + mesh->point(b) * w[1] + mesh->point(c) * w[2]);
  }
  std::vector<ContourPair> contour_pairs(MeshView) const override { return {}; }
};

/// Answers at random, but the same for the same triangle: deletes faces all over the place.
struct RandomReference : PlanarReference {
  unsigned seed = 0, share = 50;
  Vec3 normal(VertexHandle a, VertexHandle b, VertexHandle c) const override {
    std::seed_seq mix{seed, unsigned(a.idx()), unsigned(b.idx()), unsigned(c.idx())};
    std::mt19937 random(mix);
    return random() % 100 < share ? Vec3(0, 0, -1) : Vec3(0, 0, 1);
  }
};

}  // namespace

TEST_CASE("remove_redundant: leaves a good mesh alone") {
  for (const bool keep : {false, true})
    for (Mesh mesh : {icosahedron(), grid(6, 4), tube(16, 4, 1, 0, 2).mesh(), Mesh()}) {
      const Snapshot before = snapshot(view_of(mesh));
      Context context;
      const Report report = remove_redundant(view_of(mesh), {.keep_vertices = keep}, context);
      CHECK(report.unchanged());
      CHECK(report.figures.empty());
      CHECK(snapshot(view_of(mesh)) == before);
    }
}

TEST_CASE("remove_redundant: two patches joined by long triangles come apart, at any scale") {
  for (const double scale : {1e-3, 1.0, 1e5}) {
    PatchShape s;
    s.nu = 21;
    s.nv = 8;
    s.point = [=](int i, int j) { return Vec3(i < 11 ? i : i + 8, j, 0) * scale; };  // the cells of column 10 are 9
                                                                                     // long
    Mesh mesh = s.mesh();
    Context context;
    const Report report = remove_redundant(view_of(mesh), {}, context);
    CHECK(report.faces_removed == 2 * 8);
    CHECK(report.figures.at("too long") == 16);
    CHECK(report.vertices_removed == 0);
    CHECK_VALID_MESH(mesh);
    CHECK(euler_characteristic(mesh) == 2);
    CHECK(boundary_loops(mesh) == 2);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(20 * 8 * scale * scale));
  }
}

TEST_CASE("remove_redundant: an absolute length takes the place of the factor") {
  PatchShape s;
  s.nu = 10;
  s.nv = 5;
  s.point = [](int i, int j) { return Vec3(i < 6 ? i : i + 1, j, 0); };  // one column of cells is 2 long: diagonal sqrt
                                                                         // 5
  RemoveRedundantOptions options = nothing();
  Context context;
  for (const double limit : {2.3, 2.1, 1.9}) {
    Mesh mesh = s.mesh();
    options.max_length = limit;
    CHECK(remove_redundant(view_of(mesh), options, context).faces_removed == (limit > std::sqrt(5.0) ? 0 : 10));
    CHECK_VALID_MESH(mesh);
  }
}

TEST_CASE("remove_redundant: triangles between the two sides of a thin sheet go by the normals at the vertices") {
  // A flat box without ends: 10 x 4 above and below, 0.2 apart, joined at the front by triangles that stand upright.
  PatchShape s;
  s.nu = 10;
  s.nv = 9;
  s.point = [](int i, int j) { return j < 5 ? Vec3(i, 4 - j, 0) : Vec3(i, j - 5, 0.2); };
  Mesh mesh = s.mesh();
  OpenMesh::VPropHandleT<Vec3> normals;
  mesh.add_property(normals, "v:reference_normal");
  for (const auto v : mesh.vertices()) mesh.property(normals, v) = Vec3(0, 0, mesh.point(v)[2] > 0.1 ? 1 : -1);
  Context context;
  const Report report = remove_redundant(view_of(mesh), {}, context);
  CHECK(report.faces_removed == 20);
  CHECK(report.figures.at("normal off") == 20);
  CHECK_VALID_MESH(mesh);
  CHECK(euler_characteristic(mesh) == 2);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(80));
}

TEST_CASE("remove_redundant: a flap that is folded over goes by its neighbours, a sharp edge stays") {
  Mesh cube =
      make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {{0, 2, 1},
                                                                                                           {0, 3, 2},
                                                                                                           {4, 5, 6},
                                                                                                           {4, 6, 7},
                                                                                                           {0, 1, 5},
                                                                                                           {0, 5, 4},
                                                                                                           {1, 2, 6},
                                                                                                           {1, 6, 5},
                                                                                                           {2, 3, 7},
                                                                                                           {2, 7, 6},
                                                                                                           {3, 0, 4},
                                                                                                           {3, 4, 7}});
  Context context;
  CHECK(remove_redundant(view_of(cube), {}, context).unchanged());

  Mesh mesh = grid(5, 5);
  const VertexHandle tip = mesh.add_vertex({2.5, 0.8, 0.05});
  mesh.add_face(VertexHandle(3), VertexHandle(2), tip);  // from the edge (2, 3) of the rim back over the sheet
  const Report report = remove_redundant(view_of(mesh), {}, context);
  CHECK(report.faces_removed == 1);
  CHECK(report.vertices_removed == 1);
  CHECK(report.touched_faces == std::vector<std::uint32_t>{50});
  CHECK(mesh.status(tip).deleted());
  CHECK_VALID_MESH(mesh);
}

TEST_CASE("remove_redundant: the boundary is peeled to a trimming curve, also through several layers") {
  PatchShape s;
  s.nu = s.nv = 60;
  s.point = [](int i, int j) { return Vec3(i - 30, j - 30, 0) * 0.1; };
  Mesh mesh = s.mesh();
  PlanarReference reference;
  reference.mesh = &mesh;
  reference.contains = [](const Vec3& p) {  // a disc with a notch
    return p.norm() < 2.5 && !(p[0] > 0 && std::abs(p[1]) < 0.75);
  };
  RemoveRedundantOptions options = nothing();
  options.reference = &reference;
  options.max_outside = 0.5;
  Context context;
  const Report report = remove_redundant(view_of(mesh), options, context);
  CHECK_VALID_MESH(mesh);
  CHECK(boundary_loops(mesh) == 1);
  CHECK(euler_characteristic(mesh) == 1);
  CHECK(report.faces_removed == report.touched_faces.size());
  CHECK(report.faces_removed == report.figures.at("outside the boundary") +
                                    (report.figures.count("at bow-ties") ? report.figures.at("at bow-ties") : 0));
  // The disc less its overlap with the strip, a closed form: a sector's sine part and a rectangle.
  const double r = 2.5, w = 0.75;
  const double strip = w * std::sqrt(r * r - w * w) + r * r * std::asin(w / r);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(pi * r * r - strip).epsilon(0.03));
  for (const auto f : mesh.faces()) {
    const Vec3 c = mesh.calc_face_centroid(f);
    CHECK(c.norm() < 2.6);
    CHECK_FALSE((c[0] > 0.15 && std::abs(c[1]) < 0.6));
  }
}

TEST_CASE("remove_redundant: slivers of a hull are peeled without a model") {
  // A row of points whose ends were joined by a hull edge: sagging 0.1 over a width of 10.
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i <= 10; ++i) points.push_back({double(i), 0.004 * (i - 5) * (i - 5), 0});
  for (int i = 0; i <= 10; ++i) points.push_back({double(i), -1, 0});
  for (int i = 0; i < 10; ++i) {
    triangles.push_back({i, 11 + i, 12 + i});
    triangles.push_back({i, 12 + i, i + 1});
  }
  for (int i = 1; i < 10; ++i) triangles.push_back({0, i, i + 1});  // the hull's fan over the sag
  Mesh mesh = make_mesh(points, triangles);
  RemoveRedundantOptions options = nothing();
  options.max_boundary_angle = 165 * pi / 180;
  Context context;
  const Report report = remove_redundant(view_of(mesh), options, context);
  CHECK(report.faces_removed == 9);
  CHECK_VALID_MESH(mesh);
  CHECK(boundary_loops(mesh) == 1);
  // None is left that it would peel.
  CHECK(remove_redundant(view_of(mesh), options, context).unchanged());
}

TEST_CASE(
    "remove_redundant: whatever is deleted, no bow-tie is left, and with keep_vertices every vertex keeps a face") {
  for (unsigned seed = 0; seed < 40; ++seed)
    for (const unsigned share : {10u, 35u, 60u, 90u})
      for (const bool keep : {false, true}) {
        Mesh mesh = seed % 2 ? grid(9, 7) : tube(9, 7, 1, 0, 5).mesh();
        RandomReference reference;
        reference.mesh = &mesh;
        reference.seed = seed;
        reference.share = share;
        if (seed % 2 == 0) {
          // On the tube normals are radial: judge by the sign that the reference gives at a vertical normal instead.
          for (const auto v : mesh.vertices())
            mesh.set_point(v, {mesh.point(v)[0] * (5 + mesh.point(v)[2]), mesh.point(v)[1] * (5 + mesh.point(v)[2]),
                               -mesh.point(v)[2]});
        }
        std::set<int> had_face;
        for (const auto v : mesh.vertices()) had_face.insert(v.idx());
        RemoveRedundantOptions options = nothing();
        options.reference = &reference;
        options.max_angle = pi / 2;
        options.keep_vertices = keep;
        const int faces = live_faces(mesh);
        Context context;
        const Report report = remove_redundant(view_of(mesh), options, context);
        CHECK_VALID_MESH(mesh);
        CHECK(live_faces(mesh) + static_cast<int>(report.faces_removed) == faces);
        std::set<int> has_face;
        for (const auto v : mesh.vertices())
          if (!mesh.is_isolated(v)) has_face.insert(v.idx());
        CHECK(has_face.size() + (keep ? 0 : report.vertices_removed) == had_face.size());
      }
}

TEST_CASE("remove_redundant: of two fans at a vertex the larger stays") {
  // Deleting the middle column leaves one whole half and one triangle that hang together in a vertex.
  Mesh mesh = grid(4, 1);
  PlanarReference reference;
  reference.mesh = &mesh;
  reference.normal_at = [](const Vec3& c) { return Vec3(0, 0, c[0] > 2.5 && c[0] < 2.8 ? -1 : 1); };  // face (2 0, 3 0,
                                                                                                      // 3 1)... of cell
                                                                                                      // 2
  RemoveRedundantOptions options = nothing();
  options.reference = &reference;
  options.max_angle = pi / 2;
  Context context;
  const Report report = remove_redundant(view_of(mesh), options, context);
  CHECK_VALID_MESH(mesh);
  CHECK(report.faces_removed == 2);
  CHECK(report.figures.at("normal off") == 1);
}

TEST_CASE("remove_redundant: bad options are errors, cancel comes before any change") {
  Mesh mesh = bumpy_grid(5, 5);
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  CHECK_THROWS_AS(remove_redundant(view_of(mesh), {.length_factor = 0.5}, context), InvalidInput);
  CHECK_THROWS_AS(remove_redundant(view_of(mesh), {.max_outside = 2}, context), InvalidInput);
  CHECK_THROWS_AS(remove_redundant(view_of(mesh), {.max_angle = -1}, context), InvalidInput);
  context.cancel();
  CHECK_THROWS_AS(remove_redundant(view_of(mesh), {.max_length = 0.1}, context), Cancelled);
  CHECK(snapshot(view_of(mesh)) == before);
}

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "meshops/error.hpp"
#include "meshops/operators/stitch_contours.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Several patches in one mesh.
struct Patches {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;

  int add(const PatchShape& shape) {
    const int offset = static_cast<int>(points.size());
    for (const Vec3& p : shape.points()) points.push_back(p);
    for (const auto& t : shape.triangles()) triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    return offset;
  }
  Mesh mesh() const { return make_mesh(points, triangles); }
};

/// A flat patch from corner `o` along `u` (nu cells) and `v` (nv cells); its front is u x v.
PatchShape flat(const Vec3& o, const Vec3& u, const Vec3& v, int nu, int nv) {
  PatchShape s;
  s.nu = nu;
  s.nv = nv;
  s.point = [=](int i, int j) { return o + u * (double(i) / nu) + v * (double(j) / nv); };
  return s;
}

/// The six sides of a box from 0 to `size`, each drawn back from the box's edges by `gap`.
Patches open_box(double size, double gap, std::array<int, 6> cells) {
  Patches patches;
  const double a = gap, l = size - 2 * gap;
  const Vec3 x(l, 0, 0), y(0, l, 0), z(0, 0, l);
  patches.add(flat({a, a, size}, x, y, cells[0], cells[0]));
  patches.add(flat({a, a, 0}, y, x, cells[1], cells[1]));
  patches.add(flat({a, 0, a}, x, z, cells[2], cells[2]));
  patches.add(flat({a, size, a}, z, x, cells[3], cells[3]));
  patches.add(flat({0, a, a}, z, y, cells[4], cells[4]));
  patches.add(flat({size, a, a}, y, z, cells[5], cells[5]));
  return patches;
}

/// Area between two coaxial regular polygons of the same radius and number, `h` apart, aligned: rectangles.
double band_area(int n, double r, double h) {
  return n * 2 * r * std::sin(pi / n) * h;
}

}  // namespace

TEST_CASE("stitch_contours: joins the facing rims of two tubes") {
  for (const int n : {12, 24, 60}) {
    const double side = 2 * pi / n;
    Patches patches;
    patches.add(tube(n, 6, 1, 0, 6 * side));
    patches.add(tube(n, 6, 1, 7.5 * side, 13.5 * side));
    Mesh mesh = patches.mesh();
    const double before = mesh_area(view_of(mesh));
    const auto faces = mesh.n_faces();
    Context context;
    const Report report = stitch_contours(view_of(mesh), {}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(report.faces_added == 2u * n);
    CHECK(mesh.n_faces() == faces + 2u * n);
    CHECK(boundary_loops(mesh) == 2);
    CHECK(euler_characteristic(mesh) == 0);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(before + band_area(n, 1, 1.5 * side)));
    CHECK(stitch_contours(view_of(mesh), {}, context).unchanged());
  }
}

TEST_CASE("stitch_contours: rims with different numbers of points are joined without a fold") {
  for (const int n : {9, 17, 40, 41}) {
    Patches patches;
    patches.add(tube(29, 3, 1, 0, 0.6));
    patches.add(tube(n, 3, 1, 0.8, 1.4));
    Mesh mesh = patches.mesh();
    Context context;
    const Report report = stitch_contours(view_of(mesh), {}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(report.faces_added == 29u + n);
    CHECK(boundary_loops(mesh) == 2);
    CHECK(euler_characteristic(mesh) == 0);
    for (const auto f : report.touched_faces) {
      const FaceHandle face(static_cast<int>(f));
      const Vec3 c = mesh.calc_face_centroid(face);
      CHECK((mesh.calc_face_normal(face) | Vec3(c[0], c[1], 0).normalized()) > 0.7);
    }
  }
}

TEST_CASE("stitch_contours: open contours of two flat patches, evenly and unevenly sampled") {
  for (const int n : {10, 13, 21}) {
    Patches patches;
    patches.add(flat({0, 0, 0}, {10, 0, 0}, {0, 5, 0}, 10, 5));
    patches.add(flat({0, 5.8, 0}, {10, 0, 0}, {0, 4, 0}, n, 4));
    Mesh mesh = patches.mesh();
    Context context;
    const Report report = stitch_contours(view_of(mesh), {}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(report.faces_added == 10u + n);
    CHECK(boundary_loops(mesh) == 1);
    CHECK(euler_characteristic(mesh) == 1);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx(10 * 9.8));
    for (const auto f : mesh.faces()) CHECK(mesh.calc_face_normal(f)[2] > 0.99);
  }
}

TEST_CASE("stitch_contours: a slit in one patch and the seam of a rolled patch are closed") {
  PatchShape rolled;
  rolled.nu = 30;
  rolled.nv = 12;
  rolled.point = [](int i, int j) {
    const double angle = (2 * pi - 0.25) * i / 30;
    return Vec3(std::cos(angle), std::sin(angle), 0.2 * j);
  };
  Mesh mesh = rolled.mesh();
  Context context;
  CHECK(stitch_contours(view_of(mesh), {}, context).faces_added == 24);
  CHECK_VALID_MESH(mesh);
  CHECK(boundary_loops(mesh) == 2);
  CHECK(euler_characteristic(mesh) == 0);

  PatchShape slit;
  slit.nu = slit.nv = 21;
  slit.keep = [](int i, int j) { return !(j == 10 && i >= 4 && i < 17); };
  Mesh sheet = slit.mesh();
  stitch_contours(view_of(sheet), {}, context);
  CHECK_VALID_MESH(sheet);
  CHECK(boundary_loops(sheet) == 1);
  CHECK(mesh_area(view_of(sheet)) == doctest::Approx(21 * 21));
}

TEST_CASE("stitch_contours: four patches that meet in the plane come out as one sheet without a hole") {
  for (const double gap : {0.3, 0.8, 1.5}) {
    Patches patches;
    patches.add(flat({0, 0, 0}, {6, 0, 0}, {0, 6, 0}, 6, 6));
    patches.add(flat({6 + gap, 0, 0}, {6, 0, 0}, {0, 6, 0}, 6, 7));
    patches.add(flat({0, 6 + gap, 0}, {6, 0, 0}, {0, 6, 0}, 5, 6));
    patches.add(flat({6 + gap, 6 + gap, 0}, {6, 0, 0}, {0, 6, 0}, 6, 6));
    Mesh mesh = patches.mesh();
    Context context;
    const Report report = stitch_contours(view_of(mesh), {}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(boundary_loops(mesh) == 1);
    CHECK(euler_characteristic(mesh) == 1);
    CHECK(mesh_area(view_of(mesh)) == doctest::Approx((12 + gap) * (12 + gap)));
    CHECK(report.faces_added > 0);
  }
}

TEST_CASE("stitch_contours: a T of three patches comes out joined") {
  Patches patches;
  patches.add(flat({0, 0, 0}, {12, 0, 0}, {0, 5, 0}, 12, 5));
  patches.add(flat({0, 5.7, 0}, {5.6, 0, 0}, {0, 5, 0}, 6, 5));
  patches.add(flat({6.4, 5.7, 0}, {5.6, 0, 0}, {0, 5, 0}, 5, 5));
  Mesh mesh = patches.mesh();
  Context context;
  stitch_contours(view_of(mesh), {}, context);
  CHECK_VALID_MESH(mesh);
  CHECK(boundary_loops(mesh) == 1);
  CHECK(euler_characteristic(mesh) == 1);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(12 * 10.7));
}

TEST_CASE("stitch_contours: six sides of a box become a closed box with its corners cut") {
  for (const auto& cells : {std::array{8, 8, 8, 8, 8, 8}, std::array{8, 9, 10, 7, 8, 11}}) {
    Patches patches = open_box(10, 0.5, cells);
    Mesh mesh = patches.mesh();
    Context context;
    const Report report = stitch_contours(view_of(mesh), {}, context);
    CHECK_VALID_MESH(mesh);
    CHECK(boundary_loops(mesh) == 0);
    CHECK(euler_characteristic(mesh) == 2);
    CHECK(report.skipped.empty());
    // The convex hull of the six squares: a box whose 12 edges and 8 corners are cut off, and an inner box that bounds
    // it.
    const double g = 0.5, l = 9;
    const double hull = 1000 - 12 * l * g * g / 2 - 8 * (g * g * g - g * g * g / 6);
    CHECK(mesh_volume(view_of(mesh)) <= hull * (1 + 1e-9));
    CHECK(mesh_volume(view_of(mesh)) > hull - 8 * g * g * g);
  }
}

TEST_CASE("stitch_contours: noisy, ragged, even overlapping patches make one closed box, without a handle") {
  struct Case {
    double height, gap, jitter;
  };
  for (const Case& c : {Case{12, 0.5, 0.2}, {12, 0.3, 0.3}, {12, 0.1, 0.1}, {3, 0.5, 0.3}, {1.5, 0.3, 0.2}})
    for (unsigned seed = 0; seed < 8; ++seed) {
      CAPTURE(c.height);
      CAPTURE(c.gap);
      CAPTURE(c.jitter);
      CAPTURE(seed);
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> jitter(-c.jitter, c.jitter), density(0.7, 1.4);
      const double a = c.gap, l = 12 - 2 * a, h = c.height - 2 * a;
      const Vec3 x(l, 0, 0), y(0, l, 0), z(0, 0, h);
      const auto cells = [&](double length) { return std::max(1, static_cast<int>(length * density(random))); };
      Patches patches;
      patches.add(flat({a, a, c.height}, x, y, cells(l), cells(l)));
      patches.add(flat({a, a, 0}, y, x, cells(l), cells(l)));
      patches.add(flat({a, 0, a}, x, z, cells(l), cells(h)));
      patches.add(flat({a, 12, a}, z, x, cells(h), cells(l)));
      patches.add(flat({0, a, a}, z, y, cells(h), cells(l)));
      patches.add(flat({12, a, a}, y, z, cells(l), cells(h)));
      for (Vec3& p : patches.points) p += Vec3(jitter(random), jitter(random), jitter(random));
      Mesh mesh = patches.mesh();
      const auto vertices = mesh.n_vertices();
      Context context;
      stitch_contours(view_of(mesh), {}, context);
      CHECK_VALID_MESH(mesh);
      CHECK(mesh.n_vertices() == vertices);
      CHECK(boundary_loops(mesh) == 0);
      CHECK(euler_characteristic(mesh) == 2);
      CHECK(mesh_volume(view_of(mesh)) == doctest::Approx(12 * 12 * c.height).epsilon(c.height > 10 ? 0.05 : 0.15));
    }
}

TEST_CASE("stitch_contours: an opening of the part between patches stays open, the gap beside it is closed") {
  // Two halves of a sheet with a gap of 0.6; each has a notch in the middle of its rim, which together make an opening
  // of 6 x 6.6.
  Patches patches;
  for (int half = 0; half < 2; ++half) {
    PatchShape s;
    s.nu = 18;
    s.nv = 8;
    s.point = [=](int i, int j) { return Vec3(i, half == 0 ? j : 8.6 + j, 0); };
    s.keep = [=](int i, int j) { return !(i >= 6 && i < 12 && (half == 0 ? j >= 5 : j < 3)); };
    patches.add(s);
  }
  Mesh mesh = patches.mesh();
  Context context;
  stitch_contours(view_of(mesh), {}, context);
  CHECK_VALID_MESH(mesh);
  CHECK(boundary_loops(mesh) == 2);
  CHECK(euler_characteristic(mesh) == 0);
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(18 * 16.6 - 6 * 6.6));
}

TEST_CASE("stitch_contours: gaps wider than max_gap, rims side by side and sheets back to back stay open") {
  const auto untouched = [](Mesh mesh, const StitchContoursOptions& options) {
    const Snapshot before = snapshot(view_of(mesh));
    Context context;
    const Report report = stitch_contours(view_of(mesh), options, context);
    CHECK(report.unchanged());
    CHECK(snapshot(view_of(mesh)) == before);
  };
  Patches far;
  far.add(flat({0, 0, 0}, {10, 0, 0}, {0, 5, 0}, 10, 5));
  far.add(flat({0, 10, 0}, {10, 0, 0}, {0, 5, 0}, 10, 5));
  untouched(far.mesh(), {});
  untouched(far.mesh(), {.max_distance = 4.9});
  untouched(grid(8, 8), {});
  untouched(icosahedron(), {});
  untouched(Mesh(), {});
  // Two sheets with the same front, one above the other: their rims run the same way.
  Patches stacked;
  stacked.add(flat({0, 0, 0}, {10, 0, 0}, {0, 10, 0}, 10, 10));
  stacked.add(flat({0, 0, 1}, {10, 0, 0}, {0, 10, 0}, 10, 10));
  untouched(stacked.mesh(), {});
  // A wide enough hole is no gap.
  PatchShape hole;
  hole.nu = hole.nv = 20;
  hole.keep = [](int i, int j) { return !(i >= 5 && i < 13 && j >= 5 && j < 13); };
  untouched(hole.mesh(), {});
}

TEST_CASE("stitch_contours: given pairs are joined however far apart, by property and by reference") {
  struct Given : Reference {
    std::vector<ContourPair> pairs;
    Vec3 normal(VertexHandle, VertexHandle, VertexHandle) const override { return {0, 0, 0}; }
    bool inside(VertexHandle, VertexHandle, VertexHandle, const std::array<double, 3>&) const override { return true; }
    std::vector<ContourPair> contour_pairs(MeshView) const override { return pairs; }
  };
  Patches patches;
  const PatchShape lower = tube(20, 3, 1, 0, 1), upper = tube(14, 3, 1.5, 4, 5);
  patches.add(lower);
  const int offset = patches.add(upper);
  Context context;

  Mesh mesh = patches.mesh();
  OpenMesh::EPropHandleT<int> mark;
  mesh.add_property(mark, "e:contour_pair");
  for (const auto e : mesh.edges()) {
    mesh.property(mark, e) = -1;
    if (!mesh.is_boundary(e)) continue;
    const double z = mesh.calc_edge_midpoint(e)[2];
    if (z > 0.5 && z < 4.5) mesh.property(mark, e) = 3;
  }
  const Report report = stitch_contours(view_of(mesh), {}, context);
  CHECK(report.faces_added == 34);
  CHECK_VALID_MESH(mesh);
  CHECK(boundary_loops(mesh) == 2);
  CHECK(euler_characteristic(mesh) == 0);

  Given given;
  given.pairs.push_back({{}, {}, true});
  for (int i = 0; i < 20; ++i) given.pairs[0].first.push_back(lower.vertex(20 - i, 3));
  for (int i = 0; i < 14; ++i) given.pairs[0].second.push_back(VertexHandle(offset + upper.vertex(i, 0).idx()));
  Mesh other = patches.mesh();
  // Whichever way a rim runs is the mesh's affair: turn the lists round where they run against the boundary.
  for (auto* contour : {&given.pairs[0].first, &given.pairs[0].second})
    if (!other.is_boundary(other.find_halfedge((*contour)[0], (*contour)[1])))
      std::reverse(contour->begin(), contour->end());
  CHECK(stitch_contours(view_of(other), {.reference = &given}, context).faces_added == 34);
  CHECK_VALID_MESH(other);
  CHECK(euler_characteristic(other) == 0);
  for (const auto f : other.faces()) {
    const Vec3 c = other.calc_face_centroid(f);
    CHECK((other.calc_face_normal(f) | Vec3(c[0], c[1], 0)) > 0);
  }

  // Against the boundary, or no boundary at all: refused, the mesh stays.
  const Snapshot before = snapshot(view_of(other));
  const Report refused = stitch_contours(view_of(other), {.pairs = ContourPairs::given, .reference = &given}, context);
  CHECK(refused.unchanged());
  CHECK(refused.skipped == decltype(refused.skipped){{"contour is not a free boundary", 1}});
  CHECK(snapshot(view_of(other)) == before);
}

TEST_CASE("stitch_contours: an edge property that names no pair is counted and skipped") {
  Mesh mesh = tube(12, 3, 1, 0, 1).mesh();
  OpenMesh::EPropHandleT<int> mark;
  mesh.add_property(mark, "e:contour_pair");
  for (const auto e : mesh.edges())
    mesh.property(mark, e) = mesh.is_boundary(e) && mesh.calc_edge_midpoint(e)[2] > 0.5 ? 0 : -1;
  Context context;
  const Report report = stitch_contours(view_of(mesh), {.pairs = ContourPairs::given}, context);
  CHECK(report.unchanged());
  CHECK(report.skipped == decltype(report.skipped){{"pair without two contours", 1}});
}

TEST_CASE("stitch_contours: a pair that would need flipped triangles is left open") {
  // Two patches that overlap: every strip between the rims beneath each other would fold back.
  Patches patches;
  patches.add(flat({0, 0, 0}, {10, 0, 0}, {0, 5, 0}, 10, 5));
  patches.add(flat({0, 3.5, 0}, {10, 0, 0}, {0, 5, 0}, 10, 5));
  Mesh mesh = patches.mesh();
  OpenMesh::EPropHandleT<int> mark;
  mesh.add_property(mark, "e:contour_pair");
  for (const auto e : mesh.edges()) {
    const double y = mesh.calc_edge_midpoint(e)[1];
    mesh.property(mark, e) = mesh.is_boundary(e) && (y == 5 || y == 3.5) && mesh.calc_edge_vector(e)[1] == 0 ? 0 : -1;
  }
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  const Report report = stitch_contours(view_of(mesh), {.pairs = ContourPairs::given}, context);
  CHECK(report.unchanged());
  CHECK(report.skipped == decltype(report.skipped){{"contours do not fit", 1}});
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("stitch_contours: bad options are errors; cancel leaves a valid mesh") {
  Patches patches = open_box(10, 0.5, {8, 8, 8, 8, 8, 8});
  Mesh mesh = patches.mesh();
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  CHECK_THROWS_AS(stitch_contours(view_of(mesh), {.max_gap = 0}, context), InvalidInput);
  CHECK_THROWS_AS(stitch_contours(view_of(mesh), {.max_corner_edges = -1}, context), InvalidInput);
  CHECK(snapshot(view_of(mesh)) == before);
  int calls = 0;
  context.on_progress = [&](std::string_view, double) {
    if (++calls == 2) context.cancel();
  };
  CHECK_THROWS_AS(stitch_contours(view_of(mesh), {}, context), Cancelled);
  CHECK_VALID_MESH(mesh);
}

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "meshops/error.hpp"
#include "meshops/shape/features.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Features find(Mesh& mesh, const FeatureRules& rules = {}) {
  return find_features(view_of(mesh), rules, Context());
}

std::size_t count(const Features& features, VertexClass c) {
  return static_cast<std::size_t>(std::ranges::count(features.vertices, c));
}
std::size_t count(const Features& features, EdgeClass c) {
  return static_cast<std::size_t>(std::ranges::count(features.edges, c));
}

/// The surface of the cube [0, n]^3 with unit cells.
Mesh split_cube(int n) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  const auto vertex = [&](int x, int y, int z) {
    const Vec3 p(x, y, z);
    const auto it = std::ranges::find(points, p);
    if (it != points.end()) return static_cast<int>(it - points.begin());
    points.push_back(p);
    return static_cast<int>(points.size()) - 1;
  };
  const auto quad = [&](int a, int b, int c, int d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      quad(vertex(i, j, 0), vertex(i, j + 1, 0), vertex(i + 1, j + 1, 0), vertex(i + 1, j, 0));
      quad(vertex(i, j, n), vertex(i + 1, j, n), vertex(i + 1, j + 1, n), vertex(i, j + 1, n));
      quad(vertex(i, 0, j), vertex(i + 1, 0, j), vertex(i + 1, 0, j + 1), vertex(i, 0, j + 1));
      quad(vertex(i, n, j), vertex(i, n, j + 1), vertex(i + 1, n, j + 1), vertex(i + 1, n, j));
      quad(vertex(0, i, j), vertex(0, i, j + 1), vertex(0, i + 1, j + 1), vertex(0, i + 1, j));
      quad(vertex(n, i, j), vertex(n, i + 1, j), vertex(n, i + 1, j + 1), vertex(n, i, j + 1));
    }
  return make_mesh(points, triangles);
}

/// A roof with its ridge along y at x = 0; `height(j)` of the ridge at y = j, eaves at x = -1 and 1.
Mesh roof(int n, const std::function<double(int)>& height) {
  PatchShape s;
  s.nu = 2;
  s.nv = n;
  s.point = [=](int i, int j) { return Vec3(i - 1, j, i == 1 ? height(j) : 0.0); };
  return s.mesh();
}

}  // namespace

TEST_CASE("find_features: a cube has twelve creases and eight corners, and its faces are smooth") {
  for (const int n : {1, 2, 5}) {
    Mesh mesh = split_cube(n);
    const Features features = find(mesh);
    CHECK(features.creases == static_cast<std::size_t>(12 * n));
    CHECK(features.corners == 8);
    CHECK(count(features, VertexClass::corner) == 8);
    CHECK(count(features, VertexClass::crease) == static_cast<std::size_t>(12 * (n - 1)));
    CHECK(count(features, VertexClass::smooth) == mesh.n_vertices() - 8 - 12 * (static_cast<std::size_t>(n) - 1));
    for (const VertexHandle v : mesh.vertices()) {
      int extremes = 0;
      for (int k = 0; k < 3; ++k) extremes += mesh.point(v)[k] == 0 || mesh.point(v)[k] == n;
      CHECK(features[v] == (extremes == 3   ? VertexClass::corner
                            : extremes == 2 ? VertexClass::crease
                                            : VertexClass::smooth));
    }
    for (const EdgeHandle e : mesh.edges()) CHECK(features.is_feature(e) == (features[e] == EdgeClass::crease));
  }
}

TEST_CASE("find_features: the angle decides which facets of a prism meet in a crease") {
  Mesh mesh = tube(12, 3, 2, 0, 5).mesh();  // 30 degrees between facets, open at both ends
  const Features wide = find(mesh, {.angle = 31 * pi / 180});
  CHECK(wide.creases == 0);
  CHECK(count(wide, EdgeClass::boundary) == 24);
  CHECK(count(wide, VertexClass::boundary) == 24);
  CHECK(wide.corners == 0);
  const Features narrow = find(mesh, {.angle = 29 * pi / 180});
  CHECK(narrow.creases == 12 * 3);
  CHECK(count(narrow, VertexClass::crease) == 12 * 2);
  CHECK(narrow.corners == 24);  // where a crease meets the rim
  CHECK(find(mesh, {.angle = pi}).creases == 0);
}

TEST_CASE("find_features: the corner angle decides where a boundary turns") {
  Mesh mesh = grid(3, 4);
  CHECK(find(mesh).corners == 4);
  CHECK(find(mesh, {.corner_angle = 91 * pi / 180}).corners == 0);
  CHECK(count(find(mesh, {.corner_angle = 91 * pi / 180}), VertexClass::boundary) == 14);
  // Twelve sides turn by 30 degrees each.
  Mesh prism = tube(12, 1, 2, 0, 5).mesh();
  CHECK(find(prism, {.corner_angle = 29 * pi / 180}).corners == 24);
}

TEST_CASE("find_features: a crease that fades out ends in a dart") {
  // Slope 1 on both sides (90 degrees) falls to 0 along the ridge.
  Mesh mesh = roof(8, [](int j) { return j < 4 ? 1.0 : 0.0; });
  const Features features = find(mesh, {.angle = 80 * pi / 180});
  CHECK(features.creases == 3);
  CHECK(count(features, VertexClass::dart) == 1);
  CHECK(features[VertexHandle(3 * 3 + 1)] == VertexClass::dart);
  CHECK(features[VertexHandle(3 * 2 + 1)] == VertexClass::crease);
  CHECK(features[VertexHandle(0 * 3 + 1)] == VertexClass::corner);
}

TEST_CASE("find_features: creases of fewer connected edges than asked for are noise") {
  Mesh mesh = roof(8, [](int j) { return j < 4 ? 1.0 : 0.0; });
  CHECK(find(mesh, {.angle = 80 * pi / 180, .min_crease_edges = 3}).creases == 3);
  const Features none = find(mesh, {.angle = 80 * pi / 180, .min_crease_edges = 4});
  CHECK(none.creases == 0);
  CHECK(count(none, VertexClass::dart) == 0);
  CHECK(count(none, VertexClass::boundary) + none.corners == 20);
}

TEST_CASE("find_features: a sliver on a crease leaves the crease one line, and makes none in a plane") {
  // A roof of two squares; the ridge a b has a vertex c on it, known to one side only: triangle a b c has no area.
  const double s = 1e-9;
  for (const double off : {0.0, s, -s}) {
    Mesh mesh = make_mesh({{0, 0, 1}, {0, 4, 1}, {off, 2, 1}, {-2, 0, 0}, {-2, 4, 0}, {2, 0, 0}, {2, 4, 0}},
                          {{0, 1, 2}, {0, 4, 1}, {0, 3, 4}, {0, 2, 5}, {2, 6, 5}, {2, 1, 6}});
    const Features features = find(mesh, {.angle = 0.3});
    int along = 0;
    for (const EdgeHandle e : mesh.edges()) along += features[e] == EdgeClass::crease;
    CHECK(along == 2);
    CHECK(features[mesh.edge_handle(mesh.find_halfedge(VertexHandle(0), VertexHandle(1)))] == EdgeClass::smooth);
    CHECK(features[VertexHandle(2)] == VertexClass::crease);
  }
  Mesh plane = make_mesh({{0, 0, 0}, {4, 0, 0}, {2, 0, 1e-9}, {2, 3, 0}, {2, -3, 0}},
                         {{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {1, 0, 4}});
  CHECK(find(plane, {.angle = 0.01}).creases == 0);
  for (const Vec3& n : robust_face_normals(view_of(plane), Context())) CHECK(n[2] == doctest::Approx(1));
}

TEST_CASE("find_features: deleted elements, points that are not finite and faces folded to a line") {
  Mesh mesh = split_cube(2);
  mesh.delete_face(FaceHandle(0), true);
  mesh.point(VertexHandle(5))[1] = std::nan("");
  mesh.point(VertexHandle(9))[2] = std::numeric_limits<double>::infinity();
  const Features features = find(mesh);
  CHECK(features.edges.size() == mesh.n_edges());
  CHECK(count(features, EdgeClass::boundary) == 3);
  Mesh line = make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {2, 1, 3}});
  CHECK(find(line).creases == 0);
  for (const Vec3& n : robust_face_normals(view_of(line), Context())) CHECK(n == Vec3(0, 0, 0));
  Mesh empty;
  CHECK(find(empty).edges.empty());
}

TEST_CASE("find_features: the same for any number of threads; cancel is heeded") {
  Mesh mesh = bumpy_grid(90, 60);
  Context one;
  one.threads = 1;
  const FeatureRules rules{.angle = 0.2, .corner_angle = 0.5, .min_crease_edges = 3};
  const Features a = find_features(view_of(mesh), rules, one), b = find(mesh, rules);
  CHECK(a.creases > 0);
  CHECK(a.edges == b.edges);
  CHECK(a.vertices == b.vertices);
  Context cancelled;
  cancelled.cancel();
  CHECK_THROWS_AS(find_features(view_of(mesh), rules, cancelled), Cancelled);
}

TEST_CASE("find_features: noise makes no creases where it is allowed for, and true ones stay") {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.2);
  Mesh plane = grid(40, 40), block = split_cube(12);
  const Features exact = find(block);
  for (const VertexHandle v : plane.vertices()) plane.point(v)[2] += noise(random);
  for (const VertexHandle v : block.vertices()) {
    const Vec3 p = block.point(v);
    for (int k = 0; k < 3; ++k)
      if (p[k] == 0 || p[k] == 12) block.point(v)[k] += noise(random);
  }
  const double angle = 44 * pi / 180;
  CHECK(find(plane, {.angle = angle}).creases > 100);
  for (const Noise rule : {Noise::present, Noise::unknown}) {
    CHECK(find(plane, {.angle = angle, .noise = rule}).creases < 20);
    const Features features = find(block, {.angle = angle, .noise = rule});
    std::size_t kept = 0;
    for (const EdgeHandle e : block.edges()) kept += features.is_feature(e) && exact.is_feature(e);
    CHECK(kept > 0.9 * static_cast<double>(exact.creases));
    CHECK(features.creases - kept < 0.02 * static_cast<double>(block.n_edges()));
  }
  // A box with a step of one row of triangles: exact, so nothing is taken for noise where that is not known.
  Mesh step = roof(10, [](int) { return 0.0; });
  for (const VertexHandle v : step.vertices())
    if (step.point(v)[0] > -0.5) step.point(v)[2] = 1;
  CHECK(find(step, {.noise = Noise::unknown}).creases == find(step).creases);
}

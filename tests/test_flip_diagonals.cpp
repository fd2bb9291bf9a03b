#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "mesh_check.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/flip_diagonals.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report flip(Mesh& mesh, const FlipDiagonalsOptions& options = {}) {
  Context context;
  const Report report = flip_diagonals(view_of(mesh), options, context);
  CHECK_VALID_MESH(mesh);
  return report;
}

bool joined(const Mesh& mesh, int a, int b) {
  return mesh.find_halfedge(VertexHandle(a), VertexHandle(b)).is_valid();
}

std::array<Vec3, 3> corners(const Mesh& mesh, FaceHandle f) {
  std::array<Vec3, 3> p;
  int k = 0;
  for (const VertexHandle v : mesh.fv_range(f)) p[k++] = mesh.point(v);
  return p;
}

Vec3 unit_normal(const Mesh& mesh, FaceHandle f) {
  const auto [a, b, c] = corners(mesh, f);
  return ((b - a) % (c - a)).normalized();
}

/// The sum of what the angles at inner edges exceed `sharp` by: the first part of the promised order, straight from its
/// words.
double excess(const Mesh& mesh, double sharp) {
  double sum = 0;
  for (const EdgeHandle e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const Vec3 m = unit_normal(mesh, mesh.face_handle(mesh.halfedge_handle(e, 0)));
    const Vec3 n = unit_normal(mesh, mesh.face_handle(mesh.halfedge_handle(e, 1)));
    sum += std::max(0.0, std::acos(std::clamp(m | n, -1.0, 1.0)) - sharp);
  }
  return sum;
}

std::vector<double> sorted_smallest_angles(const Mesh& mesh) {
  std::vector<double> angles;
  for (const FaceHandle f : mesh.faces()) {
    const auto p = corners(mesh, f);
    double smallest = pi;
    for (int k = 0; k < 3; ++k) {
      const Vec3 x = (p[(k + 1) % 3] - p[k]).normalized(), y = (p[(k + 2) % 3] - p[k]).normalized();
      smallest = std::min(smallest, std::acos(std::clamp(x | y, -1.0, 1.0)));
    }
    angles.push_back(smallest);
  }
  std::ranges::sort(angles);
  return angles;
}

/// A flat grid whose inner vertices are moved by up to 0.25 of the spacing.
Mesh jittered_plane(int n, unsigned seed) {
  Mesh mesh = grid(n, n);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.25, 0.25);
  for (const VertexHandle v : mesh.vertices()) {
    const double x = shift(random), y = shift(random);
    if (!mesh.is_boundary(v)) mesh.point(v) += Vec3(x, y, 0);
  }
  return mesh;
}

}  // namespace

TEST_CASE("flip_diagonals: a flat quadrilateral gets the diagonal with the larger smallest angle, and keeps it") {
  Mesh mesh = make_mesh({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}}, {{3, 0, 1}, {1, 2, 3}});
  const Report report = flip(mesh);
  CHECK(report.edges_flipped == 1);
  CHECK(report.touched_faces == std::vector<std::uint32_t>{0, 1});
  CHECK(joined(mesh, 0, 2));
  CHECK_FALSE(joined(mesh, 1, 3));
  CHECK(report.figures.at("smallest angle after") == doctest::Approx(2 * std::atan2(1, 3) * 180 / pi));
  CHECK(flip(mesh).unchanged());
}

TEST_CASE("flip_diagonals: a square stays as it is") {
  Mesh mesh = grid(4, 4);
  const Snapshot before = snapshot(view_of(mesh));
  CHECK(flip(mesh).unchanged());
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("flip_diagonals: a flat quadrilateral with a reflex corner is not folded") {
  Mesh mesh = make_mesh({{0, 0, 0}, {4, -1, 0}, {0, 4, 0}, {0.2, 0.2, 0}}, {{0, 1, 3}, {0, 3, 2}});
  CHECK(flip(mesh).unchanged());
}

TEST_CASE("flip_diagonals: a plane becomes Delaunay") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Mesh mesh = jittered_plane(20, seed);
    CHECK(flip(mesh).edges_flipped > 0);
    for (const EdgeHandle e : mesh.edges()) {
      if (mesh.is_boundary(e)) continue;
      const HalfedgeHandle h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
      const Vec3 a = mesh.point(mesh.to_vertex_handle(o)), b = mesh.point(mesh.to_vertex_handle(h));
      const Vec3 c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
      const Vec3 d = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(o)));
      // Angles opposite a Delaunay edge add up to pi at most.
      const double at_c = std::atan2(((a - c) % (b - c)).norm(), (a - c) | (b - c));
      const double at_d = std::atan2(((a - d) % (b - d)).norm(), (a - d) | (b - d));
      CHECK(at_c + at_d <= pi + 1e-9);
    }
  }
}

TEST_CASE("flip_diagonals: edges are laid along the ridge of a roof, whatever their shape") {
  // Ridge vertices 0..n along y; eaves on both sides, half a step off. The start crosses the ridge at every step.
  const int n = 6;
  std::vector<Vec3> points;
  for (int i = 0; i <= n; ++i) points.emplace_back(0, 3 * i, 1);
  for (const double x : {-1.0, 1.0})
    for (int i = 0; i < n; ++i) points.emplace_back(x, 3 * i + 1.5, 0);
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < n; ++i) {
    const int left = n + 1 + i, right = left + n;
    triangles.push_back({i, right, left});
    triangles.push_back({right, i + 1, left});
    if (i > 0) {
      triangles.push_back({i, right - 1, right});
      triangles.push_back({i, left, left - 1});
    }
  }
  Mesh mesh = make_mesh(points, triangles);
  CHECK(flip(mesh).edges_flipped == n);
  for (int i = 0; i < n; ++i) CHECK(joined(mesh, i, i + 1));
  // By shape alone the crossing diagonals (length 2 against 3) would win.
  CHECK(flip(mesh).unchanged());
}

TEST_CASE("flip_diagonals: a triangle without area is resolved") {
  Mesh mesh =
      make_mesh({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, -2, 0}}, {{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {1, 0, 4}});
  const Report report = flip(mesh);
  CHECK(report.edges_flipped == 1);
  CHECK(joined(mesh, 2, 4));
  CHECK(report.figures.at("smallest angle before") == 0);
  CHECK(report.figures.at("smallest angle after") == doctest::Approx(std::atan2(1, 2) * 180 / pi));
}

TEST_CASE("flip_diagonals: lowers the order it states, and a second run changes nothing") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> height(-1, 1);
  for (const double roughness : {0.05, 0.4, 2.0}) {
    for (int run = 0; run < 10; ++run) {
      CAPTURE(roughness);
      Mesh mesh = jittered_plane(12, static_cast<unsigned>(run));
      for (const VertexHandle v : mesh.vertices()) mesh.point(v)[2] = roughness * height(random);
      const double excess_before = excess(mesh, 0.5);
      const std::vector<double> angles_before = sorted_smallest_angles(mesh);
      const Report report = flip(mesh);
      CHECK(report.edges_flipped > 0);
      const double excess_after = excess(mesh, 0.5);
      CHECK(excess_after <= excess_before + 1e-4);
      if (excess_before == 0) CHECK(sorted_smallest_angles(mesh) > angles_before);
      CHECK(flip(mesh).edges_flipped == 0);
    }
  }
}

TEST_CASE("flip_diagonals: no duplicate edge, no change of boundary or positions") {
  // A tetrahedron with needle faces: every other diagonal is there already.
  Mesh tetrahedron =
      make_mesh({{0, 0, 0}, {10, 0, 0}, {5, 0.1, 0}, {5, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const Snapshot before = snapshot(view_of(tetrahedron));
  CHECK(flip(tetrahedron).unchanged());
  CHECK(snapshot(view_of(tetrahedron)) == before);

  Mesh mesh = bumpy_grid(15, 10);
  const Mesh original = mesh;
  flip(mesh);
  CHECK(boundary_loops(mesh) == 1);
  for (const EdgeHandle e : original.edges())
    if (original.is_boundary(e)) CHECK(mesh.is_boundary(e));
  for (const VertexHandle v : mesh.vertices()) CHECK(mesh.point(v) == original.point(v));
}

TEST_CASE(
    "flip_diagonals: with a large sharp angle a cylinder of few facets is judged by shape, with a small one by "
    "smoothness") {
  // Six facets: 60 degrees between neighbours. Tall facets would be flipped by shape if the rule took no care of the
  // crease.
  Mesh mesh = tube(6, 3, 1, 0, 0.5).mesh();
  Mesh again = mesh;
  const double before = excess(mesh, 0.5);
  flip(mesh);
  CHECK(excess(mesh, 0.5) <= before + 1e-4);
  flip(again, {.sharp_angle = 179 * pi / 180});
  CHECK(sorted_smallest_angles(again) >= sorted_smallest_angles(mesh));
}

TEST_CASE("flip_diagonals: points that are not finite do not stop it") {
  Mesh mesh = bumpy_grid(6, 6);
  mesh.point(VertexHandle(24))[1] = std::nan("");
  mesh.point(VertexHandle(10))[0] = std::numeric_limits<double>::infinity();
  flip(mesh);
}

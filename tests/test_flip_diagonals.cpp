#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <random>
#include <set>

#include "mesh_check.hpp"
#include "meshops/crossings/predicates.hpp"
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

bool share_edge(const Mesh& mesh, int a, int b) {
  return mesh.find_halfedge(VertexHandle(a), VertexHandle(b)).is_valid();
}

std::array<Vec3, 3> corner_points(const Mesh& mesh, FaceHandle f) {
  std::array<Vec3, 3> p;
  int k = 0;
  for (const VertexHandle v : mesh.fv_range(f)) p[k++] = mesh.point(v);
  return p;
}

Vec3 unit_normal(const Mesh& mesh, FaceHandle f) {
  const auto [a, b, c] = corner_points(mesh, f);
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
    const auto p = corner_points(mesh, f);
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

/// Flips edges at random wherever the two new triangles face the way of the old ones.
void shuffle_diagonals(Mesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  for (std::size_t n = 0; n < 2 * mesh.n_edges(); ++n) {
    const EdgeHandle e(static_cast<int>(random() % mesh.n_edges()));
    if (mesh.is_boundary(e) || !mesh.is_flip_ok(e)) continue;
    const Vec3 before = unit_normal(mesh, mesh.face_handle(mesh.halfedge_handle(e, 0)));
    mesh.flip(e);
    const Vec3 m = unit_normal(mesh, mesh.face_handle(mesh.halfedge_handle(e, 0)));
    const Vec3 n2 = unit_normal(mesh, mesh.face_handle(mesh.halfedge_handle(e, 1)));
    if (!((m | before) > 0.1 && (n2 | before) > 0.1)) mesh.flip(e);
  }
}

double angle_at(const Mesh& mesh, EdgeHandle e) {
  const Vec3 m = unit_normal(mesh, mesh.face_handle(mesh.halfedge_handle(e, 0)));
  const Vec3 n = unit_normal(mesh, mesh.face_handle(mesh.halfedge_handle(e, 1)));
  return std::acos(std::clamp(m | n, -1.0, 1.0));
}

/// Half the sum of length times angle of the inner edges.
double total_curvature(const Mesh& mesh) {
  double sum = 0;
  for (const EdgeHandle e : mesh.edges())
    if (!mesh.is_boundary(e)) sum += 0.5 * mesh.calc_edge_length(e) * angle_at(mesh, e);
  return sum;
}

int sharp_edges(const Mesh& mesh, double sharp) {
  int count = 0;
  for (const EdgeHandle e : mesh.edges()) count += !mesh.is_boundary(e) && angle_at(mesh, e) > sharp;
  return count;
}

/// The far corners of both triangles of an inner edge lie outside of the other's circumcircle, or on it.
bool is_delaunay_in_plane(const Mesh& mesh, EdgeHandle e) {
  const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
  const auto at = [&](VertexHandle v) { return Vec2(mesh.point(v)[0], mesh.point(v)[1]); };
  return in_circle_exact(at(mesh.from_vertex_handle(h)), at(mesh.to_vertex_handle(h)),
                         at(mesh.to_vertex_handle(mesh.next_halfedge_handle(h))),
                         at(mesh.to_vertex_handle(mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h))))) <= 0;
}

/// The least total curvature of all triangulations that flips lead to.
double least_curvature(const Mesh& start) {
  using Key = std::set<std::set<int>>;
  const auto key = [](const Mesh& mesh) {
    Key result;
    for (const FaceHandle f : mesh.faces()) {
      std::set<int> corner_points;
      for (const VertexHandle v : mesh.fv_range(f)) corner_points.insert(v.idx());
      result.insert(corner_points);
    }
    return result;
  };
  std::set<Key> seen{key(start)};
  std::deque<Mesh> queue(1, start);
  double least = std::numeric_limits<double>::infinity();
  for (; !queue.empty(); queue.pop_front()) {
    Mesh& mesh = queue.front();
    const double curvature = total_curvature(mesh);
    if (curvature < least) least = curvature;
    for (const EdgeHandle e : mesh.edges()) {
      if (mesh.is_boundary(e) || !mesh.is_flip_ok(e)) continue;
      mesh.flip(e);
      if (seen.insert(key(mesh)).second) queue.push_back(mesh);
      mesh.flip(e);
    }
  }
  CHECK(seen.size() > 50);
  return least;
}

/// Points of a saddle, or of a cylinder whose rings are turned by half a step against each other.
Mesh saddle(int n) {
  PatchShape s;
  s.nu = s.nv = n;
  s.point = [n](int i, int j) {
    const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
    return Vec3(x, y, 0.5 * (x * x - y * y));
  };
  return s.mesh();
}
Mesh turned_cylinder(int around, int along) {
  PatchShape s = tube(around, along, 1, 0, 1);
  s.point = [=](int i, int j) {
    const double angle = 2 * pi * (i + 0.5 * j) / around;
    return Vec3(std::cos(angle), std::sin(angle), 0.7 * j);
  };
  return s.mesh();
}

}  // namespace

TEST_CASE("flip_diagonals: a flat quadrilateral gets the diagonal with the larger smallest angle, and keeps it") {
  Mesh mesh = make_mesh({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}}, {{3, 0, 1}, {1, 2, 3}});
  const Report report = flip(mesh);
  CHECK(report.edges_flipped == 1);
  CHECK(report.touched_faces == std::vector<std::uint32_t>{0, 1});
  CHECK(share_edge(mesh, 0, 2));
  CHECK_FALSE(share_edge(mesh, 1, 3));
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
  for (int i = 0; i < n; ++i) CHECK(share_edge(mesh, i, i + 1));
  // By shape alone the crossing diagonals (length 2 against 3) would win.
  CHECK(flip(mesh).unchanged());
}

TEST_CASE("flip_diagonals: a triangle without area is resolved") {
  Mesh mesh =
      make_mesh({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, -2, 0}}, {{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {1, 0, 4}});
  const Report report = flip(mesh);
  CHECK(report.edges_flipped == 1);
  CHECK(share_edge(mesh, 2, 4));
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

TEST_CASE("flip_diagonals delaunay: on a plane every circumcircle is empty, by an exact predicate") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Mesh mesh = jittered_plane(25, seed);
    shuffle_diagonals(mesh, seed);
    Mesh squares = grid(12, 12);
    shuffle_diagonals(squares, seed);
    for (Mesh* m : {&mesh, &squares}) {
      int wrong = 0;
      for (const EdgeHandle e : m->edges()) wrong += !m->is_boundary(e) && !is_delaunay_in_plane(*m, e);
      CHECK(wrong > 50);
      const Report report = flip(*m, {.criterion = FlipRule::delaunay});
      CHECK(report.figures.at("edges not Delaunay before") == wrong);
      CHECK(report.figures.at("edges not Delaunay after") == 0);
      CHECK(report.skipped.empty());
      for (const EdgeHandle e : m->edges())
        if (!m->is_boundary(e)) CHECK(is_delaunay_in_plane(*m, e));
      CHECK(flip(*m, {.criterion = FlipRule::delaunay}).unchanged());
    }
  }
}

TEST_CASE("flip_diagonals delaunay: a concave hole in a plane is constrained, not folded over") {
  PatchShape s;
  s.nu = s.nv = 16;
  s.keep = [](int i, int j) { return !((i > 3 && i < 12 && j > 3 && j < 6) || (i > 3 && i < 6 && j > 3 && j < 13)); };
  Mesh mesh = s.mesh();
  shuffle_diagonals(mesh, 8);
  const double area = mesh_area(view_of(mesh));
  flip(mesh, {.criterion = FlipRule::delaunay});
  CHECK(mesh_area(view_of(mesh)) == doctest::Approx(area));
  for (const FaceHandle f : mesh.faces()) CHECK(unit_normal(mesh, f)[2] == doctest::Approx(1));
  for (const EdgeHandle e : mesh.edges())
    if (!mesh.is_boundary(e)) CHECK(is_delaunay_in_plane(mesh, e));
}

TEST_CASE("flip_diagonals delaunay: a sharp edge stays, whatever its angles; no edge becomes sharp") {
  // A roof of 90 degrees whose ridge is long against its slopes: the angles opposite to it add up to more than pi.
  Mesh roof = make_mesh({{-4, 0, 0}, {4, 0, 0}, {0, 1, -1}, {0, -1, -1}}, {{0, 1, 2}, {1, 0, 3}});
  const Report kept = flip(roof, {.criterion = FlipRule::delaunay});
  CHECK(kept.unchanged());
  CHECK(kept.figures.at("edges not Delaunay after") == 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> height(-0.25, 0.25);
  for (int run = 0; run < 8; ++run) {
    Mesh mesh = jittered_plane(14, static_cast<unsigned>(run));
    for (const VertexHandle v : mesh.vertices()) mesh.point(v)[2] = height(random);
    shuffle_diagonals(mesh, static_cast<unsigned>(run));
    const int sharp = sharp_edges(mesh, 0.5);
    const Report report = flip(mesh, {.criterion = FlipRule::delaunay});
    CHECK(report.edges_flipped > 0);
    CHECK(sharp_edges(mesh, 0.5) <= sharp);
    CHECK(report.figures.at("edges not Delaunay after") < report.figures.at("edges not Delaunay before"));
    CHECK(flip(mesh, {.criterion = FlipRule::delaunay}).unchanged());
  }
}

TEST_CASE("flip_diagonals delaunay: a triangle without area is resolved; points in one place are let be") {
  Mesh mesh =
      make_mesh({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, -2, 0}}, {{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {1, 0, 4}});
  CHECK(flip(mesh, {.criterion = FlipRule::delaunay}).edges_flipped == 1);
  CHECK(share_edge(mesh, 2, 4));
  Mesh heap = bumpy_grid(6, 6);
  for (int i = 14; i < 20; ++i) heap.point(VertexHandle(i)) = heap.point(VertexHandle(14));
  heap.point(VertexHandle(30))[1] = std::nan("");
  flip(heap, {.criterion = FlipRule::delaunay});
  flip(heap, {.criterion = FlipRule::curvature});
}

TEST_CASE("flip_diagonals curvature: reaches the least of all triangulations of a small saddle and a small cylinder") {
  for (const Mesh& shape : {saddle(2), turned_cylinder(4, 1)}) {
    const double least = least_curvature(shape);
    for (const unsigned seed : {1u, 2u, 3u, 4u}) {
      Mesh mesh = shape;
      shuffle_diagonals(mesh, seed);
      const double before = total_curvature(mesh);
      const Report report = flip(mesh, {.criterion = FlipRule::curvature});
      CHECK(total_curvature(mesh) == doctest::Approx(least));
      CHECK(report.figures.at("total absolute mean curvature before") == doctest::Approx(before));
      CHECK(report.figures.at("total absolute mean curvature after") == doctest::Approx(least));
    }
  }
}

TEST_CASE("flip_diagonals curvature: a shuffled sphere comes near its convex hull; no flip raises the total") {
  // Of all closed surfaces through points of a sphere their convex hull has the least total.
  PatchShape s;
  s.nu = 24;
  s.nv = 16;
  s.closed_u = true;
  s.point = [](int i, int j) {
    const double u = 2 * pi * (i + 0.5 * j) / 24, v = pi * (j - 8) / 18;
    return Vec3(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
  };
  const Mesh convex = s.mesh();
  Mesh hull = convex;
  flip(hull, {.criterion = FlipRule::curvature});
  Mesh mesh = convex;
  shuffle_diagonals(mesh, 5);
  const double before = total_curvature(mesh), least = total_curvature(hull);
  flip(mesh, {.criterion = FlipRule::curvature});
  CHECK(before > 1.5 * least);
  CHECK(total_curvature(mesh) < 1.05 * least);
  CHECK(flip(mesh, {.criterion = FlipRule::curvature}).unchanged());
}

TEST_CASE("flip_diagonals curvature: what is flat stays as it is") {
  Mesh mesh = jittered_plane(12, 3);
  shuffle_diagonals(mesh, 1);
  const Snapshot before = snapshot(view_of(mesh));
  CHECK(flip(mesh, {.criterion = FlipRule::curvature}).unchanged());
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("flip_diagonals: each criterion gives the same on any number of threads, and cancelled leaves a valid mesh") {
  for (const FlipRule rule : {FlipRule::smooth_shape, FlipRule::delaunay, FlipRule::curvature}) {
    Mesh start = bumpy_grid(70, 70);
    shuffle_diagonals(start, 6);
    Mesh one = start, many = start;
    Context single, other;
    single.threads = 1;
    flip_diagonals(view_of(one), {.criterion = rule}, single);
    flip_diagonals(view_of(many), {.criterion = rule}, other);
    CHECK(snapshot(view_of(one)) == snapshot(view_of(many)));
    for (const int stop : {1, 12, 25}) {
      Mesh mesh = start;
      Context context;
      context.threads = 1;
      std::atomic<int> seen = 0;
      context.on_checkpoint = [&] {
        if (++seen == stop) context.cancel();
      };
      CHECK_THROWS_AS(flip_diagonals(view_of(mesh), {.criterion = rule}, context), Cancelled);
      CHECK_VALID_MESH(mesh);
    }
  }
}

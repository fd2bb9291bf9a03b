#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "meshops/editing/attribute_snapshot.hpp"
#include "meshops/editing/mesh_before.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/editing/place_values.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/shape/collapse_stars.hpp"
#include "meshops/shape/curvature_lengths.hpp"
#include "meshops/shape/edge_lines.hpp"
#include "meshops/shape/surface_survey.hpp"
#include "meshops/shape/target_lengths.hpp"
#include "meshops/shape/valence_excess.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Kuhn's edge length for a chord that stands off a circle of curvature k by e, as the header has it.
double length_for(double k, double e) {
  return std::sqrt(6 * e / k - 3 * e * e);
}

EdgeLines lines_of(Mesh& mesh) {
  return EdgeLines(view_of(mesh), {}, Context());
}

PatchShape sphere_belt(int around, int along, double r) {
  PatchShape belt;
  belt.nu = around, belt.nv = along, belt.closed_u = true;
  belt.point = [=](int i, int j) {
    const double a = 2 * pi * i / around, b = pi * (j + 3) / (along + 6) - pi / 2;
    return Vec3(r * std::cos(a) * std::cos(b), r * std::sin(a) * std::cos(b), r * std::sin(b));
  };
  return belt;
}

}  // namespace

TEST_CASE("edge_lines: rims and creases of a bent strip, with its corners") {
  // An L: 6 x 4 cells lying, 6 x 4 standing.
  PatchShape bent;
  bent.nu = 6, bent.nv = 8;
  bent.point = [](int i, int j) { return Vec3(i, std::min(j, 4), std::max(j - 4, 0)); };
  Mesh mesh = bent.mesh();
  const EdgeLines lines = lines_of(mesh);
  for (const EdgeHandle e : mesh.edges()) {
    const Vec3 &a = mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(e, 0))),
               &b = mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(e, 1)));
    const auto both = [&](double x, int k) { return a[k] == x && b[k] == x; };
    const bool fold = both(4, 1) && both(0, 2);
    CHECK((lines.lines()[static_cast<std::size_t>(e.idx())] != EdgeLines::none) == (mesh.is_boundary(e) || fold));
  }
  for (int j = 0; j <= 8; ++j)
    for (int i = 0; i <= 6; ++i) {
      const bool rim_i = i == 0 || i == 6, rim_j = j == 0 || j == 8, fold = j == 4;
      const auto kind = lines.kinds()[static_cast<std::size_t>(bent.vertex(i, j).idx())];
      if (rim_i && (rim_j || fold))
        CHECK(kind == EdgeLines::Kind::fixed);
      else if (rim_i || rim_j || fold)
        CHECK(kind == EdgeLines::Kind::along);
      else
        CHECK(kind == EdgeLines::Kind::free);
    }
}

TEST_CASE("edge_lines: the closest place of a line is that of its segments by brute force; chords of a circle") {
  const int n = 40;
  const double r = 5;
  Mesh mesh = tube(n, 4, r, 0, 8).mesh();
  const EdgeLines lines = lines_of(mesh);
  std::map<std::int32_t, std::vector<std::array<Vec3, 2>>> segments;
  for (const EdgeHandle e : mesh.edges())
    if (const auto line = lines.lines()[static_cast<std::size_t>(e.idx())]; line != EdgeLines::none)
      segments[line].push_back({mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(e, 0))),
                                mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(e, 1)))});
  REQUIRE(segments.size() == 2);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> x(-9, 9);
  for (const auto& [line, all] : segments) {
    CHECK(all.size() == n);
    for (int k = 0; k < 50; ++k) {
      const Vec3 p(x(random), x(random), x(random));
      double least = 1e9;
      for (const auto& [a, b] : all) least = std::min(least, (closest_on_segment(a, b, p) - p).norm());
      CHECK((lines.closest(p, line) - p).norm() == doctest::Approx(least));
    }
    // From vertex to vertex, an even number of steps on: the middle is farthest from the polygon's corner there.
    const Vec3 from = all[0][0];
    const double turn = 2 * pi * 8 / n;
    const Vec3 to(from[0] * std::cos(turn) - from[1] * std::sin(turn),
                  from[0] * std::sin(turn) + from[1] * std::cos(turn), from[2]);
    const double sagitta = r * std::cos(pi / n) - r * std::cos(turn / 2);
    CHECK(lines.chord_error(from, to, line) >= sagitta);
    CHECK(lines.chord_error(from, to, line) <= r - r * std::cos(turn / 2));
  }
}

TEST_CASE("curvature_lengths: of spheres and tubes by their radius, of planes the longest") {
  const double e = 0.01;
  for (const double r : {1.0, 4.0}) {
    PatchShape belt = sphere_belt(60, 30, r);
    Mesh sphere = belt.mesh();
    const auto on_sphere = curvature_lengths(view_of(sphere), lines_of(sphere), e, 1e-6, 100, Context());
    Mesh pipe = tube(60, 30, r, 0, 4 * r).mesh();
    const auto on_tube = curvature_lengths(view_of(pipe), lines_of(pipe), e, 1e-6, 100, Context());
    for (int j = 5; j <= 25; ++j)
      for (int i = 0; i < 60; ++i) {
        const auto v = static_cast<std::size_t>(belt.vertex(i, j).idx());
        CHECK(on_sphere[v] == doctest::Approx(length_for(1 / r, e)).epsilon(0.02));
        CHECK(on_tube[v] == doctest::Approx(length_for(1 / r, e)).epsilon(0.02));
      }
  }
  Mesh plane = PatchShape().mesh();
  for (const double l : curvature_lengths(view_of(plane), lines_of(plane), e, 0.1, 7, Context())) CHECK(l == 7);
  Mesh sphere = sphere_belt(60, 30, 1).mesh();
  for (const double l : curvature_lengths(view_of(sphere), lines_of(sphere), e, 3, 7, Context())) CHECK(l == 3);
}

TEST_CASE("mesh_before: counts what was moved, made and deleted since") {
  PatchShape patch;
  Mesh mesh = patch.mesh();
  const MeshBefore before(view_of(mesh));
  Report nothing;
  before.compare(view_of(mesh), nothing);
  CHECK(nothing.unchanged());
  CHECK(nothing.touched_vertices.empty());
  CHECK(nothing.touched_faces.empty());

  const VertexHandle moved = patch.vertex(1, 1);
  set_point(view_of(mesh), moved, Vec3(1, 1, 0.5));
  const EdgeHandle inner = mesh.edge_handle(mesh.find_halfedge(patch.vertex(2, 2), patch.vertex(3, 3)));
  const VertexHandle added = split_edge(view_of(mesh), inner, Vec3(2.5, 2.5, 0), 0.5);
  delete_vertex(view_of(mesh), patch.vertex(4, 0));  // one or two triangles at a corner
  const std::size_t gone = before.triangles().size() + 2 - static_cast<std::size_t>(live_faces(mesh));
  Report report;
  before.compare(view_of(mesh), report);
  CHECK(report.vertices_moved == 1);
  CHECK(report.vertices_added == 1);
  CHECK(report.vertices_removed == 1);
  CHECK(report.faces_added == 2);
  CHECK(report.faces_removed == gone);
  CHECK(report.touched_vertices ==
        std::vector<std::uint32_t>{static_cast<std::uint32_t>(moved.idx()), static_cast<std::uint32_t>(added.idx())});
  CHECK(report.touched_faces.size() == 4);  // the halves of two triangles
  CHECK(before.was_there(moved));
  CHECK_FALSE(before.was_there(added));
}

TEST_CASE(
    "collapse_stars: keeps the topology where the collapse leaves a valid mesh with the same Euler characteristic") {
  // A closed strip of three cells around: every edge around is one of a triangle that bounds no face.
  for (const int around : {3, 4, 6}) {
    PatchShape shape;
    shape.nu = around, shape.nv = 3, shape.closed_u = true;
    shape.point = [=](int i, int j) { return Vec3(std::cos(2 * pi * i / around), std::sin(2 * pi * i / around), j); };
    Mesh mesh = shape.mesh();
    CollapseStars stars(mesh);
    int kept = 0, refused = 0;
    for (const HalfedgeHandle h : mesh.halfedges()) {
      stars.look_at(h);
      const bool keeps = stars.keeps_topology([&](EdgeHandle e) { return mesh.is_boundary(e); });
      // Link condition by sets of neighbours: with the boundary closed by one more vertex.
      const VertexHandle a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
      const auto neighbours = [&](VertexHandle v) {
        std::set<int> result;
        for (const VertexHandle n : mesh.vv_range(v)) result.insert(n.idx());
        if (mesh.is_boundary(v)) result.insert(-1);
        return result;
      };
      const std::set<int> at_a = neighbours(a), at_b = neighbours(b);
      std::set<int> common, opposite;
      std::set_intersection(at_a.begin(), at_a.end(), at_b.begin(), at_b.end(), std::inserter(common, common.end()));
      for (const HalfedgeHandle g : {h, mesh.opposite_halfedge_handle(h)})
        opposite.insert(mesh.is_boundary(g) ? -1 : mesh.to_vertex_handle(mesh.next_halfedge_handle(g)).idx());
      // A chord between two places of the rim is the operators' affair, and not refused here.
      const bool chord = mesh.is_boundary(a) && mesh.is_boundary(b) && !mesh.is_boundary(mesh.edge_handle(h));
      if (chord) continue;
      CHECK(keeps == (common == opposite));
      ++(keeps ? kept : refused);
    }
    CHECK(kept > 0);
    CHECK((refused > 0) == (around == 3));
  }
}

TEST_CASE("place_values: weights reproduce the foot of a place") {
  const std::array<Vec3, 3> t{Vec3(1, 2, 3), Vec3(4, 2, 1), Vec3(2, 6, 2)};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(0, 1);
  const Vec3 normal = ((t[1] - t[0]) % (t[2] - t[0])).normalized();
  for (int k = 0; k < 100; ++k) {
    double u = x(random), v = x(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 foot = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
    const auto w = triangle_weights(t, foot + (x(random) - 0.5) * normal);
    CHECK(w[0] + w[1] + w[2] == doctest::Approx(1));
    CHECK((w[0] * t[0] + w[1] * t[1] + w[2] * t[2] - foot).norm() < 1e-12);
  }
  CHECK(triangle_weights({t[0], t[0], t[0]}, t[1]) == std::array<double, 3>{1, 0, 0});
}

TEST_CASE("attribute_snapshot: means of what was, labels of the heaviest, no number of a point") {
  PatchShape patch;
  Mesh mesh = patch.mesh();
  OpenMesh::VPropHandleT<double> number;
  OpenMesh::VPropHandleT<int> face, point;
  mesh.add_property(number, "v:height");
  mesh.add_property(face, "v:cad_face");
  mesh.add_property(point, "v:point_index");
  for (const VertexHandle v : mesh.vertices()) {
    mesh.property(number, v) = 10.0 * v.idx();
    mesh.property(face, v) = v.idx();
    mesh.property(point, v) = v.idx();
  }
  AttributeSnapshot snapshot(view_of(mesh));
  CHECK(snapshot.has_vertex_values());
  CHECK_FALSE(snapshot.has_corner_values());
  for (const VertexHandle v : mesh.vertices()) mesh.property(number, v) = -1;  // on the way
  snapshot.set_vertex(VertexHandle(0), std::array{WeightedIndex{3, 0.25}, WeightedIndex{7, 0.75}});
  CHECK(mesh.property(number, VertexHandle(0)) == doctest::Approx(60));
  CHECK(mesh.property(face, VertexHandle(0)) == 7);
  CHECK(mesh.property(point, VertexHandle(0)) == -1);
  CHECK(mesh.property(number, VertexHandle(1)) == -1);
}

TEST_CASE("valence_excess: none within and on the rim of a grid of equilateral triangles") {
  PatchShape grid;
  grid.nu = grid.nv = 6;
  grid.point = [](int i, int j) { return Vec3(i - 0.5 * j, j * std::sqrt(0.75), 0); };
  Mesh mesh = grid.mesh();
  for (int j = 0; j <= 6; ++j)
    for (int i = 0; i <= 6; ++i) {
      const bool rim = i == 0 || i == 6 || j == 0 || j == 6;
      CHECK(valence_excess(view_of(mesh), grid.vertex(i, j), rim) == 0);
    }
  flip_edge(view_of(mesh), mesh.edge_handle(mesh.find_halfedge(grid.vertex(2, 2), grid.vertex(3, 3))));
  CHECK(valence_excess(view_of(mesh), grid.vertex(2, 2), false) == -1);
  CHECK(valence_excess(view_of(mesh), grid.vertex(3, 2), false) == 1);
}

TEST_CASE("target_lengths: alike everywhere, or those of the input; as many triangles as they cover") {
  const std::vector<Vec3> points{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}};
  const double equilateral = std::sqrt(3.0) / 4;
  TargetLengths alike(2, {});
  CHECK(alike.at(VertexHandle(1)) == 2);
  CHECK(alike.triangle_count(points, triangles) == doctest::Approx(6 / (4 * equilateral)));
  TargetLengths each(5, {1, 2, 3});
  CHECK(each.longest() == 5);
  CHECK(each.triangle_count(points, triangles) == doctest::Approx(6 / (4 * equilateral)));
  each.add_between(VertexHandle(0), VertexHandle(2));
  CHECK(each.at(VertexHandle(3)) == 2);
  each.move(VertexHandle(3), triangles[0], {0.5, 0.25, 0.25});
  CHECK(each.at(VertexHandle(3)) == 1.75);
  CHECK(diagonal_of(points, triangles) == 5);
  Mesh mesh = make_mesh(points, {{0, 1, 2}});
  CHECK(mean_edge_length(view_of(mesh)) == doctest::Approx(4));
}

TEST_CASE("survey_surface: angles, and distances at corners, middles of edges and of triangles") {
  const auto surveyed = [](Mesh& mesh, const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
    const ClosestTriangle other(points, triangles);
    return survey_surface(view_of(mesh), other, std::vector<std::uint32_t>(mesh.n_vertices(), 0), Context());
  };
  const auto one_triangle = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    Mesh mesh;
    mesh.add_face(mesh.add_vertex(a), mesh.add_vertex(b), mesh.add_vertex(c));
    mesh.request_face_status(), mesh.request_edge_status(), mesh.request_vertex_status(),
        mesh.request_halfedge_status();
    return mesh;
  };
  // A roof with slopes of 45 degrees and its ridge at x = 1: what is at height 0 under x is min(x, 2 - x) / sqrt 2 off
  // it.
  const std::vector<Vec3> roof{{0, -9, 0}, {1, -9, 1}, {1, 9, 1}, {0, 9, 0}, {2, -9, 0}, {2, 9, 0}};
  const std::vector<Triangle> slopes{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const double root = std::sqrt(2.0);
  Mesh at_edge = one_triangle({0, 0, 0}, {2, 0, 0}, {0, 4, 0});
  const SurfaceSurvey edge = surveyed(at_edge, roof, slopes);
  CHECK(edge.faces == 1);
  CHECK(edge.greatest_distance == doctest::Approx(1 / root));
  CHECK(edge.smallest_angle == doctest::Approx(std::atan(0.5)));
  Mesh at_corner = one_triangle({1, 0, 0}, {0, 0, 0}, {0, 1, 0});
  CHECK(surveyed(at_corner, roof, slopes).greatest_distance == doctest::Approx(1 / root));
  // A pit under its middle, which the corners and the middles of the edges do not see.
  const double h = 0.01;
  const Vec3 middle(1, 1, 0);
  const std::vector<Vec3> pit{
      {0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1.5, 0, 0}, {1.5, 1.5, 0}, {0, 1.5, 0}, middle - Vec3(0, 0, h)};
  const std::vector<Triangle> walls{{0, 3, 6}, {3, 1, 6}, {1, 4, 6}, {4, 2, 6}, {2, 5, 6}, {5, 0, 6}};
  Mesh over_pit = one_triangle(pit[0], pit[1], pit[2]);
  double nearest = h;
  for (const Triangle& t : walls) {
    const Vec3 n = ((pit[t[1]] - pit[t[0]]) % (pit[t[2]] - pit[t[0]])).normalized();
    nearest = std::min(nearest, std::abs(n | (middle - pit[t[0]])));
  }
  CHECK(surveyed(over_pit, pit, walls).greatest_distance == doctest::Approx(nearest).epsilon(1e-9));

  // What is deleted does not count; nothing at all is no distance.
  Mesh grid = sphere_belt(40, 20, 5).mesh();
  grid.request_face_status(), grid.request_edge_status(), grid.request_vertex_status(), grid.request_halfedge_status();
  const std::size_t n = grid.n_faces();
  grid.delete_face(FaceHandle(3), false);
  CHECK(surveyed(grid, roof, slopes).faces == n - 1);
  for (const FaceHandle f : grid.faces()) grid.delete_face(f, false);
  const SurfaceSurvey none = surveyed(grid, roof, slopes);
  CHECK(none.faces == 0);
  CHECK(none.greatest_distance == 0);
}

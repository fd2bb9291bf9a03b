#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>

#include "mesh_check.hpp"

namespace tri::test {

using std::numbers::pi;

/// A parametric surface over a grid of cells, two triangles each, counter-clockwise in (u, v). Vertex (i, j) has index
/// j * columns + i.
struct PatchShape {
  int nu = 4, nv = 4;     ///< cells
  bool closed_u = false;  ///< the last column of cells joins the first column of vertices
  std::function<Vec3(int, int)> point = [](int i, int j) { return Vec3(i, j, 0); };
  std::function<bool(int, int)> keep = [](int, int) { return true; };  ///< cells that are there

  int columns() const { return closed_u ? nu : nu + 1; }
  VertexHandle vertex(int i, int j) const { return VertexHandle(j * columns() + i % columns()); }
  std::vector<Vec3> points() const {
    std::vector<Vec3> result;
    for (int j = 0; j <= nv; ++j)
      for (int i = 0; i < columns(); ++i) result.push_back(point(i, j));
    return result;
  }
  std::vector<std::array<int, 3>> triangles() const {
    std::vector<std::array<int, 3>> result;
    for (int j = 0; j < nv; ++j)
      for (int i = 0; i < nu; ++i) {
        if (!keep(i, j)) continue;
        const int a = vertex(i, j).idx(), b = vertex(i + 1, j).idx(), c = vertex(i + 1, j + 1).idx(),
                  d = vertex(i, j + 1).idx();
        result.push_back({a, b, c});
        result.push_back({a, c, d});
      }
    return result;
  }
  Mesh mesh() const { return make_mesh(points(), triangles()); }
};

/// A tube of radius r around z; faces look outward.
inline PatchShape tube(int around, int along, double r, double z0, double z1) {
  PatchShape s;
  s.nu = around;
  s.nv = along;
  s.closed_u = true;
  s.point = [=](int i, int j) {
    const double angle = 2 * pi * i / around;
    return Vec3(r * std::cos(angle), r * std::sin(angle), z0 + (z1 - z0) * j / along);
  };
  return s;
}

/// Two crumpled sheets one above the other, which nearly touch, and cross nowhere.
inline Mesh crumpled_sheets(int cells, double gap, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> height(0, 1.5);
  PatchShape sheet;
  sheet.nu = sheet.nv = cells;
  std::vector<Vec3> points = sheet.points();
  std::vector<std::array<int, 3>> triangles = sheet.triangles();
  for (Vec3& p : points) p[2] = height(random);
  const auto count = static_cast<int>(points.size());
  for (int i = 0; i < count; ++i) points.push_back(points[static_cast<std::size_t>(i)] + Vec3(0, 0, gap));
  for (const auto& [a, b, c] : sheet.triangles()) triangles.push_back({a + count, b + count, c + count});
  return make_mesh(points, triangles);
}

/// Area of a regular n-gon with circumradius r.
inline double ngon_area(int n, double r) {
  return 0.5 * n * r * r * std::sin(2 * pi / n);
}

inline double mesh_area(MeshView view) {
  double sum = 0;
  for (const auto f : view.mesh.faces()) {
    const auto h = view.mesh.halfedge_handle(f);
    const Vec3& a = view.point(view.mesh.from_vertex_handle(h));
    sum += 0.5 * ((view.point(view.mesh.to_vertex_handle(h)) - a) %
                  (view.point(view.mesh.to_vertex_handle(view.mesh.next_halfedge_handle(h))) - a))
                     .norm();
  }
  return sum;
}

/// Volume enclosed by a closed mesh, positive if the faces look outward.
inline double mesh_volume(MeshView view) {
  double sum = 0;
  for (const auto f : view.mesh.faces()) {
    const auto h = view.mesh.halfedge_handle(f);
    sum += (view.point(view.mesh.from_vertex_handle(h)) |
            (view.point(view.mesh.to_vertex_handle(h)) %
             view.point(view.mesh.to_vertex_handle(view.mesh.next_halfedge_handle(h))))) /
           6;
  }
  return sum;
}

inline int live_faces(const OpenMesh::TriConnectivity& mesh) {
  int count = 0;
  for ([[maybe_unused]] const auto f : mesh.faces()) ++count;
  return count;
}

}  // namespace tri::test

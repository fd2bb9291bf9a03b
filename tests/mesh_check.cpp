#include "mesh_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace tri::test {
namespace {

using Connectivity = OpenMesh::TriConnectivity;

class Verifier {
 public:
  explicit Verifier(const Connectivity& mesh) : mesh_(mesh), status_(mesh.has_edge_status()) {}

  std::vector<std::string> run() {
    check_edges();
    if (problems_.empty()) check_faces();
    if (problems_.empty()) check_vertices();
    if (problems_.empty()) check_duplicate_edges();
    return std::move(problems_);
  }

 private:
  template <class Handle>
  bool gone(Handle handle) const {
    return status_ && mesh_.status(handle).deleted();
  }
  bool alive(VertexHandle v) const { return v.idx() >= 0 && v.idx() < count(mesh_.n_vertices()) && !gone(v); }
  bool alive(FaceHandle f) const { return f.idx() >= 0 && f.idx() < count(mesh_.n_faces()) && !gone(f); }
  bool alive(HalfedgeHandle h) const {
    return h.idx() >= 0 && h.idx() < count(mesh_.n_halfedges()) && !gone(EdgeHandle(h.idx() / 2));
  }
  static int count(std::size_t n) { return static_cast<int>(n); }
  static HalfedgeHandle twin(HalfedgeHandle h) { return HalfedgeHandle(h.idx() ^ 1); }
  VertexHandle from(HalfedgeHandle h) const { return mesh_.to_vertex_handle(twin(h)); }

  void problem(const std::string& kind, int index, const std::string& what) {
    if (problems_.size() < 20) problems_.push_back(kind + " " + std::to_string(index) + " " + what);
  }

  void check_edges() {
    for (int i = 0; i < count(mesh_.n_halfedges()); ++i) {
      const HalfedgeHandle h(i);
      if (!alive(h)) continue;
      const HalfedgeHandle next = mesh_.next_halfedge_handle(h), prev = mesh_.prev_halfedge_handle(h);
      const FaceHandle face = mesh_.face_handle(h);
      if (!alive(mesh_.to_vertex_handle(h))) {
        problem("half-edge", i, "points to a vertex that is deleted or does not exist");
      } else if (mesh_.to_vertex_handle(h) == from(h)) {
        problem("half-edge", i, "begins and ends in the same vertex");
      }
      if (face.is_valid() && !alive(face)) problem("half-edge", i, "has a face that is deleted or does not exist");
      if (!face.is_valid() && !mesh_.face_handle(twin(h)).is_valid())
        problem("half-edge", i, "belongs to an edge without face");
      if (!alive(next) || !alive(prev)) {
        problem("half-edge", i, "has a neighbour that is deleted or does not exist");
        continue;
      }
      if (mesh_.prev_halfedge_handle(next) != h) problem("half-edge", i, "is not the previous one of its next one");
      if (from(next) != mesh_.to_vertex_handle(h)) problem("half-edge", i, "ends elsewhere than its next one begins");
      if (mesh_.face_handle(next) != face) problem("half-edge", i, "has another face than its next one");
    }
  }

  void check_faces() {
    std::size_t faces = 0, sides = 0;
    for (int i = 0; i < count(mesh_.n_faces()); ++i) {
      const FaceHandle f(i);
      if (!alive(f)) continue;
      ++faces;
      const HalfedgeHandle a = mesh_.halfedge_handle(f);
      if (!alive(a) || mesh_.face_handle(a) != f) {
        problem("face", i, "stores a half-edge that is not its own");
        continue;
      }
      const HalfedgeHandle b = mesh_.next_halfedge_handle(a), c = mesh_.next_halfedge_handle(b);
      if (mesh_.next_halfedge_handle(c) != a) problem("face", i, "is not a triangle");
      if (from(a) == from(b) || from(b) == from(c) || from(c) == from(a)) problem("face", i, "has a vertex twice");
    }
    for (int i = 0; i < count(mesh_.n_halfedges()); ++i)
      if (alive(HalfedgeHandle(i)) && mesh_.face_handle(HalfedgeHandle(i)).is_valid()) ++sides;
    if (problems_.empty() && sides != 3 * faces)
      problem("mesh", 0, "has half-edges that claim a face which does not know them");
  }

  void check_vertices() {
    std::vector<int> outgoing(mesh_.n_vertices()), boundary(mesh_.n_vertices());
    for (int i = 0; i < count(mesh_.n_halfedges()); ++i) {
      const HalfedgeHandle h(i);
      if (!alive(h)) continue;
      ++outgoing[from(h).idx()];
      if (!mesh_.face_handle(h).is_valid()) ++boundary[from(h).idx()];
    }
    for (int i = 0; i < count(mesh_.n_vertices()); ++i) {
      const VertexHandle v(i);
      if (!alive(v)) continue;
      const HalfedgeHandle start = mesh_.halfedge_handle(v);
      if (outgoing[i] == 0) {
        if (start.is_valid()) problem("vertex", i, "has no edge but stores one");
        continue;
      }
      if (!alive(start) || from(start) != v) {
        problem("vertex", i, "stores a half-edge that does not begin in it");
        continue;
      }
      if (boundary[i] > 1) problem("vertex", i, "joins several fans (a bow-tie)");
      if (boundary[i] == 1 && mesh_.face_handle(start).is_valid())
        problem("vertex", i, "is on the boundary but stores an inner half-edge");
      int seen = 0;
      HalfedgeHandle h = start;
      do {
        h = mesh_.next_halfedge_handle(twin(h));
        ++seen;
      } while (h != start && seen <= outgoing[i]);
      if (seen != outgoing[i]) problem("vertex", i, "has edges outside the fan around it");
    }
  }

  void check_duplicate_edges() {
    std::vector<std::pair<int, int>> ends;
    for (int i = 0; i < count(mesh_.n_edges()); ++i) {
      const HalfedgeHandle h(2 * i);
      if (alive(h)) ends.push_back(std::minmax({mesh_.to_vertex_handle(h).idx(), from(h).idx()}));
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 1; i < ends.size(); ++i)
      if (ends[i] == ends[i - 1])
        problem("vertex", ends[i].first, "is joined twice to vertex " + std::to_string(ends[i].second));
  }

  const Connectivity& mesh_;
  const bool status_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> mesh_problems(const Connectivity& mesh) {
  return Verifier(mesh).run();
}

Snapshot snapshot(MeshView view) {
  const Connectivity& mesh = view.mesh;
  Snapshot s;
  const auto status = [&](auto handle, bool present) { s.status.push_back(present ? mesh.status(handle).bits() : 0u); };
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i) {
    const VertexHandle v(i);
    s.links.push_back(mesh.halfedge_handle(v).idx());
    status(v, mesh.has_vertex_status());
    for (int k = 0; k < 3; ++k) s.coordinates.push_back(view.point(v)[k]);
  }
  for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i) {
    const HalfedgeHandle h(i);
    s.links.insert(s.links.end(), {mesh.to_vertex_handle(h).idx(), mesh.face_handle(h).idx(),
                                   mesh.next_halfedge_handle(h).idx(), mesh.prev_halfedge_handle(h).idx()});
    status(h, mesh.has_halfedge_status());
  }
  for (int i = 0; i < static_cast<int>(mesh.n_edges()); ++i) status(EdgeHandle(i), mesh.has_edge_status());
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i) {
    s.links.push_back(mesh.halfedge_handle(FaceHandle(i)).idx());
    status(FaceHandle(i), mesh.has_face_status());
  }
  return s;
}

Mesh make_mesh(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& triangles) {
  Mesh mesh;
  for (const Vec3& p : points) mesh.add_vertex(p);
  for (const auto& [a, b, c] : triangles) {
    const FaceHandle f = mesh.add_face(VertexHandle(a), VertexHandle(b), VertexHandle(c));
    REQUIRE(f.is_valid());
  }
  return mesh;
}

Mesh icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  return make_mesh({{-1, g, 0},
                    {1, g, 0},
                    {-1, -g, 0},
                    {1, -g, 0},
                    {0, -1, g},
                    {0, 1, g},
                    {0, -1, -g},
                    {0, 1, -g},
                    {g, 0, -1},
                    {g, 0, 1},
                    {-g, 0, -1},
                    {-g, 0, 1}},
                   {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}});
}

Mesh grid(int columns, int rows) {
  std::vector<Vec3> points;
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x <= columns; ++x) points.emplace_back(x, y, 0);
  std::vector<std::array<int, 3>> triangles;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const int a = y * (columns + 1) + x, b = a + 1, c = b + columns + 1, d = c - 1;
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  return make_mesh(points, triangles);
}

Mesh bumpy_grid(int columns, int rows) {
  Mesh mesh = grid(columns, rows);
  std::uint32_t state = 12345;
  const auto next = [&] {
    state = state * 1664525u + 1013904223u;
    return (static_cast<double>(state >> 8) / (1 << 24) - 0.5) * 0.6;
  };
  for (const VertexHandle v : mesh.vertices()) {
    const double x = next(), y = next(), z = next();
    mesh.point(v) += Vec3(x, y, z);
  }
  return mesh;
}

Mesh two_components() {
  Mesh mesh = icosahedron();
  const Mesh other = grid(3, 3);
  const int shift = static_cast<int>(mesh.n_vertices());
  for (const VertexHandle v : other.vertices()) mesh.add_vertex(other.point(v) + Vec3(10, 0, 0));
  for (const FaceHandle f : other.faces()) {
    const HalfedgeHandle h = other.halfedge_handle(f);
    const auto corner = [&](HalfedgeHandle side) { return VertexHandle(other.to_vertex_handle(side).idx() + shift); };
    mesh.add_face(corner(h), corner(other.next_halfedge_handle(h)), corner(other.prev_halfedge_handle(h)));
  }
  return mesh;
}

int boundary_loops(const Connectivity& mesh) {
  std::vector<char> seen(mesh.n_halfedges());
  int loops = 0;
  for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i) {
    const HalfedgeHandle start(i);
    if (seen[i] || mesh.face_handle(start).is_valid() ||
        (mesh.has_edge_status() && mesh.status(EdgeHandle(i / 2)).deleted()))
      continue;
    ++loops;
    for (HalfedgeHandle h = start; !seen[h.idx()]; h = mesh.next_halfedge_handle(h)) seen[h.idx()] = 1;
  }
  return loops;
}

int euler_characteristic(const Connectivity& mesh) {
  const bool status = mesh.has_edge_status();
  std::vector<char> used(mesh.n_vertices());
  int edges = 0, faces = 0;
  for (int i = 0; i < static_cast<int>(mesh.n_edges()); ++i) {
    if (status && mesh.status(EdgeHandle(i)).deleted()) continue;
    ++edges;
    used[mesh.to_vertex_handle(HalfedgeHandle(2 * i)).idx()] = 1;
    used[mesh.to_vertex_handle(HalfedgeHandle(2 * i + 1)).idx()] = 1;
  }
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i)
    if (!status || !mesh.status(FaceHandle(i)).deleted()) ++faces;
  return static_cast<int>(std::count(used.begin(), used.end(), 1)) - edges + faces;
}

}  // namespace tri::test

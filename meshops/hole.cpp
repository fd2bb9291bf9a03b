#include "meshops/hole.hpp"

#include <algorithm>
#include <cmath>

namespace tri {
namespace {

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? v / length : Vec3(0, 0, 0);
}

}  // namespace

Hole::Hole(MeshView view, std::vector<HalfedgeHandle> rim) : view_(view), rim_(std::move(rim)) {
  for (const HalfedgeHandle h : rim_) {
    vertices_.push_back(view.mesh.from_vertex_handle(h));
    points_.push_back(view.point(vertices_.back()));
  }
}

bool Hole::simple() const {
  std::vector<VertexHandle> sorted = vertices_;
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
}

bool Hole::wider_than(double limit) const {
  if (std::isinf(limit)) return false;
  Vec3 low = points_[0], high = points_[0];
  for (const Vec3& p : points_) low.minimize(p), high.maximize(p);
  const Vec3 box = high - low;
  if (box.norm() <= limit) return false;
  if (std::max({box[0], box[1], box[2]}) > limit) return true;
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (std::size_t j = i + 1; j < points_.size(); ++j)
      if ((points_[i] - points_[j]).sqrnorm() > limit * limit) return true;
  return false;
}

bool Hole::around_single_triangle() const {
  if (size() != 3) return false;
  const auto face = [&](int i) { return view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(rim_[i])); };
  return face(0) == face(1) && face(1) == face(2);
}

bool Hole::rim_of_sheet(std::size_t component_faces) const {
  if (size() <= 6 && component_faces > 24) return false;
  Vec3 across(0, 0, 0);
  for (std::size_t i = 1; i + 1 < points_.size(); ++i)
    across += (points_[i] - points_[0]) % (points_[i + 1] - points_[0]);
  across = unit(across);
  double sum = 0, length = 0;
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const double weight = (points_[(i + 1) % points_.size()] - points_[i]).norm();
    sum += weight * (across | face_normal(view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(rim_[i]))));
    length += weight;
  }
  return sum < -0.5 * length;
}

std::vector<VertexTriple> Hole::triangulate(HoleStrategy strategy, int max_dynamic_edges, bool& cut_down) {
  find_forbidden();
  std::vector<RingTriangle> triangles;
  cut_down = false;
  bool done = false;
  if (strategy == HoleStrategy::nearest_diagonal) {
    std::vector<std::int32_t> left;
    done = cut_nearest_diagonals(points_, vertex_normals(), chord_test(), 2, triangles, left);
  } else if (size() <= max_dynamic_edges) {
    done = triangulate_ring_dihedral_area(points_, edge_normals(), chord_test(), triangles);
  } else {
    cut_down = true;
    done = cut_then_optimise(max_dynamic_edges, triangles);
  }
  std::vector<VertexTriple> result;
  if (!done) return result;
  for (const RingTriangle& t : triangles) result.push_back({vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]});
  return result;
}

void Hole::find_forbidden() {
  std::vector<std::pair<int, int>> place;  // (vertex, position in the ring)
  for (int i = 0; i < size(); ++i) place.push_back({vertices_[i].idx(), i});
  std::sort(place.begin(), place.end());
  for (int i = 0; i < size(); ++i)
    for (auto it = view_.mesh.cvv_iter(vertices_[i]); it.is_valid(); ++it) {
      const auto found = std::lower_bound(place.begin(), place.end(), std::pair((*it).idx(), 0));
      if (found == place.end() || found->first != (*it).idx()) continue;
      const int j = found->second;
      if (j > i + 1 && !(i == 0 && j == size() - 1)) forbidden_.push_back({i, j});
    }
  std::sort(forbidden_.begin(), forbidden_.end());
}

std::function<bool(int, int)> Hole::chord_test() const {
  if (forbidden_.empty()) return {};
  return [this](int i, int j) { return !std::binary_search(forbidden_.begin(), forbidden_.end(), std::pair(i, j)); };
}

Vec3 Hole::face_normal(FaceHandle f) const {
  const HalfedgeHandle h = view_.mesh.halfedge_handle(f);
  const Vec3& a = view_.point(view_.mesh.from_vertex_handle(h));
  const Vec3& b = view_.point(view_.mesh.to_vertex_handle(h));
  const Vec3& c = view_.point(view_.mesh.to_vertex_handle(view_.mesh.next_halfedge_handle(h)));
  return unit((b - a) % (c - a));
}

std::vector<Vec3> Hole::edge_normals() const {
  std::vector<Vec3> normals;
  for (const HalfedgeHandle h : rim_)
    normals.push_back(face_normal(view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(h))));
  return normals;
}

std::vector<Vec3> Hole::vertex_normals() const {
  std::vector<Vec3> normals;
  for (const VertexHandle v : vertices_) {
    Vec3 sum(0, 0, 0);
    for (auto it = view_.mesh.cvf_iter(v); it.is_valid(); ++it) sum += face_normal(*it);
    normals.push_back(unit(sum));
  }
  return normals;
}

bool Hole::cut_then_optimise(int rest, std::vector<RingTriangle>& triangles) const {
  std::vector<std::int32_t> left;
  if (!cut_nearest_diagonals(points_, vertex_normals(), chord_test(), rest, triangles, left)) return false;
  const int m = static_cast<int>(left.size());
  // Beyond each edge of the smaller ring lies a triangle that was cut, or the mesh.
  std::vector<Vec3> points, normals;
  const std::vector<Vec3> mesh_normals = edge_normals();
  for (int i = 0; i < m; ++i) {
    points.push_back(points_[left[i]]);
    const int next = left[(i + 1) % m];
    normals.push_back(next == (left[i] + 1) % size() ? mesh_normals[left[i]] : Vec3(0, 0, 0));
  }
  for (const RingTriangle& t : triangles) {  // an ear (p, b, r) leaves the edge p -> r
    const auto at = std::lower_bound(left.begin(), left.end(), t[0]);
    if (at == left.end() || *at != t[0]) continue;
    const int i = static_cast<int>(at - left.begin());
    if (left[(i + 1) % m] == t[2]) normals[i] = unit((points_[t[1]] - points_[t[0]]) % (points_[t[2]] - points_[t[0]]));
  }
  std::function<bool(int, int)> allowed;
  if (!forbidden_.empty())
    allowed = [&](int i, int j) {
      return !std::binary_search(forbidden_.begin(), forbidden_.end(), std::pair(left[i], left[j]));
    };
  std::vector<RingTriangle> inner;
  if (!triangulate_ring_dihedral_area(points, normals, allowed, inner)) return false;
  for (const RingTriangle& t : inner) triangles.push_back({left[t[0]], left[t[1]], left[t[2]]});
  return true;
}

}  // namespace tri

#include "meshops/hole.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/triangle_normal.hpp"

namespace tri {
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
  across = unit_or_zero(across);
  double sum = 0, length = 0;
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const double weight = (points_[(i + 1) % points_.size()] - points_[i]).norm();
    sum += weight * (across | face_normal(view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(rim_[i]))));
    length += weight;
  }
  return sum < -0.5 * length;
}

std::vector<VertexTriple> Hole::triangulate(HoleStrategy strategy, int max_dynamic_edges, const Context& context,
                                            bool& in_pieces) {
  find_forbidden();
  Ring ring{points_, edge_normals(), vertex_normals(), {}};
  if (!forbidden_.empty())
    ring.chord_allowed = [this](int i, int j) {
      return !std::binary_search(forbidden_.begin(), forbidden_.end(), std::pair(i, j));
    };
  const RingFilling filling = fill_ring(ring, strategy, max_dynamic_edges, context);
  in_pieces = filling.in_pieces;
  std::vector<VertexTriple> result;
  for (const RingTriangle& t : filling.triangles) result.push_back({vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]});
  return result;
}

void Hole::find_forbidden() {
  forbidden_.clear();
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

Vec3 Hole::face_normal(FaceHandle f) const {
  const HalfedgeHandle h = view_.mesh.halfedge_handle(f);
  const Vec3& a = view_.point(view_.mesh.from_vertex_handle(h));
  const Vec3& b = view_.point(view_.mesh.to_vertex_handle(h));
  const Vec3& c = view_.point(view_.mesh.to_vertex_handle(view_.mesh.next_halfedge_handle(h)));
  return triangle_normal(a, b, c);
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
    normals.push_back(unit_or_zero(sum));
  }
  return normals;
}

}  // namespace tri

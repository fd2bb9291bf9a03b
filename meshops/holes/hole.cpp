#include "meshops/holes/hole.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "meshops/search/nearest_points.hpp"
#include "meshops/shape/triangle_normal.hpp"

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
  double length = 0;
  for (std::size_t i = 0; i < rim_.size(); ++i) length += (points_[(i + 1) % points_.size()] - points_[i]).norm();
  return (unit_or_zero(across) | mean_normal()) < -0.5 * length;
}

Vec3 Hole::mean_normal() const {
  Vec3 sum(0, 0, 0);
  for (std::size_t i = 0; i < rim_.size(); ++i)
    sum += (points_[(i + 1) % points_.size()] - points_[i]).norm() * normal_beyond(rim_[i]);
  return sum;
}

bool Hole::join_island(const std::vector<HalfedgeHandle>& loop) {
  std::vector<Vec3> points;
  for (const HalfedgeHandle h : loop) points.push_back(view_.point(view_.mesh.from_vertex_handle(h)));
  const NearestPoints tree(points);
  std::vector<NearestPoints::Neighbor> near;
  std::size_t at = 0, on_island = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    // Of the few nearest vertices of the island the first that can be joined.
    tree.nearest(points_[i], std::min<std::size_t>(points.size(), 8), near);
    for (const auto& candidate : near) {
      if (candidate.squared_distance >= nearest) break;
      const VertexHandle to = view_.mesh.from_vertex_handle(loop[candidate.index]);
      if (to == vertices_[i] || view_.mesh.find_halfedge(vertices_[i], to).is_valid()) continue;
      nearest = candidate.squared_distance;
      at = i;
      on_island = candidate.index;
      break;
    }
  }
  if (std::isinf(nearest)) return false;
  // ... at, (bridge) island ..., island, (bridge) at, ...
  std::vector<HalfedgeHandle> rim;
  std::vector<VertexHandle> vertices;
  const VertexHandle foot = vertices_[at];
  for (std::size_t k = 0; k <= loop.size(); ++k) {
    const HalfedgeHandle h = loop[(on_island + k) % loop.size()];
    vertices.push_back(view_.mesh.from_vertex_handle(h));
    rim.push_back(k < loop.size() ? h : HalfedgeHandle());
  }
  bridges_.push_back({foot, vertices.front()});
  vertices.push_back(foot);
  rim.push_back(rim_[at]);
  rim_[at] = HalfedgeHandle();
  const auto after = static_cast<std::ptrdiff_t>(at) + 1;
  vertices_.insert(vertices_.begin() + after, vertices.begin(), vertices.end());
  rim_.insert(rim_.begin() + after, rim.begin(), rim.end());
  points_.clear();
  for (const VertexHandle v : vertices_) points_.push_back(view_.point(v));
  return true;
}

Ring Hole::ring() const {
  Ring ring{points_, {}, vertex_normals(), {}};
  for (const HalfedgeHandle h : rim_) ring.edge_normals.push_back(normal_beyond(h));
  auto forbidden = forbidden_chords();
  if (!forbidden.empty())
    ring.chord_allowed = [forbidden = std::move(forbidden)](int i, int j) {
      return !std::binary_search(forbidden.begin(), forbidden.end(), std::pair(i, j));
    };
  return ring;
}

std::vector<VertexTriple> Hole::named(std::span<const RingTriangle> triangles) const {
  std::vector<VertexTriple> result;
  for (const RingTriangle& t : triangles) result.push_back({vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]});
  return result;
}

std::vector<VertexTriple> Hole::triangulate(HoleStrategy strategy, int max_dynamic_edges,
                                            const Context& context) const {
  return named(fill_ring(ring(), strategy, max_dynamic_edges, context).triangles);
}

HoleFilling Hole::fill(HoleStrategy strategy, int max_dynamic_edges, const FillingObstacles& obstacles,
                       const Context& context) const {
  const Ring whole = ring();
  RingSurroundings surroundings;
  std::vector<std::int32_t> order(points_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::int32_t i) { return std::tuple(points_[i][0], points_[i][1], points_[i][2], i); };
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) { return key(i) < key(j); });
  surroundings.same_as = order;
  for (std::size_t i = 0; i < order.size(); ++i)
    surroundings.same_as[order[i]] =
        i > 0 && points_[order[i]] == points_[order[i - 1]] ? surroundings.same_as[order[i - 1]] : order[i];
  surroundings.crossings = [&](const RingTriangle& t) {
    return obstacles.crossings({vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]});
  };
  surroundings.in_doubt = [&](std::span<const RingTriangle> triangles) { return obstacles.in_doubt(named(triangles)); };
  std::vector<HoleStrategy> strategies{strategy};
  for (const HoleStrategy other :
       {HoleStrategy::least_bending, HoleStrategy::nearest_diagonal, HoleStrategy::minimum_area})
    if (other != strategy) strategies.push_back(other);
  HoleFilling best;
  std::size_t least = 0;  // crossings that no filling avoids
  for (const HoleStrategy next : strategies) {
    RingFilling filling = fill_ring(whole, next, max_dynamic_edges, context);
    if (filling.triangles.empty()) continue;
    const FillingCrossings found = find_crossings(points_, surroundings, filling.triangles, context);
    std::size_t crossings = found.count;
    if (crossings > 0) {
      if (surroundings.unavoidable.empty()) surroundings.unavoidable = unavoidable_crossings(obstacles, least);
      if (crossings > least) crossings = untangle_filling(whole, surroundings, found, filling.triangles, context);
    }
    if (best.triangles.empty() || crossings < best.crossings)
      best = {named(filling.triangles), filling.in_pieces, crossings};
    if (best.crossings <= least) break;
  }
  return best;
}

/// @param total  receives how many there are at least in any filling: a triangle may have two edges that go through the
/// same face
std::vector<int> Hole::unavoidable_crossings(const FillingObstacles& obstacles, std::size_t& total) const {
  std::vector<int> at_edge;
  std::vector<FaceHandle> first, counted;  // at the first edge, and at the edge before
  total = 0;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto faces = obstacles.pierced(vertices_[i], vertices_[(i + 1) % vertices_.size()]);
    at_edge.push_back(static_cast<int>(faces.size()));
    std::vector<FaceHandle> fresh;
    for (const FaceHandle f : faces)
      if (!std::binary_search(counted.begin(), counted.end(), f) &&
          !(i + 1 == vertices_.size() && std::binary_search(first.begin(), first.end(), f)))
        fresh.push_back(f);
    total += fresh.size();
    if (i == 0) first = fresh;
    counted = std::move(fresh);
  }
  return at_edge;
}

/// Pairs of positions i < j, not neighbours, at one vertex or joined by an edge of the mesh or a bridge; sorted.
std::vector<std::pair<int, int>> Hole::forbidden_chords() const {
  std::vector<std::pair<int, int>> forbidden, place;  // place: (vertex, position)
  for (int i = 0; i < size(); ++i) place.push_back({vertices_[i].idx(), i});
  std::sort(place.begin(), place.end());
  const auto forbid = [&](int i, VertexHandle v) {
    for (auto at = std::lower_bound(place.begin(), place.end(), std::pair(v.idx(), 0));
         at != place.end() && at->first == v.idx(); ++at) {
      const int j = at->second;
      if (j > i + 1 && !(i == 0 && j == size() - 1)) forbidden.push_back({i, j});
    }
  };
  for (int i = 0; i < size(); ++i) {
    for (auto it = view_.mesh.cvv_iter(vertices_[i]); it.is_valid(); ++it) forbid(i, *it);
    forbid(i, vertices_[i]);
    for (const auto& [a, b] : bridges_) {
      if (a == vertices_[i]) forbid(i, b);
      if (b == vertices_[i]) forbid(i, a);
    }
  }
  std::sort(forbidden.begin(), forbidden.end());
  return forbidden;
}

Vec3 Hole::face_normal(FaceHandle f) const {
  const HalfedgeHandle h = view_.mesh.halfedge_handle(f);
  const Vec3& a = view_.point(view_.mesh.from_vertex_handle(h));
  const Vec3& b = view_.point(view_.mesh.to_vertex_handle(h));
  const Vec3& c = view_.point(view_.mesh.to_vertex_handle(view_.mesh.next_halfedge_handle(h)));
  return triangle_normal(a, b, c);
}

Vec3 Hole::normal_beyond(HalfedgeHandle h) const {
  return h.is_valid() ? face_normal(view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(h))) : Vec3(0, 0, 0);
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

std::vector<std::vector<HalfedgeHandle>> simple_loops(MeshView view, const std::vector<HalfedgeHandle>& loop) {
  std::vector<std::vector<HalfedgeHandle>> loops;
  std::vector<HalfedgeHandle> open;            // the way since the start, without the loops that were cut off
  std::unordered_map<int, std::size_t> place;  // of the vertices at which those half-edges start
  for (const HalfedgeHandle h : loop) {
    const VertexHandle from = view.mesh.from_vertex_handle(h), to = view.mesh.to_vertex_handle(h);
    place[from.idx()] = open.size();
    open.push_back(h);
    const auto met = place.find(to.idx());
    if (met == place.end()) continue;
    const std::size_t first = met->second;
    loops.emplace_back(open.begin() + static_cast<std::ptrdiff_t>(first), open.end());
    for (std::size_t i = first; i < open.size(); ++i) place.erase(view.mesh.from_vertex_handle(open[i]).idx());
    open.resize(first);
  }
  return loops;
}

}  // namespace tri

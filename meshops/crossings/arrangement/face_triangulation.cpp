#include "meshops/crossings/arrangement/face_triangulation.hpp"

#include <algorithm>
#include <deque>

namespace tri {

FaceTriangulation::FaceTriangulation(const GridTriangle& corners) : plane_(plane_through(corners)) {
  const int axis = longest_axis(plane_.normal);
  i_ = (axis + 1) % 3, j_ = (axis + 2) % 3;
  mirrored_ = plane_.normal[axis] < 0;
  if (mirrored_) std::swap(i_, j_);
  for (const GridPoint& p : corners) points_.push_back(exact(p));
  parts_.push_back({{0, 1, 2}, {outside, outside, outside}, {side_edge, side_edge, side_edge}});
  part_of_.assign(3, 0);
}

bool FaceTriangulation::place_in(int part, const ExactPoint& point, Place& place) const {
  const Part& p = parts_[part];
  int zero[3], zeros = 0;
  for (int k = 0; k < 3; ++k) {
    const int s = turn(points_[p.v[k]], points_[p.v[(k + 1) % 3]], point, i_, j_);
    if (s < 0) return false;
    if (s == 0) zero[zeros++] = k;
  }
  place = {part, -1, -1};
  if (zeros == 1) place.edge = zero[0];
  if (zeros >= 2) place.vertex = p.v[zero[0] == 0 && zero[1] == 2 ? 0 : zero[1]];
  return true;
}

FaceTriangulation::Place FaceTriangulation::locate(const ExactPoint& point) const {
  int part = last_;
  Place place;
  // A walk in a triangulation that is not Delaunay may go in circles; then every part is tried.
  std::size_t steps = 0;
  for (int from = -1; steps < parts_.size() + 10; ++steps) {
    const Part& p = parts_[part];
    int towards = -1;
    for (int n = 0; n < 3; ++n) {
      const int k = static_cast<int>((n + steps) % 3);
      if (p.next[k] == outside || p.next[k] == from) continue;
      if (turn(points_[p.v[k]], points_[p.v[(k + 1) % 3]], point, i_, j_) < 0) {
        towards = p.next[k];
        break;
      }
    }
    if (towards < 0) {
      if (place_in(part, point, place)) return place;
      break;
    }
    from = part;
    part = towards;
  }
  for (int q = 0; q < static_cast<int>(parts_.size()); ++q)
    if (place_in(q, point, place)) return place;
  return {-1, -1, -1};
}

int FaceTriangulation::new_vertex(const ExactPoint& point) {
  points_.push_back(point);
  part_of_.push_back(0);
  return static_cast<int>(points_.size()) - 1;
}

int FaceTriangulation::add_point(const ExactPoint& point) {
  const Place place = locate(point);
  if (place.part < 0) return -1;
  last_ = place.part;
  if (place.vertex >= 0) return place.vertex;
  const int v = new_vertex(point);
  if (place.edge >= 0)
    split_edge(place.part, place.edge, v);
  else
    split_part(place.part, v);
  return v;
}

int FaceTriangulation::edge_towards(int part, int neighbor_part) const {
  for (int k = 0; k < 3; ++k)
    if (parts_[part].next[k] == neighbor_part) return k;
  return -1;
}

int FaceTriangulation::corner_of(int part, int vertex) const {
  for (int k = 0; k < 3; ++k)
    if (parts_[part].v[k] == vertex) return k;
  return -1;
}

/// The neighbour beyond `edge` of `part`, which knew `old_neighbor` there, now has `part`.
void FaceTriangulation::link(int part, int edge, int other, int old_neighbor) {
  parts_[part].next[edge] = other;
  if (other == outside) return;
  // Two parts can share two edges only around a vertex of degree two, which a planar triangulation does not have.
  Part& o = parts_[other];
  const int a = parts_[part].v[edge];
  for (int k = 0; k < 3; ++k)
    if (o.next[k] == old_neighbor && o.v[(k + 1) % 3] == a) o.next[k] = part;
}

void FaceTriangulation::split_part(int part, int v) {
  const Part old = parts_[part];
  const int n = static_cast<int>(parts_.size());
  const std::array<int, 3> ids{part, n, n + 1};
  parts_.resize(n + 2);
  for (int k = 0; k < 3; ++k) {
    Part& p = parts_[ids[k]];
    p.v = {old.v[k], old.v[(k + 1) % 3], v};
    p.next = {old.next[k], ids[(k + 1) % 3], ids[(k + 2) % 3]};
    p.kind = {old.kind[k], free_edge, free_edge};
  }
  for (int k = 0; k < 3; ++k) {
    link(ids[k], 0, old.next[k], part);
    part_of_[old.v[k]] = ids[k];
  }
  part_of_[v] = part;
}

void FaceTriangulation::split_edge(int part, int edge, int v) {
  const Part p = parts_[part];
  const int other = p.next[edge];
  const int a = p.v[edge], b = p.v[(edge + 1) % 3], c = p.v[(edge + 2) % 3];
  const int kind = p.kind[edge];
  const int n = static_cast<int>(parts_.size());
  parts_.push_back({{v, b, c}, {outside, p.next[(edge + 1) % 3], part}, {kind, p.kind[(edge + 1) % 3], free_edge}});
  parts_[part] = {{a, v, c}, {outside, n, p.next[(edge + 2) % 3]}, {kind, free_edge, p.kind[(edge + 2) % 3]}};
  link(n, 1, p.next[(edge + 1) % 3], part);
  part_of_[a] = part_of_[v] = part_of_[c] = part;
  part_of_[b] = n;
  if (other == outside) return;
  const Part q = parts_[other];
  int k = 0;
  while (q.v[k] != b || q.v[(k + 1) % 3] != a) ++k;
  const int d = q.v[(k + 2) % 3];
  const int m = n + 1;
  parts_.push_back({{v, a, d}, {part, q.next[(k + 1) % 3], other}, {kind, q.kind[(k + 1) % 3], free_edge}});
  parts_[other] = {{b, v, d}, {n, m, q.next[(k + 2) % 3]}, {kind, free_edge, q.kind[(k + 2) % 3]}};
  link(m, 1, q.next[(k + 1) % 3], other);
  parts_[part].next[0] = m;
  parts_[n].next[0] = other;
  part_of_[d] = m;
}

bool FaceTriangulation::convex(int part, int edge) const {
  const Part& p = parts_[part];
  const int other = p.next[edge];
  if (other == outside) return false;
  const int a = p.v[edge], b = p.v[(edge + 1) % 3], c = p.v[(edge + 2) % 3];
  const Part& q = parts_[other];
  int d = -1;
  for (int k = 0; k < 3; ++k)
    if (q.v[k] == b && q.v[(k + 1) % 3] == a) d = q.v[(k + 2) % 3];
  return orientation(c, d, b) > 0 && orientation(d, c, a) > 0;
}

void FaceTriangulation::flip(int part, int edge) {
  const Part p = parts_[part];
  const int other = p.next[edge];
  const Part q = parts_[other];
  const int a = p.v[edge], b = p.v[(edge + 1) % 3], c = p.v[(edge + 2) % 3];
  int k = 0;
  while (q.v[k] != b || q.v[(k + 1) % 3] != a) ++k;
  const int d = q.v[(k + 2) % 3];
  const int bc = (edge + 1) % 3, ca = (edge + 2) % 3, ad = (k + 1) % 3, db = (k + 2) % 3;
  parts_[part] = {{c, d, b}, {other, q.next[db], p.next[bc]}, {free_edge, q.kind[db], p.kind[bc]}};
  parts_[other] = {{d, c, a}, {part, p.next[ca], q.next[ad]}, {free_edge, p.kind[ca], q.kind[ad]}};
  link(part, 1, q.next[db], other);
  link(other, 1, p.next[ca], part);
  part_of_[b] = part_of_[c] = part;
  part_of_[a] = part_of_[d] = other;
}

bool FaceTriangulation::ahead(int a, int b, int v) const {
  for (const int axis : {i_, j_}) {
    const int towards = compare(points_[b], points_[a], axis);
    if (towards != 0) return compare(points_[v], points_[a], axis) == towards;
  }
  return false;
}

bool FaceTriangulation::find_edge(int from, int to, int& part, int& edge) const {
  const int start = part_of_[from];
  for (const bool clockwise : {false, true}) {
    int p = start;
    for (std::size_t n = 0; n <= parts_.size(); ++n) {
      const int k = corner_of(p, from);
      if (parts_[p].v[(k + 1) % 3] == to) {
        part = p, edge = k;
        return true;
      }
      if (parts_[p].v[(k + 2) % 3] == to) {
        part = p, edge = (k + 2) % 3;
        return true;
      }
      p = clockwise ? parts_[p].next[k] : parts_[p].next[(k + 2) % 3];
      if (p == outside || p == start) break;
    }
  }
  return false;
}

bool FaceTriangulation::force(int from, int to, int plane, std::vector<std::array<int, 2>> crossed) {
  std::deque<std::array<int, 2>> left(crossed.begin(), crossed.end());
  std::size_t patience = 20 + 4 * left.size() * left.size();
  while (!left.empty()) {
    if (patience-- == 0) return false;
    const auto [u, v] = left.front();
    left.pop_front();
    int part = 0, edge = 0;
    if (!find_edge(u, v, part, edge)) return false;
    if (!convex(part, edge)) {
      left.push_back({u, v});
      continue;
    }
    flip(part, edge);
    const int c = parts_[part].v[0], d = parts_[part].v[1];
    if (c == from || c == to || d == from || d == to) continue;
    if (orientation(from, to, c) * orientation(from, to, d) < 0) left.push_back({c, d});
  }
  int part = 0, edge = 0;
  if (!find_edge(from, to, part, edge)) return false;
  const auto mark = [&](int p, int k) {
    if (parts_[p].kind[k] == free_edge) parts_[p].kind[k] = plane;
  };
  mark(part, edge);
  const int other = parts_[part].next[edge];
  if (other != outside) {
    const int head = parts_[part].v[(edge + 1) % 3];
    for (int k = 0; k < 3; ++k)
      if (parts_[other].next[k] == part && parts_[other].v[k] == head) mark(other, k);
  }
  return true;
}

bool FaceTriangulation::add_segment(int a, int b, const GridPlane& plane) {
  const int id = static_cast<int>(segment_planes_.size());
  segment_planes_.push_back(plane);
  std::size_t patience = 1000 + 20 * parts_.size();
  while (a != b) {
    // The part at `a` through which the segment leaves.
    int part = part_of_[a], along = -1, v1 = -1, v2 = -1;
    const int start = part;
    bool found = false;
    for (const bool clockwise : {false, true}) {
      for (std::size_t n = 0; n <= parts_.size() && !found; ++n) {
        const int k = corner_of(part, a);
        v1 = parts_[part].v[(k + 1) % 3], v2 = parts_[part].v[(k + 2) % 3];
        const int o1 = orientation(a, b, v1), o2 = orientation(a, b, v2);
        if (v1 == b || (o1 == 0 && ahead(a, b, v1)))
          along = v1, found = true;
        else if (v2 == b || (o2 == 0 && ahead(a, b, v2)))
          along = v2, found = true;
        else if (o1 < 0 && o2 > 0)
          found = true;
        if (found) break;
        const int beyond = clockwise ? parts_[part].next[k] : parts_[part].next[(k + 2) % 3];
        if (beyond == outside || beyond == start) break;
        part = beyond;
      }
      if (found) break;
      part = start;
    }
    if (!found) return false;
    std::vector<std::array<int, 2>> crossed;
    int target = along;
    while (target < 0) {
      if (patience-- == 0) return false;
      int k = 0;
      while (parts_[part].v[k] != v1 || parts_[part].v[(k + 1) % 3] != v2) ++k;
      const int kind = parts_[part].kind[k];
      if (kind == side_edge) return false;
      if (kind >= 0) {
        target = new_vertex(common_point(plane_, plane, segment_planes_[kind]));
        split_edge(part, k, target);
        break;
      }
      crossed.push_back({v1, v2});
      const int beyond = parts_[part].next[k];
      const int v3 = parts_[beyond].v[(edge_towards(beyond, part) + 2) % 3];
      part = beyond;
      const int o = v3 == b ? 0 : orientation(a, b, v3);
      if (o == 0)
        target = v3;
      else if (o > 0)
        v2 = v3;
      else
        v1 = v3;
    }
    if (!force(a, target, id, std::move(crossed))) return false;
    a = target;
  }
  return true;
}

void FaceTriangulation::improve(const std::function<std::uint64_t(int)>& rank) {
  // Coordinates in the plane itself: the projection would distort the circles.
  const Vec3 n(static_cast<double>(plane_.normal[0]), static_cast<double>(plane_.normal[1]),
               static_cast<double>(plane_.normal[2]));
  const Vec3 normal = n / n.norm();
  const auto place = [&](int v) { return Vec3(points_[v].approx[0], points_[v].approx[1], points_[v].approx[2]); };
  const Vec3 origin = place(0);
  std::size_t patience = 30 * parts_.size() + 30;
  int sweeps = 20;
  for (bool changed = true; changed && patience > 0 && sweeps > 0; --sweeps) {
    changed = false;
    for (int part = 0; part < static_cast<int>(parts_.size()); ++part) {
      for (int k = 0; k < 3; ++k) {
        const Part& p = parts_[part];
        if (p.kind[k] != free_edge || patience == 0) continue;
        const int other = p.next[k], back = edge_towards(other, part);
        const int a = p.v[k], b = p.v[(k + 1) % 3], c = p.v[(k + 2) % 3], d = parts_[other].v[(back + 2) % 3];
        // Sum of the angles at c and d over pi: sin(c + d) < 0.
        const Vec3 pa = place(a) - origin, pb = place(b) - origin, pc = place(c) - origin, pd = place(d) - origin;
        const Vec3 ca = pa - pc, cb = pb - pc, da = pa - pd, db = pb - pd;
        const double cos_c = ca | cb, cos_d = da | db;
        const double sin_c = (ca % cb) | normal, sin_d = (db % da) | normal;
        const double excess = sin_c * cos_d + cos_c * sin_d;
        const double size = std::sqrt(ca.sqrnorm() * cb.sqrnorm() * da.sqrnorm() * db.sqrnorm());
        bool wanted = excess < -1e-9 * size;
        if (!wanted && excess < 1e-9 * size) wanted = std::min(rank(c), rank(d)) < std::min(rank(a), rank(b));
        if (!wanted || !convex(part, k)) continue;
        flip(part, k);
        --patience;
        changed = true;
      }
    }
  }
}

std::vector<std::array<int, 3>> FaceTriangulation::triangles() const {
  std::vector<std::array<int, 3>> result;
  for (const Part& p : parts_) result.push_back(p.v);
  return result;
}

}  // namespace tri

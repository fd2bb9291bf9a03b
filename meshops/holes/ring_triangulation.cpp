#include "meshops/holes/ring_triangulation.hpp"

#include <algorithm>
#include <deque>

#include "meshops/shape/triangle_normal.hpp"

namespace tri {

RingTriangulation::RingTriangulation(std::span<const Vec3> ring, std::span<const Vec3> edge_normals,
                                     const ChordTest& chord_allowed, RingObjective objective,
                                     std::span<const std::int32_t> left, std::span<const RingTriangle> triangles)
    : ring_(ring), edge_normals_(edge_normals), chord_allowed_(chord_allowed), objective_(objective),
      scale_(objective == RingObjective::area ? 0 : bending_scale(ring)), next_(ring.size(), -1),
      owner_(ring.size(), -1) {
  for (std::size_t i = 0; i < left.size(); ++i) next_[left[i]] = left[(i + 1) % left.size()];
  if (!edge_normals.empty()) {
    along_.push_back(Vec3(0, 0, 0));
    for (std::size_t i = 0; i < ring.size(); ++i)
      along_.push_back(along_.back() + edge_normals[i] * (ring[(i + 1) % ring.size()] - ring[i]).norm());
  }
  triangles_.reserve(ring.size());
  beside_.reserve(ring.size());
  normal_.reserve(ring.size());
  std::vector<std::int32_t> all;
  for (RingTriangle t : triangles) {
    // Corners ascend, so that the corners of any connected piece, sorted, are the ring around it.
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    all.push_back(static_cast<std::int32_t>(triangles_.size()));
    triangles_.push_back(t);
    normal_.push_back(triangle_normal(ring_[t[0]], ring_[t[1]], ring_[t[2]]));
  }
  beside_.resize(triangles_.size());
  link(all, {});
}

/// Joins the triangles of `piece` with each other and with what lies outside.
void RingTriangulation::link(const std::vector<std::int32_t>& piece, const std::vector<Outside>& outside) {
  sides_.clear();
  for (const std::int32_t t : piece)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      if (next_[a] == b) {
        beside_[t][k] = ~a;
        owner_[a] = t;
      } else {
        sides_.push_back({std::min(a, b), std::max(a, b), t, k});
      }
    }
  std::sort(sides_.begin(), sides_.end(),
            [](const Side& a, const Side& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& s = sides_[i];
    if (i + 1 < sides_.size() && sides_[i + 1].low == s.low && sides_[i + 1].high == s.high) {
      const Side& o = sides_[++i];
      beside_[s.triangle][s.corner] = o.triangle;
      beside_[o.triangle][o.corner] = s.triangle;
      continue;
    }
    const std::int32_t from = triangles_[s.triangle][s.corner], to = triangles_[s.triangle][(s.corner + 1) % 3];
    const auto found = std::lower_bound(outside.begin(), outside.end(), from,
                                        [](const Outside& o, std::int32_t v) { return o.from < v; });
    const std::int32_t other = found->beyond;
    beside_[s.triangle][s.corner] = other;
    for (int k = 0; k < 3; ++k)
      if (triangles_[other][k] == to && triangles_[other][(k + 1) % 3] == from) beside_[other][k] = s.triangle;
  }
}

Vec3 RingTriangulation::normal_beyond(std::int32_t beyond) const {
  if (beyond >= 0) return normal_[beyond];
  const std::int32_t edge = ~beyond;
  if (edge_normals_.empty()) return Vec3(0, 0, 0);
  const std::int32_t end = next_[edge];
  if (end == (edge + 1) % static_cast<std::int32_t>(ring_.size())) return edge_normals_[edge];
  return unit_or_zero(end > edge ? along_[end] - along_[edge] : along_.back() - along_[edge] + along_[end]);
}

double RingTriangulation::side_cost(const Vec3& a, const Vec3& b, const Vec3& normal, const Vec3& beyond) const {
  if (beyond[0] == 0 && beyond[1] == 0 && beyond[2] == 0) return 0;
  return scale_ * (b - a).norm() * bending(normal, beyond);
}

int RingTriangulation::side_towards(std::int32_t triangle, std::int32_t other) const {
  return beside_[triangle][0] == other ? 0 : beside_[triangle][1] == other ? 1 : 2;
}

void RingTriangulation::add_ear(const RingTriangle& ear) {
  const std::int32_t p = ear[0], b = ear[1], r = ear[2], base = owner_[p];
  const auto t = static_cast<std::int32_t>(triangles_.size());
  // Sorted corners: p, b, r runs with the ring, so it is sorted up to a rotation.
  RingTriangle corners = ear;
  Sides sides{~p, ~b, base};
  const auto first = std::min_element(corners.begin(), corners.end()) - corners.begin();
  std::rotate(corners.begin(), corners.begin() + first, corners.end());
  std::rotate(sides.begin(), sides.begin() + first, sides.end());
  beside_[base][side_towards(base, ~p)] = t;
  triangles_.push_back(corners);
  beside_.push_back(sides);
  normal_.push_back(triangle_normal(ring_[p], ring_[b], ring_[r]));
  next_[p] = b;
  next_[b] = r;
  owner_[p] = owner_[b] = t;
  flips_.assign(1, {t, side_towards(t, base)});
  while (!flips_.empty()) {
    const auto [triangle, side] = flips_.back();
    flips_.pop_back();
    flip_if_lighter(triangle, side);
  }
}

bool RingTriangulation::flip_if_lighter(std::int32_t t, int k) {
  const std::int32_t u = beside_[t][k];
  if (u < 0) return false;
  const int m = side_towards(u, t);
  // t = (a, b, c), u = (b, a, d); afterwards t = (c, a, d), u = (d, b, c).
  const std::int32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3],
                     d = triangles_[u][(m + 2) % 3];
  const std::int32_t bc = beside_[t][(k + 1) % 3], ca = beside_[t][(k + 2) % 3], ad = beside_[u][(m + 1) % 3],
                     db = beside_[u][(m + 2) % 3];
  const Vec3 &pa = ring_[a], &pb = ring_[b], &pc = ring_[c], &pd = ring_[d];
  const Vec3 across_t = (pa - pc) % (pd - pc), across_u = (pb - pd) % (pc - pd);
  const double area_t = across_t.norm(), area_u = across_u.norm();
  const double area_now = triangle_area(pa, pb, pc) + triangle_area(pb, pa, pd), area_then = 0.5 * (area_t + area_u);
  double now = area_now, then = area_then;
  const Vec3 normal_t = area_t > 0 ? across_t / area_t : Vec3(0, 0, 0),
             normal_u = area_u > 0 ? across_u / area_u : Vec3(0, 0, 0);
  if (scale_ > 0) {
    const Vec3 n_bc = normal_beyond(bc), n_ca = normal_beyond(ca), n_ad = normal_beyond(ad), n_db = normal_beyond(db);
    now += side_cost(pa, pb, normal_[t], normal_[u]) + side_cost(pb, pc, normal_[t], n_bc) +
           side_cost(pc, pa, normal_[t], n_ca) + side_cost(pa, pd, normal_[u], n_ad) +
           side_cost(pd, pb, normal_[u], n_db);
    then += side_cost(pc, pd, normal_t, normal_u) + side_cost(pb, pc, normal_u, n_bc) +
            side_cost(pc, pa, normal_t, n_ca) + side_cost(pa, pd, normal_t, n_ad) + side_cost(pd, pb, normal_u, n_db);
  }
  if (!(then < now * (1 - 1e-9))) return false;
  if (chord_allowed_ && !chord_allowed_(std::min(c, d), std::max(c, d))) return false;
  const auto put = [&](std::int32_t triangle, RingTriangle corners, Sides sides, const Vec3& normal) {
    const auto first = std::min_element(corners.begin(), corners.end()) - corners.begin();
    std::rotate(corners.begin(), corners.begin() + first, corners.end());
    std::rotate(sides.begin(), sides.begin() + first, sides.end());
    triangles_[triangle] = corners;
    beside_[triangle] = sides;
    normal_[triangle] = normal;
  };
  if (ad >= 0)
    beside_[ad][side_towards(ad, u)] = t;
  else
    owner_[~ad] = t;
  if (bc >= 0)
    beside_[bc][side_towards(bc, t)] = u;
  else
    owner_[~bc] = u;
  put(t, {c, a, d}, {ca, ad, u}, normal_t);
  put(u, {d, b, c}, {db, bc, t}, normal_u);
  for (int i = 0; i < 3; ++i) {
    if (beside_[t][i] != u) flips_.push_back({t, i});
    if (beside_[u][i] != t) flips_.push_back({u, i});
  }
  return true;
}

std::size_t RingTriangulation::improve_pieces(int piece, double least_turn, const Context& context) {
  std::vector<int> visits(triangles_.size(), 0);
  std::vector<char> waiting(triangles_.size(), 0);
  std::deque<std::int32_t> queue;
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (const std::int32_t other : beside_[t])
      if (other >= 0 && !waiting[t] && normal_turn(normal_[t], normal_[other]) > least_turn) {
        waiting[t] = 1;
        queue.push_back(static_cast<std::int32_t>(t));
      }
  std::size_t changed = 0;
  while (!queue.empty()) {
    const std::int32_t seed = queue.front();
    queue.pop_front();
    if (!waiting[seed]) continue;
    context.checkpoint();
    collect(seed, static_cast<std::size_t>(piece));
    // What lies deep in the piece has been looked at.
    const std::size_t middle = std::max<std::size_t>(1, piece_.size() / 4);
    for (std::size_t i = 0; i < middle; ++i) {
      waiting[piece_[i]] = 0;
      ++visits[piece_[i]];
    }
    if (!replace_if_lighter()) continue;
    ++changed;
    for (const std::int32_t t : piece_)
      if (!waiting[t] && visits[t] < 8) {
        waiting[t] = 1;
        queue.push_back(t);
      }
  }
  return changed;
}

/// The connected triangles nearest to `seed`, by steps.
void RingTriangulation::collect(std::int32_t seed, std::size_t size) {
  in_piece_.resize(triangles_.size(), 0);
  for (const std::int32_t t : piece_) in_piece_[t] = 0;
  piece_.assign(1, seed);
  in_piece_[seed] = 1;
  for (std::size_t i = 0; i < piece_.size() && piece_.size() < size; ++i)
    for (const std::int32_t other : beside_[piece_[i]]) {
      if (other < 0 || in_piece_[other] || piece_.size() == size) continue;
      in_piece_[other] = 1;
      piece_.push_back(other);
    }
}

bool RingTriangulation::replace_if_lighter() {
  if (piece_.size() < 2) return false;
  find_ring_of_piece();
  DihedralAreaWeight now;
  for (const std::int32_t t : piece_) {
    const RingTriangle& c = triangles_[t];
    now.area += triangle_area(ring_[c[0]], ring_[c[1]], ring_[c[2]]);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t other = beside_[t][k];
      const bool outside = other < 0 || !in_piece_[other];
      if (!outside && other < t) continue;
      const Vec3 beyond = normal_beyond(other);
      if (outside && beyond.sqrnorm() == 0) continue;
      if (objective_ == RingObjective::dihedral_area)
        now.turn = std::max(now.turn, normal_turn(normal_[t], beyond));
      else
        now.area += side_cost(ring_[c[k]], ring_[c[(k + 1) % 3]], normal_[t], beyond);
    }
  }
  places_.clear();
  normals_.clear();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    places_.push_back(ring_[corners_[i]]);
    normals_.push_back(normal_beyond(outside_[i].beyond));
  }
  ChordTest allowed;
  if (chord_allowed_) allowed = [this](int i, int j) { return chord_allowed_(corners_[i], corners_[j]); };
  found_.clear();
  const auto least = triangulate_ring(places_, normals_, allowed, objective_, found_, scale_);
  // Equal within rounding is no gain; else two pieces could go back and forth.
  if (!least || least->turn > now.turn + 1e-9) return false;
  if (least->turn >= now.turn - 1e-9 && least->area > now.area * (1 - 1e-9)) return false;
  put_piece();
  return true;
}

void RingTriangulation::put_piece() {
  for (std::size_t i = 0; i < piece_.size(); ++i) {
    RingTriangle& t = triangles_[piece_[i]];
    for (int k = 0; k < 3; ++k) t[k] = corners_[found_[i][k]];
    normal_[piece_[i]] = triangle_normal(ring_[t[0]], ring_[t[1]], ring_[t[2]]);
  }
  link(piece_, outside_);
}

bool RingTriangulation::solve_piece(std::int32_t around, int size, const PieceSolver& solver) {
  collect(around, static_cast<std::size_t>(size));
  if (piece_.size() < 2) return false;
  find_ring_of_piece();
  found_.clear();
  if (!solver(piece_, corners_, found_)) return false;
  put_piece();
  return true;
}

void RingTriangulation::find_ring_of_piece() {
  corners_.clear();
  outside_.clear();
  for (const std::int32_t t : piece_)
    for (int k = 0; k < 3; ++k) {
      corners_.push_back(triangles_[t][k]);
      const std::int32_t other = beside_[t][k];
      if (other < 0 || !in_piece_[other]) outside_.push_back({triangles_[t][k], other});
    }
  std::sort(corners_.begin(), corners_.end());
  corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  std::sort(outside_.begin(), outside_.end(), [](const Outside& a, const Outside& b) { return a.from < b.from; });
}

}  // namespace tri

#include "meshops/holes/polygon_triangulation.hpp"

#include <cmath>
#include <queue>

#include "meshops/holes/awake_points.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * ((b - a) % (c - a));
}

bool is_zero(const Vec3& v) {
  return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

Vec3 newell_normal(std::span<const Vec3> ring) {
  Vec3 sum(0, 0, 0);
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += area_vector(ring[0], ring[i], ring[i + 1]);
  return unit_or_zero(sum);
}

/// The state of `cut_nearest_diagonals`: a doubly linked ring and a queue of ears whose stale entries are told by a
/// stamp.
class EarCutter {
 public:
  EarCutter(std::span<const Vec3> ring, std::span<const Vec3> vertex_normals, const ChordTest& chord_allowed)
      : ring_(ring), chord_allowed_(chord_allowed), n_(static_cast<int>(ring.size())), size_(n_), next_(ring.size()),
        previous_(ring.size()), stamp_(ring.size(), 0), reflex_(ring.size(), 0), awake_(ring), waiting_(ring.size()),
        reference_(ring.size()) {
    const Vec3 mean = newell_normal(ring);
    for (int i = 0; i < n_; ++i) {
      next_[i] = i + 1 < n_ ? i + 1 : 0;
      previous_[i] = i > 0 ? i - 1 : n_ - 1;
      reference_[i] = vertex_normals.empty() ? mean : unit_or_zero(vertex_normals[i] + mean);
    }
    for (int i = 0; i < n_; ++i) {
      reflex_[i] = bend(i);
      awake_.set(i, reflex_[i] != 0);
    }
    for (int i = 0; i < n_; ++i) push(i);
  }

  bool run(int rest, std::vector<RingTriangle>& triangles, std::vector<std::int32_t>& left) {
    const std::size_t before = triangles.size();
    while (size_ > std::max(rest, 3)) {
      const int b = pop();
      if (b < 0) {
        triangles.resize(before);
        return false;
      }
      triangles.push_back({previous_[b], b, next_[b]});
      cut(b);
    }
    int start = 0;
    while (stamp_[start] < 0) ++start;
    if (rest < 3) {
      triangles.push_back({start, next_[start], next_[next_[start]]});
      return true;
    }
    int i = start;
    do {
      left.push_back(i);
      i = next_[i];
    } while (i != start);
    return true;
  }

 private:
  struct Ear {
    int rank;  // 0 flat, 1 upright, 2 folds or covers a vertex: only when nothing else is left
    double diagonal;
    int vertex;
    int stamp;
    bool operator<(const Ear& other) const {  // std::priority_queue pops the greatest
      if (rank != other.rank) return rank > other.rank;
      if (diagonal != other.diagonal) return diagonal > other.diagonal;
      return vertex > other.vertex;
    }
  };

  /// 0 if the ear of `b` lies along the surface, 1 if it stands upright on it or has no area, 2 if it folds back.
  char bend(int b) const {
    const Vec3 normal = unit_or_zero(area_vector(ring_[previous_[b]], ring_[b], ring_[next_[b]]));
    const double along = normal | reference_[b];
    return along > 0.3 ? 0 : along > -0.3 ? 1 : 2;
  }

  /// The first vertex which is not convex that ear `b` would cover, seen along the ear's normal; -1 if none.
  int covered(int b) const {
    const Vec3 &p = ring_[previous_[b]], &q = ring_[b], &r = ring_[next_[b]];
    const Vec3 normal = (q - p) % (r - p);
    const double square = normal.sqrnorm();
    if (square == 0) return -1;
    // In the prism over the triangle, no farther from its apex than its longest side.
    const double reach = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
    const Vec3 around(reach, reach, reach);
    return awake_.find(q - around, q + around, [&](int v) {
      if (v == b || v == previous_[b] || v == next_[b]) return false;
      const Vec3& s = ring_[v];
      if ((s - q).sqrnorm() > reach * reach || s == p || s == r || s == q) return false;
      return (((r - q) % (s - q)) | normal) >= 0 && (((p - r) % (s - r)) | normal) >= 0 &&
             (((q - p) % (s - p)) | normal) >= 0;
    });
  }

  void push(int b) {
    if (size_ > 3 && chord_allowed_) {
      const int p = previous_[b], r = next_[b];
      if (!chord_allowed_(std::min(p, r), std::max(p, r))) return;
    }
    int rank = reflex_[b];
    if (rank < 2) {
      const int blocker = covered(b);
      if (blocker >= 0) {
        rank = 2;
        waiting_[blocker].push_back(b);
      }
    }
    queue_.push({rank, (ring_[next_[b]] - ring_[previous_[b]]).norm(), b, stamp_[b]});
  }

  int pop() {
    while (!queue_.empty()) {
      const Ear ear = queue_.top();
      queue_.pop();
      if (stamp_[ear.vertex] == ear.stamp) return ear.vertex;
    }
    return -1;
  }

  void renew(int b) {
    if (stamp_[b] < 0) return;
    ++stamp_[b];
    const bool was = reflex_[b] != 0;
    reflex_[b] = bend(b);
    const bool is = reflex_[b] != 0;
    awake_.set(b, is);
    push(b);
    if (was && !is) wake(b);
  }

  /// Looks again at the ears that waited for vertex `q`.
  void wake(int q) {
    std::vector<int> ears;
    ears.swap(waiting_[q]);
    for (const int b : ears) {
      if (stamp_[b] < 0) continue;
      ++stamp_[b];
      push(b);
    }
  }

  void cut(int b) {
    const int p = previous_[b], r = next_[b];
    next_[p] = r;
    previous_[r] = p;
    stamp_[b] = -1;
    awake_.set(b, false);
    --size_;
    renew(p);
    renew(r);
    wake(b);
  }

  std::span<const Vec3> ring_;
  const ChordTest& chord_allowed_;
  int n_, size_;
  std::vector<int> next_, previous_, stamp_;
  std::vector<char> reflex_;  // bend() of each vertex; not convex if above 0
  AwakePoints awake_;         // those that are not convex and not cut yet
  std::vector<std::vector<int>> waiting_;
  std::vector<Vec3> reference_;
  std::priority_queue<Ear> queue_;
};

}  // namespace

std::optional<DihedralAreaWeight> triangulate_ring(std::span<const Vec3> ring, std::span<const Vec3> edge_normals,
                                                   const ChordTest& chord_allowed, RingObjective objective,
                                                   std::vector<RingTriangle>& triangles, double scale) {
  const int n = static_cast<int>(ring.size());
  const auto allowed = [&](int i, int j) { return !chord_allowed || chord_allowed(i, j); };
  if (objective == RingObjective::area)
    return triangulate_polygon<DihedralAreaWeight>(
        n, allowed,
        [&](int i, int k, int j, int, int) -> std::optional<DihedralAreaWeight> {
          return DihedralAreaWeight{0, area_vector(ring[i], ring[k], ring[j]).norm()};
        },
        triangles);
  // The triangle chosen beyond a chord is asked for its normal n times.
  struct Known {
    std::int32_t apex = -1;
    Vec3 normal;
  };
  std::vector<Known> known(n >= 3 ? detail::ring_pairs(n) : 0);
  const auto normal_beyond = [&](int i, int apex, int j) -> const Vec3& {
    Known& entry = known[detail::ring_pair(i, j)];
    if (entry.apex != apex) entry = {apex, unit_or_zero(area_vector(ring[i], ring[apex], ring[j]))};
    return entry.normal;
  };
  if (objective == RingObjective::bending && scale == 0) scale = bending_scale(ring);
  const auto weight = [&](int i, int k, int j, int apex_ik, int apex_kj) -> std::optional<DihedralAreaWeight> {
    const Vec3 vector = area_vector(ring[i], ring[k], ring[j]);
    const double area = vector.norm();
    const Vec3 normal = area > 0 ? vector / area : Vec3(0, 0, 0);
    DihedralAreaWeight w{0, area};
    const auto beside = [&](const Vec3& other, int a, int b) {
      if (objective == RingObjective::bending)
        w.area += scale * bending(normal, other) * (ring[a] - ring[b]).norm();
      else
        w.turn = std::max(w.turn, normal_turn(normal, other));
    };
    const auto beside_ring = [&](int edge, int a, int b) {
      if (!edge_normals.empty() && !is_zero(edge_normals[edge])) beside(edge_normals[edge], a, b);
    };
    if (apex_ik >= 0)
      beside(normal_beyond(i, apex_ik, k), i, k);
    else
      beside_ring(i, i, k);
    if (apex_kj >= 0)
      beside(normal_beyond(k, apex_kj, j), k, j);
    else
      beside_ring(k, k, j);
    if (i == 0 && j == n - 1) beside_ring(n - 1, i, j);
    return w;
  };
  return triangulate_polygon<DihedralAreaWeight>(n, allowed, weight, triangles);
}

double bending_scale(std::span<const Vec3> ring) {
  double length = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) length += (ring[i] - ring[(i + 1) % ring.size()]).norm();
  return 0.03 * length;
}

bool cut_nearest_diagonals(std::span<const Vec3> ring, std::span<const Vec3> vertex_normals,
                           const ChordTest& chord_allowed, int rest, std::vector<RingTriangle>& triangles,
                           std::vector<std::int32_t>& left) {
  if (ring.size() < 3) return false;
  return EarCutter(ring, vertex_normals, chord_allowed).run(rest, triangles, left);
}

}  // namespace tri

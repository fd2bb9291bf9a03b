#include "meshops/polygon_triangulation.hpp"

#include <cmath>
#include <queue>

namespace tri {
namespace {

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? v / length : Vec3(0, 0, 0);
}

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * ((b - a) % (c - a));
}

bool is_zero(const Vec3& v) {
  return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/// 1 - cos of the angle between two unit normals; a triangle without area has no normal and counts as a fold.
double turn(const Vec3& a, const Vec3& b) {
  return is_zero(a) || is_zero(b) ? 2.0 : 1.0 - (a | b);
}

Vec3 newell_normal(std::span<const Vec3> ring) {
  Vec3 sum(0, 0, 0);
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += area_vector(ring[0], ring[i], ring[i + 1]);
  return unit(sum);
}

/// The state of `cut_nearest_diagonals`: a doubly linked ring and a queue of ears whose stale entries are told by a
/// stamp.
class EarCutter {
 public:
  EarCutter(std::span<const Vec3> ring, std::span<const Vec3> vertex_normals,
            const std::function<bool(int, int)>& chord_allowed)
      : ring_(ring),
        chord_allowed_(chord_allowed),
        n_(static_cast<int>(ring.size())),
        size_(n_),
        next_(ring.size()),
        previous_(ring.size()),
        stamp_(ring.size(), 0),
        reflex_(ring.size(), 0),
        waiting_(ring.size()),
        reference_(ring.size()) {
    const Vec3 mean = newell_normal(ring);
    for (int i = 0; i < n_; ++i) {
      next_[i] = i + 1 < n_ ? i + 1 : 0;
      previous_[i] = i > 0 ? i - 1 : n_ - 1;
      reference_[i] = vertex_normals.empty() ? mean : unit(vertex_normals[i] + mean);
    }
    for (int i = 0; i < n_; ++i) {
      reflex_[i] = bend(i);
      if (reflex_[i]) reflex_list_.push_back(i);
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
    const Vec3 normal = unit(area_vector(ring_[previous_[b]], ring_[b], ring_[next_[b]]));
    const double along = normal | reference_[b];
    return along > 0.3 ? 0 : along > -0.3 ? 1 : 2;
  }

  /// The first vertex which is not convex that ear `b` would cover, seen along the ear's normal; -1 if none.
  int covered(int b) {
    const Vec3 &p = ring_[previous_[b]], &q = ring_[b], &r = ring_[next_[b]];
    const Vec3 normal = (q - p) % (r - p);
    const double square = normal.sqrnorm();
    if (square == 0) return -1;
    const double reach = std::max({(q - p).sqrnorm(), (r - q).sqrnorm(), (p - r).sqrnorm()});
    std::size_t kept = 0;
    int found = -1;
    for (std::size_t i = 0; i < reflex_list_.size(); ++i) {
      const int v = reflex_list_[i];
      if (stamp_[v] < 0 || !reflex_[v]) continue;  // dropped from the list
      reflex_list_[kept++] = v;
      if (found >= 0 || v == b || v == previous_[b] || v == next_[b]) continue;
      const Vec3& s = ring_[v];
      if ((s - q).sqrnorm() > reach) continue;
      if (s == p || s == r || s == q) continue;
      const double in_p = ((r - q) % (s - q)) | normal, in_q = ((p - r) % (s - r)) | normal,
                   in_r = ((q - p) % (s - p)) | normal;
      if (in_p >= 0 && in_q >= 0 && in_r >= 0) found = v;
    }
    reflex_list_.resize(kept);
    return found;
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
    if (is && !was) reflex_list_.push_back(b);
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
    --size_;
    renew(p);
    renew(r);
    wake(b);
  }

  std::span<const Vec3> ring_;
  const std::function<bool(int, int)>& chord_allowed_;
  int n_, size_;
  std::vector<int> next_, previous_, stamp_;
  std::vector<char> reflex_;  // bend() of each vertex; not convex if above 0
  std::vector<int> reflex_list_;
  std::vector<std::vector<int>> waiting_;
  std::vector<Vec3> reference_;
  std::priority_queue<Ear> queue_;
};

}  // namespace

bool triangulate_ring_dihedral_area(std::span<const Vec3> ring, std::span<const Vec3> edge_normals,
                                    const std::function<bool(int, int)>& chord_allowed,
                                    std::vector<RingTriangle>& triangles) {
  const int n = static_cast<int>(ring.size());
  const auto normal_of = [&](int i, int k, int j) { return unit(area_vector(ring[i], ring[k], ring[j])); };
  const auto weight = [&](int i, int k, int j, int apex_ik, int apex_kj) -> std::optional<DihedralAreaWeight> {
    const Vec3 vector = area_vector(ring[i], ring[k], ring[j]);
    const Vec3 normal = unit(vector);
    DihedralAreaWeight w{0, vector.norm()};
    const auto beside = [&](const Vec3& other) { w.turn = std::max(w.turn, turn(normal, other)); };
    const auto beside_ring = [&](int edge) {
      if (!edge_normals.empty() && !is_zero(edge_normals[edge])) beside(edge_normals[edge]);
    };
    if (apex_ik >= 0)
      beside(normal_of(i, apex_ik, k));
    else
      beside_ring(i);
    if (apex_kj >= 0)
      beside(normal_of(k, apex_kj, j));
    else
      beside_ring(k);
    if (i == 0 && j == n - 1) beside_ring(n - 1);
    return w;
  };
  const auto allowed = [&](int i, int j) { return !chord_allowed || chord_allowed(i, j); };
  return triangulate_polygon<DihedralAreaWeight>(n, allowed, weight, triangles).has_value();
}

bool cut_nearest_diagonals(std::span<const Vec3> ring, std::span<const Vec3> vertex_normals,
                           const std::function<bool(int, int)>& chord_allowed, int rest,
                           std::vector<RingTriangle>& triangles, std::vector<std::int32_t>& left) {
  if (ring.size() < 3) return false;
  return EarCutter(ring, vertex_normals, chord_allowed).run(rest, triangles, left);
}

}  // namespace tri

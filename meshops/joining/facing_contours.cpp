#include "meshops/joining/facing_contours.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "meshops/holes/boundary_loops.hpp"
#include "meshops/search/nearest_points.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

constexpr double widest_base_angle = 165 * std::numbers::pi / 180;  // beyond, a step runs along the contour instead of
                                                                    // across the gap
constexpr double lone_base_angle = 120 * std::numbers::pi / 180;    // the same where the other contour has turned away
constexpr double least_common_course = 0.6;  // cosine; below, a contour turns away, as at a corner

/// The boundary as seen from the start of one of its half-edges.
struct Station {
  HalfedgeHandle halfedge;
  Vec3 point, along, outward;  ///< along the half-edges; away from the faces
  int loop = 0;
  double arc = 0;  ///< length from the loop's first station
};

Vec3 face_normal(MeshView view, FaceHandle f) {
  const HalfedgeHandle h = view.mesh.halfedge_handle(f);
  const Vec3& a = view.point(view.mesh.from_vertex_handle(h));
  const Vec3& b = view.point(view.mesh.to_vertex_handle(h));
  const Vec3& c = view.point(view.mesh.to_vertex_handle(view.mesh.next_halfedge_handle(h)));
  return unit_or_zero((b - a) % (c - a));
}

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2((a % b).norm(), a | b);
}

/// One end of a run that grows: the current diagonal and the next base on either side.
struct Front {
  VertexHandle p, q;              ///< the diagonal, first and second contour
  HalfedgeHandle p_base, q_base;  ///< boundary half-edges to be covered next
  bool forward = true;            ///< in the direction of the first contour's half-edges
};

}  // namespace

double turn_at(MeshView view, HalfedgeHandle base, VertexHandle a, VertexHandle b, VertexHandle c) {
  const Vec3 n = unit_or_zero((view.point(b) - view.point(a)) % (view.point(c) - view.point(a)));
  if (n.sqrnorm() == 0) return std::numbers::pi;
  const Vec3 beside = face_normal(view, view.mesh.face_handle(view.mesh.opposite_halfedge_handle(base)));
  return beside.sqrnorm() == 0 ? 0 : angle(n, beside);
}

FacingContours::FacingContours(MeshView mesh, const std::vector<double>& spacing, const FacingLimits& limits)
    : view_(mesh), spacing_(spacing), limits_(limits) {
  for (const auto& cycle : boundary_cycles(mesh))
    for (const HalfedgeHandle h : cycle) {
      vertices_.push_back(mesh.mesh.from_vertex_handle(h));
      points_.push_back(mesh.point(vertices_.back()));
    }
  tree_ = std::make_unique<NearestPoints>(points_);
}

FacingContours::~FacingContours() = default;

double FacingContours::reach(VertexHandle a, VertexHandle b) const {
  if (std::isfinite(limits_.max_distance)) return limits_.max_distance;
  return limits_.max_gap * std::max(spacing_[a.idx()], spacing_[b.idx()]);
}

std::vector<FacingContours::Seed> FacingContours::seeds() const {
  const auto& mesh = view_.mesh;
  std::vector<Station> stations;
  std::vector<double> loop_length;
  for (const auto& cycle : boundary_cycles(view_)) {
    double arc = 0;
    for (std::size_t i = 0; i < cycle.size(); ++i) {
      const HalfedgeHandle h = cycle[i], before = cycle[(i + cycle.size() - 1) % cycle.size()];
      Station s;
      s.halfedge = h;
      s.point = view_.point(mesh.from_vertex_handle(h));
      s.along = unit_or_zero(view_.point(mesh.to_vertex_handle(h)) - view_.point(mesh.from_vertex_handle(before)));
      const Vec3 normal = face_normal(view_, mesh.face_handle(mesh.opposite_halfedge_handle(h))) +
                          face_normal(view_, mesh.face_handle(mesh.opposite_halfedge_handle(before)));
      s.outward = unit_or_zero(normal % s.along);
      s.loop = static_cast<int>(loop_length.size());
      s.arc = arc;
      arc += (view_.point(mesh.to_vertex_handle(h)) - s.point).norm();
      stations.push_back(s);
    }
    loop_length.push_back(arc);
  }
  std::vector<Vec3> points;
  for (const Station& s : stations) points.push_back(s.point);
  const NearestPoints tree(points);
  std::vector<NearestPoints::Neighbor> neighbors;

  const auto facing = [&](const Station& a, const Station& b, double distance) {
    if ((a.along | b.along) > -0.3) return false;
    const Vec3 across = (b.point - a.point) / distance;
    if ((across | a.outward) < -0.2 || (across | b.outward) > 0.2) return false;
    if (a.loop == b.loop) {
      const double arc = std::abs(a.arc - b.arc);
      if (std::min(arc, loop_length[a.loop] - arc) < 2 * distance) return false;
    }
    return true;
  };
  std::vector<int> mate(stations.size(), -1);
  std::vector<double> nearness(stations.size(), 1);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Station& a = stations[i];
    if (!view_.may_fill({&a.halfedge, 1})) continue;
    const VertexHandle va = mesh.from_vertex_handle(a.halfedge);
    tree.within(a.point, reach(va, va), neighbors);
    for (const NearestPoints::Neighbor& neighbor : neighbors) {
      const int k = static_cast<int>(neighbor.index);
      const Station& b = stations[k];
      const VertexHandle vb = mesh.from_vertex_handle(b.halfedge);
      if (va == vb) continue;
      const double distance = (b.point - a.point).norm();
      const double share = distance / reach(va, vb);
      if (!(share < nearness[i] || (share == nearness[i] && mate[i] >= 0 && k < mate[i]))) continue;
      if (distance <= 1e-9 * reach(va, vb) || !facing(a, b, distance)) continue;
      nearness[i] = share;
      mate[i] = k;
    }
  }
  struct Candidate {
    bool one_sided;
    double nearness;
    int first, second;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (mate[i] < 0) continue;
    const bool mutual = mate[mate[i]] == static_cast<int>(i);
    if (mutual && mate[i] < static_cast<int>(i)) continue;
    candidates.push_back({!mutual, nearness[i], static_cast<int>(i), mate[i]});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    if (a.one_sided != b.one_sided) return b.one_sided;
    if (a.nearness != b.nearness) return a.nearness < b.nearness;
    return a.first < b.first;
  });
  std::vector<Seed> result;
  for (const Candidate& c : candidates)
    result.push_back({stations[c.first].halfedge, stations[c.second].halfedge, c.nearness});
  return result;
}

std::optional<ContourRun> FacingContours::grow(const Seed& seed) const {
  const auto& mesh = view_.mesh;
  const auto free = [&](HalfedgeHandle h) { return mesh.is_boundary(h) && view_.may_fill({&h, 1}); };
  if (!free(seed.first) || !free(seed.second)) return std::nullopt;
  const VertexHandle p0 = mesh.from_vertex_handle(seed.first), q0 = mesh.from_vertex_handle(seed.second);
  if (p0 == q0 || mesh.find_halfedge(p0, q0).is_valid()) return std::nullopt;

  std::unordered_set<int> used;
  const auto far_end = [&](HalfedgeHandle base, VertexHandle near) {
    const VertexHandle to = mesh.to_vertex_handle(base);
    return to == near ? mesh.from_vertex_handle(base) : to;
  };
  // The next base on the same contour, away from the seed.
  const auto beyond = [&](HalfedgeHandle base, bool along) {
    return along ? mesh.next_halfedge_handle(base) : mesh.prev_halfedge_handle(base);
  };
  const auto midpoint = [&](VertexHandle a, VertexHandle b) { return 0.5 * (view_.point(a) + view_.point(b)); };

  // Where a contour is heading: over one edge, and over two, which is steadier where it is ragged.
  struct Course {
    Vec3 one, two;
  };
  const auto course = [&](HalfedgeHandle base, VertexHandle near, bool along) -> Course {
    const VertexHandle middle = far_end(base, near);
    return {unit_or_zero(view_.point(middle) - view_.point(near)),
            unit_or_zero(view_.point(far_end(beyond(base, along), middle)) - view_.point(near))};
  };
  const auto turns_away = [&](const Course& own, const Course& other, const Vec3& strip) {
    return std::max({own.one | strip, own.two | strip, own.one | other.one, own.two | other.two}) < least_common_course;
  };
  // Whether a vertex of another stretch of boundary lies between the ends of a diagonal, which it would be the first to
  // join.
  const auto crowded = [&](VertexHandle a, VertexHandle b, const Front& front) {
    const Vec3 center = midpoint(a, b);
    const double radius = 0.5 * (view_.point(a) - view_.point(b)).norm();
    std::vector<VertexHandle> near;
    std::vector<NearestPoints::Neighbor> inside;
    tree_->within(center, 0.999 * radius, inside);
    for (const NearestPoints::Neighbor& neighbor : inside) {
      const VertexHandle v = vertices_[neighbor.index];
      if (v == a || v == b || !mesh.is_boundary(v)) continue;
      if (near.empty()) {
        for (int side = 0; side < 2; ++side) {
          HalfedgeHandle forward = side == 0 ? front.p_base : front.q_base, backward = forward;
          for (int step = 0; step < 4; ++step) {
            for (const HalfedgeHandle h : {forward, backward})
              near.push_back(mesh.from_vertex_handle(h)), near.push_back(mesh.to_vertex_handle(h));
            forward = mesh.next_halfedge_handle(forward);
            backward = mesh.prev_halfedge_handle(backward);
          }
        }
      }
      if (std::find(near.begin(), near.end(), v) == near.end()) return true;
    }
    return false;
  };

  struct Step {
    bool valid = false, last = false;
    double diagonal = 0;
    VertexHandle next;
  };
  // The triangle over `base`, which starts at `near`, with its apex on the other contour.
  const auto look = [&](HalfedgeHandle base, VertexHandle near, VertexHandle apex, double widest,
                        const Front& front) -> Step {
    Step step;
    if (!free(base) || used.count(base.idx())) return step;
    step.next = far_end(base, near);
    if (step.next == apex) return step;
    step.diagonal = (view_.point(step.next) - view_.point(apex)).norm();
    if (step.diagonal > reach(step.next, apex)) return step;
    const VertexHandle a = mesh.from_vertex_handle(base), b = mesh.to_vertex_handle(base);
    // The triangle (a, b, apex) leaves the diagonal on its far side.
    const HalfedgeHandle side = step.next == b ? mesh.find_halfedge(b, apex) : mesh.find_halfedge(apex, a);
    if (side.is_valid()) {
      if (!free(side)) return step;
      step.last = true;
    }
    const Vec3 &pa = view_.point(a), &pb = view_.point(b), &pc = view_.point(apex);
    if (angle(pb - pa, pc - pa) > widest || angle(pa - pb, pc - pb) > widest) return step;
    if (turn_at(view_, base, a, b, apex) > limits_.max_turn) return step;
    if (crowded(step.next, apex, front)) return step;
    step.valid = true;
    return step;
  };

  ContourRun run;
  const auto grow_front = [&](Front front, std::vector<VertexHandle>& p_chain, std::vector<VertexHandle>& q_chain) {
    bool p_round = false, q_round = false;  // back at the seed
    std::vector<Vec3> trail{midpoint(front.p, front.q)};
    for (;;) {
      const Course p_course = course(front.p_base, front.p, front.forward),
                   q_course = course(front.q_base, front.q, !front.forward);
      const Vec3 strip = trail.size() < 3 ? unit_or_zero(p_course.two + q_course.two)
                                          : unit_or_zero(trail.back() - trail[trail.size() - 3]);
      const bool p_ends = p_round || !free(front.p_base) || turns_away(p_course, q_course, strip);
      const bool q_ends = q_round || !free(front.q_base) || turns_away(q_course, p_course, strip);
      Step p, q;
      if (!p_ends)
        p = look(front.p_base, front.p, front.q, q_ends && !q_round ? lone_base_angle : widest_base_angle, front);
      if (!q_ends)
        q = look(front.q_base, front.q, front.p, p_ends && !p_round ? lone_base_angle : widest_base_angle, front);
      // The last step of a closed pair comes back to the seed's own diagonal, which is no edge yet.
      if (!p.valid && !q.valid) return false;
      const bool take_p = p.valid && (!q.valid || p.diagonal <= q.diagonal);
      if (take_p) {
        used.insert(front.p_base.idx());
        front.p = p.next;
        front.p_base = beyond(front.p_base, front.forward);
        p_chain.push_back(front.p);
        p_round = front.p == p0;
      } else {
        used.insert(front.q_base.idx());
        front.q = q.next;
        front.q_base = beyond(front.q_base, !front.forward);
        q_chain.push_back(front.q);
        q_round = front.q == q0;
      }
      if (p_round && q_round) return true;
      if (take_p ? p.last : q.last) return false;
      trail.push_back(midpoint(front.p, front.q));
    }
  };

  std::vector<VertexHandle> p_back, q_back;
  run.first.push_back(p0);
  run.second.push_back(q0);
  run.closed = grow_front({p0, q0, seed.first, mesh.prev_halfedge_handle(seed.second), true}, run.first, run.second);
  if (!run.closed) {
    grow_front({p0, q0, mesh.prev_halfedge_handle(seed.first), seed.second, false}, p_back, q_back);
    run.first.insert(run.first.begin(), p_back.rbegin(), p_back.rend());
    run.second.insert(run.second.begin(), q_back.rbegin(), q_back.rend());
  }
  if (run.first.size() + run.second.size() < 4) return std::nullopt;
  return run;
}

}  // namespace tri

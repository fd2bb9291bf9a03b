#include "libtri/triangulation/patches/face_patch.hpp"

#include <algorithm>

#include "libtri/quiet_context.hpp"
#include "libtri/triangulation/delaunay.hpp"
#include "libtri/triangulation/patches/constrained_delaunay.hpp"

namespace tri {
namespace {

struct Segment {
  std::uint32_t from, to;  // positions in the plane's point list
  int edge, segment;
  bool along;
};

class Patcher {
 public:
  Patcher(const FaceDomain& domain, const std::vector<EdgeChain>& chains, std::span<const PlanePoint> nodes,
          std::span<const double> reach, std::span<const PlanePoint> points)
      : domain_(domain), chains_(chains), nodes_(nodes), reach_(reach), points_(points) {}

  FacePatch run(const Context& context) {
    collect();
    QuietContext quiet(context, context.threads);
    Delaunay delaunay = tri::delaunay(plane_, quiet);
    for (const auto& [duplicate, kept] : delaunay.duplicates) {
      // Chain nodes come first, so a duplicate that is one means that two nodes coincide.
      if (duplicate < n_nodes_) {
        fail(duplicate);
        fail(kept);
      } else {
        patch_.coincident.push_back({vertex_[duplicate], vertex_[kept]});
      }
    }
    if (!patch_.failed_edges.empty() || delaunay.triangles.empty()) return finish_failed();
    context.checkpoint();
    ConstrainedDelaunay triangulation(plane_, std::move(delaunay));
    for (const Segment& s : segments_) insert(triangulation, s);
    if (!patch_.failed_edges.empty() || !patch_.outside.empty()) return finish_failed();
    context.checkpoint();
    if (!flood(triangulation)) return finish_failed();
    context.checkpoint();
    emit(triangulation);
    return std::move(patch_);
  }

 private:
  void collect() {
    for (const auto& loop : domain_.loops) {
      const auto first = static_cast<std::uint32_t>(plane_.size());
      std::vector<Segment> run;
      for (const CoedgeCurve& curve : loop) {
        const EdgeChain& chain = chains_[static_cast<std::size_t>(curve.edge())];
        const int n = static_cast<int>(chain.size());
        for (int i = 0; i + 1 < n; ++i) {
          const int node = curve.reversed() ? n - 1 - i : i;
          const auto at = static_cast<std::uint32_t>(plane_.size());
          plane_.push_back(place(curve, chain[static_cast<std::size_t>(node)]));
          vertex_.push_back(chain[static_cast<std::size_t>(node)].vertex);
          node_edge_.push_back(curve.edge());
          run.push_back({at, at + 1, curve.edge(), curve.reversed() ? node - 1 : node, !curve.reversed()});
        }
      }
      if (run.empty()) continue;
      run.back().to = first;
      segments_.insert(segments_.end(), run.begin(), run.end());
    }
    n_nodes_ = plane_.size();
    for (const PlanePoint& p : points_) {
      plane_.push_back(p.p);
      vertex_.push_back(p.vertex);
    }
  }

  Vec2 place(const CoedgeCurve& curve, const ChainNode& node) const {
    const Vec2 on_curve = curve.plane_point(node.s);
    const auto own = std::lower_bound(nodes_.begin(), nodes_.end(), node.vertex,
                                      [](const PlanePoint& p, std::uint32_t vertex) { return p.vertex < vertex; });
    if (own == nodes_.end() || own->vertex != node.vertex) return on_curve;
    // Near the ends places are not in the order of the chain, and on the curve the chain's is as good.
    const double reach = reach_[static_cast<std::size_t>(curve.edge())], off = (own->p - on_curve).norm();
    const bool inner = std::min(node.s, 1 - node.s) * curve.length() > 2 * reach;
    return inner && off <= reach && off > 1e-3 * reach ? own->p : on_curve;
  }

  void fail(std::uint32_t node) { patch_.failed_edges.push_back(node_edge_[node]); }

  FacePatch finish_failed() {
    auto& f = patch_.failed_edges;
    if (f.empty() && patch_.outside.empty()) f = node_edge_;
    std::sort(f.begin(), f.end());
    f.erase(std::unique(f.begin(), f.end()), f.end());
    return std::move(patch_);
  }

  void insert(ConstrainedDelaunay& triangulation, const Segment& s) {
    switch (triangulation.insert(s.from, s.to)) {
      case ConstrainedDelaunay::Outcome::inserted:
        return;
      case ConstrainedDelaunay::Outcome::meets_vertex:
        if (triangulation.blocking() >= n_nodes_) {
          patch_.outside.push_back(vertex_[triangulation.blocking()]);
          return;
        }
        fail(triangulation.blocking());
        [[fallthrough]];
      default:
        patch_.failed_edges.push_back(s.edge);
    }
  }

  // From the left of the loops inwards. A way around a loop means that it runs the wrong way or is crossed.
  bool flood(const ConstrainedDelaunay& triangulation) {
    const auto n = triangulation.triangles().size();
    inside_.assign(n, 0);
    std::vector<std::int32_t> stack;
    const auto enter = [&](std::int32_t t) {
      if (inside_[static_cast<std::size_t>(t)]) return;
      inside_[static_cast<std::size_t>(t)] = 1;
      stack.push_back(t);
    };
    for (const Segment& s : segments_) {
      const auto side = triangulation.left_of(s.from, s.to);
      if (side.triangle < 0) return false;
      enter(side.triangle);
    }
    while (!stack.empty()) {
      const std::int32_t t = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        if (triangulation.fixed(t, k)) continue;
        const std::int32_t next = triangulation.neighbors()[static_cast<std::size_t>(t)][k];
        if (next < 0) return false;
        enter(next);
      }
    }
    for (const Segment& s : segments_) {
      const auto right = triangulation.left_of(s.to, s.from);
      if (right.triangle >= 0 && inside_[static_cast<std::size_t>(right.triangle)]) {
        patch_.failed_edges.push_back(s.edge);
        return false;
      }
    }
    return true;
  }

  void emit(ConstrainedDelaunay& triangulation) {
    const auto n = triangulation.triangles().size();
    std::vector<std::int32_t> number(n, -1);
    std::vector<std::uint8_t> used(plane_.size(), 0);
    std::int32_t count = 0;
    for (std::size_t t = 0; t < n; ++t) {
      if (!inside_[t]) continue;
      number[t] = count++;
      for (const std::uint32_t v : triangulation.triangles()[t]) used[v] = 1;
    }
    for (const Segment& s : segments_) {
      const auto side = triangulation.left_of(s.from, s.to);
      patch_.sides.push_back(
          {number[static_cast<std::size_t>(side.triangle)], side.corner, s.edge, s.segment, s.along});
    }
    // In place: a triangle moves forward if at all.
    triangulation.release(patch_.triangles, patch_.neighbors);
    for (std::size_t t = 0; t < n; ++t) {
      if (!inside_[t]) continue;
      const Triangle q = patch_.triangles[t];
      patch_.triangles[static_cast<std::size_t>(number[t])] = {vertex_[q[0]], vertex_[q[1]], vertex_[q[2]]};
      std::array<std::int32_t, 3> around = patch_.neighbors[t];
      for (int k = 0; k < 3; ++k)
        around[k] = triangulation.fixed(static_cast<std::int32_t>(t), k) || around[k] < 0
                        ? -1
                        : number[static_cast<std::size_t>(around[k])];
      patch_.neighbors[static_cast<std::size_t>(number[t])] = around;
    }
    patch_.triangles.resize(static_cast<std::size_t>(count));
    patch_.neighbors.resize(static_cast<std::size_t>(count));
    for (std::size_t i = n_nodes_; i < plane_.size(); ++i)
      if (!used[i]) patch_.outside.push_back(vertex_[i]);
    if (!patch_.coincident.empty()) {
      std::vector<std::uint32_t> gone;
      for (const auto& pair : patch_.coincident) gone.push_back(pair[0]);
      std::sort(gone.begin(), gone.end());
      std::erase_if(patch_.outside, [&](std::uint32_t v) { return std::binary_search(gone.begin(), gone.end(), v); });
    }
  }

  const FaceDomain& domain_;
  const std::vector<EdgeChain>& chains_;
  std::span<const PlanePoint> nodes_;
  std::span<const double> reach_;
  std::span<const PlanePoint> points_;
  std::vector<Vec2> plane_;
  std::vector<std::uint32_t> vertex_;
  std::vector<int> node_edge_;
  std::size_t n_nodes_ = 0;
  std::vector<Segment> segments_;
  std::vector<std::uint8_t> inside_;
  FacePatch patch_;
};

}  // namespace

FacePatch triangulate_face(const FaceDomain& domain, const std::vector<EdgeChain>& chains,
                           std::span<const PlanePoint> nodes, std::span<const double> reach,
                           std::span<const PlanePoint> points, const Context& context) {
  return Patcher(domain, chains, nodes, reach, points).run(context);
}

}  // namespace tri

#include "meshops/operators/flip_diagonals.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <queue>
#include <utility>
#include <vector>

#include "meshops/editing/mesh_edit.hpp"
#include "meshops/shape/flips/curvature_criterion.hpp"
#include "meshops/shape/flips/delaunay_criterion.hpp"
#include "meshops/shape/flips/flip_criterion.hpp"
#include "meshops/shape/flips/smooth_shape_criterion.hpp"

namespace tri {
namespace {

using Verdict = FlipCriterion::Verdict;

std::unique_ptr<FlipCriterion> make_criterion(MeshView mesh, const FlipDiagonalsOptions& options,
                                              const Context& context) {
  switch (options.criterion) {
    case FlipRule::delaunay:
      return delaunay_criterion(mesh, options.sharp_angle, context);
    case FlipRule::curvature:
      return curvature_criterion(mesh, context);
    default:
      return smooth_shape_criterion(mesh, options.sharp_angle, context);
  }
}

class Flipper {
 public:
  Flipper(MeshView view, const FlipDiagonalsOptions& options, Context& context)
      : view_(view), mesh_(view.mesh), context_(context), criterion_(make_criterion(view, options, context)) {}

  Report run() {
    prepare();
    criterion_->describe("before", report_, context_);
    work();
    count_refused();
    criterion_->describe("after", report_, context_);
    collect_touched();
    return std::move(report_);
  }

 private:
  using Ends = std::pair<int, int>;

  void prepare() {
    queued_.resize(mesh_.n_edges());
    touched_.resize(mesh_.n_faces());
    if (by_gain_) gains_.resize(mesh_.n_edges());
    for (int i = 0; i < edge_count(); ++i) {
      if (i % 1024 == 0) context_.checkpoint();
      enter(EdgeHandle(i));
    }
  }

  void work() {
    std::size_t looked_at = 0;
    double share = 0;
    while (!queue_.empty() || !ranked_.empty()) {
      if (looked_at++ % 1024 == 0) {
        context_.checkpoint();
        const std::size_t left = queue_.size() + ranked_.size();
        share = std::max(share, static_cast<double>(looked_at) / static_cast<double>(looked_at + left));
        context_.progress("flip-diagonals", share);
      }
      const EdgeHandle e = next();
      if (!e.is_valid()) continue;
      const FlipQuad quad = flip_quad(mesh_, e);
      if (criterion_->judge(quad) == Verdict::flip && !waits(quad)) flip(quad);
    }
    context_.progress("flip-diagonals", 1);
  }

  /// Takes an edge out of the queue; not valid if what was entered has been overtaken.
  EdgeHandle next() {
    if (by_gain_) {
      const auto [gain, i] = ranked_.top();
      ranked_.pop();
      if (gain != gains_[static_cast<std::size_t>(-i)]) return EdgeHandle();
      gains_[static_cast<std::size_t>(-i)] = 0;
      return EdgeHandle(-i);
    }
    const EdgeHandle e = queue_.front();
    queue_.pop_front();
    queued_[e.idx()] = 0;
    return e;
  }

  /// True if the other diagonal is an edge already; then the edge is entered again when that one goes.
  bool waits(const FlipQuad& quad) {
    if (mesh_.is_flip_ok(quad.edge)) return false;
    blocked_[std::minmax({quad.corner[2].idx(), quad.corner[3].idx()})].push_back(quad.edge);
    return true;
  }

  void count_refused() {
    std::uint64_t refused = 0, there_already = 0;
    for (int i = 0; i < edge_count(); ++i) {
      if (i % 1024 == 0) context_.checkpoint();
      const EdgeHandle e(i);
      if (!is_inner_edge(mesh_, e) || !view_.may_change(e)) continue;
      if (criterion_->judge(flip_quad(mesh_, e)) == Verdict::keep) continue;
      ++(mesh_.is_flip_ok(e) ? refused : there_already);
    }
    if (refused) report_.skipped[criterion_->reason()] = refused;
    if (there_already) report_.skipped["is an edge already"] = there_already;
  }

  void flip(const FlipQuad& quad) {
    flip_edge(view_, quad.edge);
    criterion_->flipped(quad);
    const Ends ends = std::minmax({quad.corner[0].idx(), quad.corner[1].idx()});
    if (const auto it = blocked_.find(ends); it != blocked_.end()) {
      for (const EdgeHandle e : it->second) enter(e);
      blocked_.erase(it);
    }
    ++report_.edges_flipped;
    for (const FaceHandle f : quad.face) touched_[f.idx()] = 1;
    if (by_gain_) enter(quad.edge);
    for (const HalfedgeHandle side : quad.side) {
      const HalfedgeHandle beyond = mesh_.opposite_halfedge_handle(side);
      if (mesh_.is_boundary(beyond)) continue;
      enter(mesh_.edge_handle(side));
      // The quadrilaterals beyond have a changed triangle beside them.
      enter(mesh_.edge_handle(mesh_.next_halfedge_handle(beyond)));
      enter(mesh_.edge_handle(mesh_.prev_halfedge_handle(beyond)));
    }
  }

  void collect_touched() {
    for (std::size_t i = 0; i < touched_.size(); ++i)
      if (touched_[i]) report_.touched_faces.push_back(static_cast<std::uint32_t>(i));
  }

  void enter(EdgeHandle e) {
    if (!is_inner_edge(mesh_, e) || !view_.may_change(e)) return;
    if (by_gain_) {
      const FlipQuad quad = flip_quad(mesh_, e);
      std::int64_t& gain = gains_[e.idx()];
      gain = criterion_->judge(quad) == Verdict::flip && !waits(quad) ? criterion_->gain() : 0;
      if (gain > 0) ranked_.emplace(gain, -e.idx());
    } else if (!queued_[e.idx()]) {
      queued_[e.idx()] = 1;
      queue_.push_back(e);
    }
  }

  int edge_count() const { return static_cast<int>(mesh_.n_edges()); }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  Context& context_;
  Report report_;
  std::unique_ptr<FlipCriterion> criterion_;
  const bool by_gain_ = criterion_->largest_gain_first();
  std::vector<char> queued_;   ///< per edge
  std::vector<char> touched_;  ///< per face
  std::deque<EdgeHandle> queue_;
  std::vector<std::int64_t> gains_;  ///< by gain, per edge: of the entry that counts; 0 for none
  /// By gain: the gain and minus the index of the edge, so that of equal ones the lowest edge is first.
  std::priority_queue<std::pair<std::int64_t, int>> ranked_;
  std::map<Ends, std::vector<EdgeHandle>> blocked_;  ///< edges that wait for the edge between these ends to go
};

}  // namespace

const OptionSchema& FlipDiagonalsOptions::schema() {
  using O = FlipDiagonalsOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("criterion", &O::criterion,
                  {{"smooth-shape", FlipRule::smooth_shape},
                   {"delaunay", FlipRule::delaunay},
                   {"curvature", FlipRule::curvature}},
                  {.help = "smoothness where sharp and shape elsewhere; Delaunay where smooth; least curvature"})
          .angle("sharp-angle", &O::sharp_angle,
                 {.min = 0,
                  .max = 179,
                  .help = "angle between two normals above which an edge is sharp; curvature does without"});
  return schema;
}

Report flip_diagonals(MeshView mesh, const FlipDiagonalsOptions& options, Context& context) {
  validate(options);
  return Flipper(mesh, options, context).run();
}

}  // namespace tri

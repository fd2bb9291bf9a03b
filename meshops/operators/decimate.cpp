#include "meshops/operators/decimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "meshops/checks/report_distance.hpp"
#include "meshops/crossings/crossing_guard.hpp"
#include "meshops/editing/attribute_seams.hpp"
#include "meshops/editing/mesh_before.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/editing/plain_vector.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/shape/bucket_queue.hpp"
#include "meshops/shape/collapse_stars.hpp"
#include "meshops/shape/features.hpp"
#include "meshops/shape/quadric.hpp"
#include "meshops/shape/triangle_shape.hpp"

namespace tri {
namespace {

constexpr double boundary_weight = 10;  // of a boundary's upright planes against surface of the same extent
constexpr double crease_weight = 1;
constexpr double shape_weight = 1e-10;      // of the length of an edge: decides where there is no error, on planes
constexpr double rounding = 1e-12;          // of the area times the squared length: costs that differ by less are equal
constexpr double least_turn_cosine = 0.25;  // between the normals of a triangle before and after
constexpr std::size_t queue_block = 8192;

enum class VertexKind : std::uint8_t { free, line, fixed };

enum class Reason : std::uint8_t { none, line, error, topology, flip, needle, crossing, numbers, count };

constexpr std::array<const char*, static_cast<std::size_t>(Reason::count)> reason_names{
    "",
    "would move a boundary, a seam or what is not selected",
    "error above the limit",
    "would change the topology",
    "would turn a triangle over",
    "would make a needle",
    "would make triangles cross",
    "numbers out of range"};

/// A collapse as it would be done.
struct Collapse {
  HalfedgeHandle halfedge;  ///< from the end that goes to the one that stays
  Vec3 place{0, 0, 0};
  Vec3 to_place{0, 0, 0};  ///< from the middle of the edge
  double cost = 0;         ///< decides the order; without unit
  double error2 = 0;       ///< squared, model units
};

class Decimator {
 public:
  Decimator(MeshView view, const DecimateOptions& options, Context& context)
      : view_(view), mesh_(view.mesh), options_(options), context_(context), queue_(view.mesh.n_edges()),
        stars_(view.mesh) {}

  Report run() {
    for (std::size_t i = 0; i < mesh_.n_faces(); ++i) {
      const FaceHandle f(static_cast<int>(i));
      faces_ += !mesh_.status(f).deleted() && view_.may_replace(f);
    }
    start_ = faces_;
    target_ = target();
    if (faces_ > target_) {
      std::optional<MeshBefore> before;
      if (!std::isinf(options_.max_error)) before.emplace(view_);
      prepare();
      work();
      if (before && faces_ < start_) report_distance(*before, view_, report_, context_);
    }
    finish();
    return std::move(report_);
  }

 private:
  std::size_t target() const {
    std::size_t result = 0;
    if (options_.faces > 0) result = static_cast<std::size_t>(options_.faces);
    if (options_.ratio > 0)
      result = std::max(result, static_cast<std::size_t>(std::floor(options_.ratio * static_cast<double>(start_))));
    if (options_.faces == 0 && options_.ratio == 0 && std::isinf(options_.max_error)) result = (start_ + 1) / 2;
    return result;
  }

  void prepare() {
    const Features features = find_features(view_, {.angle = options_.feature_angle}, context_);
    const std::vector<std::uint8_t> seams = attribute_seams(view_);
    lines_.resize(mesh_.n_edges());
    kinds_.resize(mesh_.n_vertices());
    quadrics_.resize(mesh_.n_vertices());
    reasons_.assign(mesh_.n_edges(), Reason::none);
    moved_.assign(mesh_.n_vertices(), 0);
    find_unit();
    guard_.emplace(view_, context_);
    for_each_block(context_, "", mesh_.n_edges(), queue_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        lines_[i] = features.edges[i] == EdgeClass::boundary || (!seams.empty() && seams[i]);
    });
    for_each_block(context_, "", mesh_.n_vertices(), queue_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) prepare_vertex(VertexHandle(static_cast<int>(i)), features);
    });
    std::vector<std::uint32_t> bucket(mesh_.n_edges());
    for_each_block(context_, "", mesh_.n_edges(), queue_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const EdgeHandle e(static_cast<int>(i));
        bucket[i] = BucketQueue::none;
        if (mesh_.status(e).deleted()) continue;
        Collapse c;
        reasons_[i] = plan(e, c);
        if (reasons_[i] == Reason::none) bucket[i] = BucketQueue::bucket_of(c.cost);
      }
    });
    for (std::size_t i = 0; i < bucket.size(); ++i)
      if (bucket[i] != BucketQueue::none) queue_.push(static_cast<std::uint32_t>(i), bucket[i]);
  }

  /// Takes the mean length of the edges as the unit in which costs are compared.
  void find_unit() {
    std::vector<std::array<double, 2>> sums((mesh_.n_edges() + queue_block - 1) / queue_block, {0, 0});
    for_each_block(context_, "", mesh_.n_edges(), queue_block,
                   [&](std::size_t block, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i) {
                       const EdgeHandle e(static_cast<int>(i));
                       if (mesh_.status(e).deleted()) continue;
                       const double length = edge_vector(mesh_.halfedge_handle(e, 0)).norm();
                       if (std::isfinite(length)) sums[block][0] += length, sums[block][1] += 1;
                     }
                   });
    double sum = 0, count = 0;
    for (const auto& s : sums) sum += s[0], count += s[1];
    const double mean = sum / count, fourth = mean * mean * mean * mean;
    per_unit_ = fourth > 0 && std::isfinite(1 / fourth) ? 1 / fourth : 1;
  }

  void prepare_vertex(VertexHandle v, const Features& features) {
    const auto i = static_cast<std::size_t>(v.idx());
    Quadric& q = quadrics_[i];
    q = Quadric();
    kinds_[i] = VertexKind::free;
    const HalfedgeHandle first = mesh_.halfedge_handle(v);
    if (mesh_.status(v).deleted() || !first.is_valid()) return;
    int lines = 0;
    HalfedgeHandle h = first;
    do {
      const EdgeHandle e = mesh_.edge_handle(h);
      const Vec3 along = edge_vector(h);
      const Vec3 left = face_vector(h);
      if (const double twice_area = left.norm(); twice_area > 0) {
        q.add_plane(left * std::sqrt(0.5 / twice_area));
        q.area += 0.5 * twice_area;
      }
      if (lines_[e.idx()]) ++lines;
      if (lines_[e.idx()] || features.is_feature(e)) {
        const double weight = features[e] == EdgeClass::boundary ? boundary_weight : crease_weight;
        add_upright(q, along, left, weight);
        add_upright(q, along, face_vector(mesh_.opposite_halfedge_handle(h)), weight);
      }
      h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
    } while (h != first);
    if (lines > 0) kinds_[i] = lines == 2 ? VertexKind::line : VertexKind::fixed;
    if (!view_.may_remove(v)) kinds_[i] = VertexKind::fixed;
  }

  /// Adds the plane through an edge at the origin that stands upright on a triangle at it.
  static void add_upright(Quadric& q, const Vec3& along, const Vec3& normal, double weight) {
    const Vec3 upright = along % normal;
    const double length = upright.norm();
    if (length > 0) q.add_plane(upright * (std::sqrt(weight) * along.norm() / length));
  }

  Vec3 edge_vector(HalfedgeHandle h) const {
    return view_.point(mesh_.to_vertex_handle(h)) - view_.point(mesh_.from_vertex_handle(h));
  }
  /// Twice the area times the unit normal; zero if there is no triangle.
  Vec3 face_vector(HalfedgeHandle h) const {
    if (mesh_.is_boundary(h)) return {0, 0, 0};
    return edge_vector(h) % edge_vector(mesh_.next_halfedge_handle(h));
  }

  /// Where and at what cost an edge would be collapsed.
  Reason plan(EdgeHandle e, Collapse& c) const {
    HalfedgeHandle h = mesh_.halfedge_handle(e, 0);
    VertexHandle goes = mesh_.from_vertex_handle(h), stays = mesh_.to_vertex_handle(h);
    if (kinds_[goes.idx()] > kinds_[stays.idx()]) {
      h = mesh_.opposite_halfedge_handle(h);
      std::swap(goes, stays);
    }
    const VertexKind a = kinds_[goes.idx()], b = kinds_[stays.idx()];
    if (a == VertexKind::fixed || (a == VertexKind::line && !lines_[e.idx()])) return Reason::line;
    c.halfedge = h;
    Vec3 half = (view_.point(stays) - view_.point(goes)) * 0.5;
    Quadric q = quadrics_[goes.idx()];
    q.move_origin(half);
    q.add_from(quadrics_[stays.idx()], -half);
    const double length2 = 4 * half.sqrnorm();
    const bool held = a != b;  // the one that stays is on a line or a corner
    double value = 0;
    if (held) {
      c.to_place = half;
      value = q.value(half);
    } else {
      place_freely(q, half, length2, c.to_place, value);
    }
    if (!held && (c.to_place | half) < 0) {  // the nearer end is the one that stays
      c.halfedge = mesh_.opposite_halfedge_handle(h);
      half = -half;
      std::swap(goes, stays);
    }
    c.place = c.to_place == half ? view_.point(stays) : view_.point(goes) + half + c.to_place;
    value = std::max(value, 0.0);
    c.error2 = q.area > 0 ? value / q.area : 0;
    c.cost = (value + shape_weight * q.area * length2) * per_unit_;
    if (!std::isfinite(c.cost) || !std::isfinite(c.place.sqrnorm())) return Reason::numbers;
    if (c.error2 > options_.max_error * options_.max_error) return Reason::error;
    return Reason::none;
  }

  /// The middle of the edge if nothing is better, else an end if nothing is better, else the best place.
  static void place_freely(const Quadric& q, const Vec3& half, double length2, Vec3& x, double& value) {
    const Vec3 best = q.least();
    const double equal = rounding * (q.area + q.xx + q.yy + q.zz) * length2;
    const double at_middle = q.c, at_from = q.value(-half), at_to = q.value(half);
    double at_best = best.sqrnorm() < 4 * length2 ? q.value(best) : std::numeric_limits<double>::infinity();
    const double least = std::min({at_best, at_middle, at_from, at_to});
    if (at_middle <= least + equal) {
      x = Vec3(0, 0, 0), value = at_middle;
    } else if (at_to <= least + equal) {
      x = half, value = at_to;
    } else if (at_from <= least + equal) {
      x = -half, value = at_from;
    } else {
      x = best, value = at_best;
    }
  }

  void work() {
    std::size_t steps = 0;
    double share = 0;
    while (faces_ > target_) {
      if (steps++ % 256 == 0) {
        context_.checkpoint();
        share = std::max(share, static_cast<double>(start_ - faces_) / static_cast<double>(start_ - target_));
        context_.progress("decimate", share);
      }
      const std::uint32_t i = queue_.pop();
      if (i == BucketQueue::none) break;
      const EdgeHandle e(static_cast<int>(i));
      if (mesh_.status(e).deleted()) continue;
      Collapse c;
      reasons_[i] = plan(e, c);
      if (reasons_[i] != Reason::none) continue;
      const std::uint32_t bucket = BucketQueue::bucket_of(c.cost);
      if (bucket > queue_.current()) {
        queue_.push(i, bucket);
        continue;
      }
      reasons_[i] = judge(c);
      if (reasons_[i] == Reason::none && guard_->collapse_makes_worse(c.halfedge, c.place))
        reasons_[i] = Reason::crossing;
      if (reasons_[i] == Reason::none) carry_out(c);
    }
    context_.progress("decimate", 1);
  }

  Reason judge(const Collapse& c) {
    stars_.look_at(c.halfedge);
    if (!stars_.keeps_topology([&](EdgeHandle e) { return lines_[e.idx()] != 0; })) return Reason::topology;
    const std::array<Vec3, 2> ends{view_.point(mesh_.from_vertex_handle(c.halfedge)),
                                   view_.point(mesh_.to_vertex_handle(c.halfedge))};
    double worst = 1;
    for (int end = 0; end < 2; ++end) {
      if (end == 1 && c.place == ends[1]) break;  // what is around it does not change
      for (const auto& [a, b] : stars_.fan(end)) {
        const Vec3 &p = view_.point(a), &q = view_.point(b);
        if (!directions_agree((q - p) % (ends[end] - p), (q - p) % (c.place - p), least_turn_cosine))
          return Reason::flip;
        worst = std::min(worst, roundness(p, q, c.place));
      }
    }
    if (worst >= options_.min_roundness) return Reason::none;
    double worst_before = 1;
    for (int end = 0; end < 2; ++end)
      for (const auto& [a, b] : stars_.fan(end))
        worst_before = std::min(worst_before, roundness(view_.point(a), view_.point(b), ends[end]));
    return worst > worst_before ? Reason::none : Reason::needle;
  }

  void carry_out(const Collapse& c) {
    const HalfedgeHandle h = c.halfedge, o = mesh_.opposite_halfedge_handle(h);
    const VertexHandle goes = mesh_.from_vertex_handle(h), stays = mesh_.to_vertex_handle(h);
    for (const HalfedgeHandle g : {h, o}) {
      if (mesh_.is_boundary(g)) continue;
      --faces_;
      // Of the two other sides, that of the vertex that stays remains.
      const int next = mesh_.edge_handle(mesh_.next_halfedge_handle(g)).idx();
      const int prev = mesh_.edge_handle(mesh_.prev_halfedge_handle(g)).idx();
      lines_[next] = lines_[prev] = lines_[next] || lines_[prev];
    }
    const Vec3 half = (view_.point(stays) - view_.point(goes)) * 0.5;
    Quadric& q = quadrics_[stays.idx()];
    q.move_origin(c.to_place - half);
    q.add_from(quadrics_[goes.idx()], half + c.to_place);
    greatest_ = std::max(greatest_, c.error2);
    if (c.place != view_.point(stays)) {
      // Where the new vertex is along the edge, for all its values.
      const double share = std::clamp(0.5 + (c.to_place | half) / (2 * half.sqrnorm()), 0.0, 1.0);
      blend_vertex(view_, stays, std::array{VertexSource{stays, share}, VertexSource{goes, 1 - share}});
      blend_corners(view_, h, share);
      set_point(view_, stays, c.place);
      moved_[stays.idx()] = 1;
    }
    collapse(view_, h);
    guard_->done();
    ++report_.vertices_removed;
    enter_again(stays);
  }

  /// What was refused around a vertex may do now.
  void enter_again(VertexHandle v) {
    const HalfedgeHandle first = mesh_.halfedge_handle(v);
    HalfedgeHandle h = first;
    do {
      enter_again(mesh_.edge_handle(h));
      enter_again(mesh_.edge_handle(mesh_.next_halfedge_handle(h)));
      h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
    } while (h != first);
  }
  void enter_again(EdgeHandle e) {
    const auto i = static_cast<std::uint32_t>(e.idx());
    if (reasons_[i] > Reason::error && !queue_.contains(i)) queue_.push(i, queue_.current());
  }

  void finish() {
    report_.faces_removed = start_ - faces_;
    report_.figures["faces"] = static_cast<double>(faces_);
    if (start_ == faces_) {
      if (faces_ == 0) report_.figures.clear();
      if (faces_ <= target_) return;
    }
    report_.figures["greatest error"] = std::sqrt(greatest_);
    for (std::size_t i = 0; i < moved_.size(); ++i) {
      if (!moved_[i] || mesh_.status(VertexHandle(static_cast<int>(i))).deleted()) continue;
      ++report_.vertices_moved;
      report_.touched_vertices.push_back(static_cast<std::uint32_t>(i));
    }
    if (faces_ <= target_) return;
    std::array<std::uint64_t, static_cast<std::size_t>(Reason::count)> counts{};
    for (std::size_t i = 0; i < reasons_.size(); ++i)
      if (!mesh_.status(EdgeHandle(static_cast<int>(i))).deleted()) ++counts[static_cast<std::size_t>(reasons_[i])];
    for (std::size_t k = 1; k < counts.size(); ++k)
      if (counts[k]) report_.skipped[reason_names[k]] = counts[k];
  }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  const DecimateOptions& options_;
  Context& context_;
  Report report_;
  BucketQueue queue_;
  std::size_t faces_ = 0, start_ = 0, target_ = 0;
  double per_unit_ = 1;
  double greatest_ = 0;
  PlainVector<Quadric> quadrics_;    ///< per vertex, relative to it
  PlainVector<VertexKind> kinds_;    ///< per vertex
  PlainVector<std::uint8_t> lines_;  ///< per edge: on a boundary or seam
  std::vector<Reason> reasons_;      ///< per edge: why it was refused last
  std::vector<std::uint8_t> moved_;  ///< per vertex
  CollapseStars stars_;
  std::optional<CrossingGuard> guard_;
};

}  // namespace

const OptionSchema& DecimateOptions::schema() {
  using O = DecimateOptions;
  static const OptionSchema schema =
      Schema<O>()
          .integer("faces", &O::faces,
                   {.unit = "faces", .min = 0, .help = "stop at this many faces; 0: no such target"})
          .number("ratio", &O::ratio,
                  {.min = 0, .max = 1, .help = "stop at this share of the faces; 0: no such target"})
          .number("max-error", &O::max_error,
                  {.unit = "mm",
                   .min = 0,
                   .infinite = true,
                   .help = "no collapse whose quadric error, a mean distance to planes, exceeds this; the greatest "
                           "distance may be some times more, and is measured and reported"})
          .angle("feature-angle", &O::feature_angle,
                 {.min = 0, .max = 180, .help = "angle between two normals above which an edge is held as a crease"})
          .number("min-roundness", &O::min_roundness,
                  {.min = 0, .max = 1, .help = "make no triangle less round (1: equilateral) where there was none"});
  return schema;
}

Report decimate(MeshView mesh, const DecimateOptions& options, Context& context) {
  validate(options);
  return Decimator(mesh, options, context).run();
}

}  // namespace tri

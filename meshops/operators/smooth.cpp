#include "meshops/operators/smooth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "meshops/editing/mesh_edit.hpp"
#include "meshops/editing/vertex_rows.hpp"
#include "meshops/error.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/limits.hpp"
#include "meshops/shape/curvature_flow.hpp"
#include "meshops/shape/features.hpp"

namespace tri {
namespace {

constexpr std::size_t smooth_block = 4096;
constexpr int steps_back = 4;  ///< of which the last goes all the way
constexpr double pass_band = 0.1;
constexpr double strongest_taubin = 0.65;  ///< from about 0.7 on the step back outgrows the one forward

using Part = CurvatureFlow::Part;

class Smoother {
 public:
  Smoother(MeshView view, const SmoothOptions& options, Context& context)
      : view_(view), mesh_(view.mesh), options_(options), context_(context) {}

  Report run() {
    context_.checkpoint();
    context_.progress("smooth", 0);
    read_points();
    sort_vertices();
    if (options_.method == SmoothMethod::cotangent)
      flow();
    else
      average();
    hold_back();
    describe();
    store();
    context_.progress("smooth", 1);
    return std::move(report_);
  }

 private:
  template <class Body>
  void for_vertices(const Body& body) {
    for_each_block(context_, "", before_.size(), smooth_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  void read_points() {
    before_.resize(mesh_.n_vertices());
    for_vertices([&](std::size_t i) { before_[i] = view_.point(VertexHandle(static_cast<int>(i))); });
    points_ = before_;
  }

  /// Which vertices move, and by which neighbours.
  void sort_vertices() {
    features_ = find_features(
        view_,
        {.angle = options_.feature_angle, .noise = Noise::unknown, .min_crease_edges = options_.min_feature_edges},
        context_);
    parts_.assign(before_.size(), Part::fixed);
    std::size_t on_crease = 0, on_boundary = 0, corners = 0, not_finite = 0, alive = 0, creased = 0;
    for (std::size_t i = 0; i < before_.size(); ++i) {
      const VertexHandle v(static_cast<int>(i));
      if (mesh_.status(v).deleted() || mesh_.is_isolated(v) || !view_.may_move(v)) continue;
      ++alive;
      const VertexClass c = features_[v];
      creased +=
          c == VertexClass::crease || c == VertexClass::dart || (c == VertexClass::corner && !mesh_.is_boundary(v));
      if (!is_finite(before_[i])) {
        ++not_finite;
      } else if (c == VertexClass::smooth || (c == VertexClass::dart && options_.creases == LineRule::along)) {
        parts_[i] = Part::surface;
      } else if (c == VertexClass::corner) {
        ++corners;
      } else if ((c == VertexClass::boundary ? options_.boundary : options_.creases) == LineRule::along) {
        parts_[i] = Part::line;
      } else {
        ++(c == VertexClass::boundary ? on_boundary : on_crease);
      }
    }
    for (const auto& [reason, count] : {std::pair("on a crease", on_crease), std::pair("on the boundary", on_boundary),
                                        std::pair("at a corner", corners), std::pair("not finite", not_finite)})
      if (count > 0) report_.skipped[reason] = count;
    if (5 * creased > alive)
      report_.notes.push_back(fmt::format(
          "{} of {} vertices lie on creases; if these are noise, a larger feature-angle lets them go", creased, alive));
    rows_ = vertex_rows(view_, context_, [&](VertexHandle v, HalfedgeHandle h) {
      const Part part = parts_[static_cast<std::size_t>(v.idx())];
      return part != Part::fixed && (part == Part::surface || features_.is_feature(mesh_.edge_handle(h))) &&
             is_finite(before_[static_cast<std::size_t>(mesh_.to_vertex_handle(h).idx())]);
    });
  }

  void average() {
    std::vector<Vec3> other(points_.size());
    for (int iteration = 0; iteration < options_.iterations; ++iteration) {
      pass(options_.strength, other);
      if (options_.method == SmoothMethod::taubin) pass(1 / (pass_band - 1 / options_.strength), other);
      finish_iteration(iteration);
    }
  }

  void pass(double factor, std::vector<Vec3>& to) {
    for_vertices([&](std::size_t i) {
      const std::uint32_t begin = rows_.begin[i], end = rows_.begin[i + 1];
      Vec3 sum(0, 0, 0);
      for (std::uint32_t k = begin; k < end; ++k) sum += points_[rows_.neighbor[k]] - points_[i];
      to[i] = points_[i];
      if (begin < end) to[i] += sum * (factor / (end - begin));
    });
    points_.swap(to);
  }

  void flow() {
    const double length = mean_length();
    if (!(length > 0)) return;
    const double time = options_.strength * length * length / 4;
    CurvatureFlow flow(view_, rows_, parts_);
    for (int iteration = 0; iteration < options_.iterations; ++iteration) {
      flow.step(points_, time, context_);
      finish_iteration(iteration);
    }
  }

  /// Of the entries of all rows; 0 if there is none.
  double mean_length() {
    std::vector<double> sums((before_.size() + smooth_block - 1) / smooth_block, 0);
    for_each_block(context_, "", before_.size(), smooth_block,
                   [&](std::size_t block, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i)
                       for (std::uint32_t k = rows_.begin[i]; k < rows_.begin[i + 1]; ++k)
                         sums[block] += (points_[rows_.neighbor[k]] - points_[i]).norm();
                   });
    double sum = 0;
    for (const double s : sums) sum += s;
    return rows_.neighbor.empty() ? 0 : sum / static_cast<double>(rows_.neighbor.size());
  }

  void finish_iteration(int iteration) {
    const double limit = options_.max_distance;
    if (std::isfinite(limit)) {
      held_.assign(points_.size(), 0);
      for_vertices([&](std::size_t i) {
        const Vec3 way = points_[i] - before_[i];
        const double distance = way.norm();
        if (!(distance > limit)) return;
        points_[i] = before_[i] + way * (limit / distance);
        held_[i] = 1;
      });
    }
    context_.progress("smooth", 0.95 * (iteration + 1) / options_.iterations);
  }

  /// Twice the vector area.
  Vec3 normal(const std::vector<Vec3>& points, FaceHandle f) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(f);
    const auto at = [&](HalfedgeHandle k) -> const Vec3& { return points[mesh_.to_vertex_handle(k).idx()]; };
    const Vec3& p = at(h);
    return (at(mesh_.next_halfedge_handle(h)) - p) % (at(mesh_.prev_halfedge_handle(h)) - p);
  }

  /// Calls `f(face)` for the triangles beyond the sides of a triangle, but not beyond features.
  template <class F>
  void for_each_beyond(FaceHandle face, const F& f) const {
    HalfedgeHandle h = mesh_.halfedge_handle(face);
    for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h))
      if (!features_.is_feature(mesh_.edge_handle(h))) f(mesh_.face_handle(mesh_.opposite_halfedge_handle(h)));
  }

  /// Faces away from what lies beside it.
  bool is_folded(const std::vector<Vec3>& points, FaceHandle f) const {
    Vec3 beside(0, 0, 0);
    for_each_beyond(f, [&](FaceHandle other) { beside += normal(points, other); });
    return (normal(points, f) | beside) < 0;
  }

  /// Takes vertices of triangles that were not folded over and now are back by half of their way, and again, and at
  /// last to where they were.
  void hold_back() {
    std::vector<char> queued(mesh_.n_faces(), 0);
    for_each_block(context_, "", queued.size(), smooth_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FaceHandle f(static_cast<int>(i));
        queued[i] = !mesh_.status(f).deleted() && is_folded(points_, f) && !is_folded(before_, f);
      }
    });
    std::deque<FaceHandle> queue;
    for (std::size_t i = 0; i < queued.size(); ++i)
      if (queued[i]) queue.push_back(FaceHandle(static_cast<int>(i)));
    if (queue.empty()) return;
    const auto enter = [&](FaceHandle f) {
      if (!f.is_valid() || queued[f.idx()]) return;
      queued[f.idx()] = 1;
      queue.push_back(f);
    };
    std::vector<std::uint8_t> steps(points_.size(), 0);
    for (std::size_t looked_at = 0; !queue.empty(); ++looked_at) {
      if (looked_at % 1024 == 0) context_.checkpoint();
      const FaceHandle f = queue.front();
      queue.pop_front();
      queued[f.idx()] = 0;
      if (!is_folded(points_, f) || is_folded(before_, f)) continue;
      HalfedgeHandle h = mesh_.halfedge_handle(f);
      for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h)) {
        const VertexHandle v = mesh_.to_vertex_handle(h);
        const auto i = static_cast<std::size_t>(v.idx());
        if (parts_[i] == Part::fixed || steps[i] == steps_back) continue;
        points_[i] = ++steps[i] == steps_back ? before_[i] : (points_[i] + before_[i]) / 2;
        for_each_outgoing(mesh_, v, [&](HalfedgeHandle out) {
          const FaceHandle around = mesh_.face_handle(out);
          enter(around);
          if (around.is_valid()) for_each_beyond(around, enter);
        });
      }
    }
    const auto held = points_.size() - static_cast<std::size_t>(std::ranges::count(steps, 0));
    report_.figures["held back from folding"] = static_cast<double>(held);
  }

  void describe() {
    double sum = 0, largest = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_[i] == before_[i] || parts_[i] == Part::fixed) continue;
      const double distance = (points_[i] - before_[i]).norm();
      sum += distance;
      largest = std::max(largest, distance);
      report_.touched_vertices.push_back(static_cast<std::uint32_t>(i));
    }
    report_.vertices_moved = report_.touched_vertices.size();
    if (report_.vertices_moved == 0) return;
    report_.figures["mean distance"] = sum / static_cast<double>(report_.vertices_moved);
    report_.figures["largest distance"] = largest;
    if (const auto held = std::ranges::count(held_, 1))
      report_.figures["held by max-distance"] = static_cast<double>(held);
    compare_faces();
  }

  /// Volume before and after, and faces that turned over.
  void compare_faces() {
    const auto corner = [&](HalfedgeHandle h) { return static_cast<std::size_t>(mesh_.to_vertex_handle(h).idx()); };
    struct Sums {
      double before = 0, after = 0, area = 0;
      std::size_t turned = 0;
      bool open = false;
    };
    std::vector<Sums> blocks((mesh_.n_faces() + smooth_block - 1) / smooth_block);
    const Vec3 origin = before_[report_.touched_vertices.front()];  // close by, so that less is rounded off
    for_each_block(context_, "", mesh_.n_faces(), smooth_block, [&](std::size_t b, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FaceHandle f(static_cast<int>(i));
        if (mesh_.status(f).deleted()) continue;
        HalfedgeHandle h = mesh_.halfedge_handle(f);
        std::array<std::size_t, 3> v;
        for (std::size_t k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h)) {
          v[k] = corner(h);
          blocks[b].open |= mesh_.is_boundary(mesh_.opposite_halfedge_handle(h));
        }
        const auto normal = [&](const std::vector<Vec3>& p) { return (p[v[1]] - p[v[0]]) % (p[v[2]] - p[v[0]]); };
        const Vec3 old_normal = normal(before_), new_normal = normal(points_);
        blocks[b].before += (before_[v[0]] - origin) | old_normal;
        blocks[b].after += (points_[v[0]] - origin) | new_normal;
        blocks[b].turned += (old_normal | new_normal) < 0;
      }
    });
    Sums all;
    for (const Sums& s : blocks) {
      all.before += s.before;
      all.after += s.after;
      all.turned += s.turned;
      all.open |= s.open;
    }
    if (all.turned > 0) report_.figures["faces turned over"] = static_cast<double>(all.turned);
    if (all.open) return;
    report_.figures["volume before"] = all.before / 6;
    report_.figures["volume after"] = all.after / 6;
  }

  void store() {
    context_.checkpoint();
    for (const std::uint32_t i : report_.touched_vertices)
      set_point(view_, VertexHandle(static_cast<int>(i)), points_[i]);
  }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  const SmoothOptions& options_;
  Context& context_;
  Report report_;
  Features features_;
  std::vector<Vec3> before_, points_;
  std::vector<Part> parts_;
  VertexRows rows_;
  std::vector<char> held_;  ///< per vertex: stopped by the last iteration; empty without a limit
};

/// What the schema cannot say: the range of the strength depends on the method.
void check_strength(const SmoothOptions& options) {
  const double most = options.method == SmoothMethod::laplace  ? 1
                      : options.method == SmoothMethod::taubin ? strongest_taubin
                                                               : 100;
  if (options.strength > most)
    throw InvalidInput(
        fmt::format("option strength = {} is not allowed; allowed with this method: a number above 0 to {}",
                    options.strength, most));
}

}  // namespace

const OptionSchema& SmoothOptions::schema() {
  using O = SmoothOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice(
              "method", &O::method,
              {{"laplace", SmoothMethod::laplace},
               {"taubin", SmoothMethod::taubin},
               {"cotangent", SmoothMethod::cotangent}},
              {.help =
                   "laplace evens out and shrinks, taubin keeps the volume, cotangent keeps vertices in their place"})
          .integer("iterations", &O::iterations, {.min = 1, .max = 100000, .help = "how often"})
          .number("strength", &O::strength,
                  {.min = 0,
                   .max = 100,
                   .min_open = true,
                   .help = "share of the way to the neighbours' mean: laplace up to 1, taubin 0.65, cotangent 100"})
          .angle("feature-angle", &O::feature_angle,
                 {.min = 0, .max = 180, .help = "edges with a larger angle between normals are creases; 180: none"})
          .integer("min-feature-edges", &O::min_feature_edges,
                   {.unit = "edges", .min = 1, .help = "creases that hang together in fewer edges are noise"})
          .choice("creases", &O::creases, {{"fixed", LineRule::fixed}, {"along", LineRule::along}},
                  {.help = "vertices on creases stay, or are smoothed along them"})
          .choice("boundary", &O::boundary, {{"fixed", LineRule::fixed}, {"along", LineRule::along}},
                  {.help = "vertices on the boundary stay, or are smoothed along it"})
          .number("max-distance", &O::max_distance,
                  {.unit = "mm",
                   .min = 0,
                   .min_open = true,
                   .infinite = true,
                   .help = "no vertex ends farther from where it was"});
  return schema;
}

Report smooth(MeshView mesh, const SmoothOptions& options, Context& context) {
  validate(options);
  check_strength(options);
  return Smoother(mesh, options, context).run();
}

}  // namespace tri

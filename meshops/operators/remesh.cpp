#include "meshops/operators/remesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "meshops/checks/report_distance.hpp"
#include "meshops/crossings/crossing_guard.hpp"
#include "meshops/editing/mesh_before.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/editing/place_values.hpp"
#include "meshops/error.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/search/closest_triangle.hpp"
#include "meshops/shape/collapse_stars.hpp"
#include "meshops/shape/curvature_lengths.hpp"
#include "meshops/shape/edge_lines.hpp"
#include "meshops/shape/surface_survey.hpp"
#include "meshops/shape/target_lengths.hpp"
#include "meshops/shape/triangle_shape.hpp"
#include "meshops/shape/valence_excess.hpp"

namespace tri {
namespace {

using EdgeKind = EdgeLines::Kind;

constexpr double longest = 4.0 / 3, shortest = 4.0 / 5;  // of the length aimed at
constexpr double least_tilt_cosine = 0.2;                // between the normals of a triangle before and after
constexpr double flip_cosine = 0.8;                      // between the normals of two triangles before and after a flip
constexpr double least_roundness = 0.2;  // of triangles made by a flip or collapse, unless worse ones go
constexpr double line_share = 0.05;      // of the length: how far a line may be cut short
constexpr double still = 1e-6;           // of the length: vertices that would move less stay
constexpr double most_triangles = 1 << 28;
constexpr std::size_t remesh_block = 2048;

class Remesher {
 public:
  Remesher(MeshView view, const RemeshOptions& options, Context& context)
      : view_(view), mesh_(view.mesh), options_(options), context_(context), stars_(view.mesh), before_(view, &context),
        values_(view, before_) {}

  Report run() {
    if (options_.adaptive && std::isinf(options_.max_error))
      throw InvalidInput("adaptive remeshing needs a max-error: how far the edges may stand off the surface");
    context_.progress("remesh", 0);
    if (triangles_.empty()) {
      context_.progress("remesh", 1);
      return std::move(report_);
    }
    prepare();
    for (int round = 0; round < options_.iterations; ++round) {
      round_ = round;
      guard_.emplace(view_, context_);
      split();
      collapse_short();
      equalise_valences();
      smooth();
    }
    for (int k = 0; k < 2; ++k) {
      guard_->build();
      equalise_valences();
      smooth();
    }
    values_.carry(
        view_, *surface_, near_, [&](VertexHandle v) { return kinds_[index(v)] != EdgeKind::free; },
        [&] { checkpoint(1); });
    describe();
    context_.progress("remesh", 1);
    return std::move(report_);
  }

 private:
  void prepare() {
    context_.checkpoint();
    surface_.emplace(points_, triangles_, &context_);
    lines_.emplace(
        view_,
        FeatureRules{
            .angle = options_.feature_angle, .noise = Noise::unknown, .min_crease_edges = options_.min_feature_edges},
        context_);
    kinds_ = lines_->kinds();
    line_ = lines_->lines();
    near_.assign(points_.size(), 0);
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (const std::uint32_t v : triangles_[t]) near_[v] = static_cast<std::uint32_t>(t);
    choose_lengths();
    crossings_before_ = crossing_pairs(points_, triangles_, context_).size();
  }

  void choose_lengths() {
    double length = options_.length;
    if (!(length > 0)) length = options_.adaptive ? diagonal_of(points_, triangles_) / 20 : mean_edge_length(view_);
    if (!(length > 0)) length = 1;  // all edges without length
    std::vector<double> sizes;
    if (options_.adaptive) {
      const double least = options_.min_length > 0 ? std::min(options_.min_length, length) : length / 20;
      sizes = curvature_lengths(view_, *lines_, options_.max_error, least, length, context_);
    }
    lengths_ = TargetLengths(length, std::move(sizes));
    const double triangles = lengths_.triangle_count(points_, triangles_);
    if (triangles > most_triangles)
      throw InvalidInput("an edge length of " + std::to_string(length) + " would make " + std::to_string(triangles) +
                         " triangles; at most 268435456 are possible");
  }

  double size_of(VertexHandle v) const { return lengths_.at(v); }
  double size_of(VertexHandle a, VertexHandle b) const { return std::min(size_of(a), size_of(b)); }
  Vec3 vector_of(HalfedgeHandle h) const {
    return view_.point(mesh_.to_vertex_handle(h)) - view_.point(mesh_.from_vertex_handle(h));
  }
  double length_of(EdgeHandle e) const { return vector_of(mesh_.halfedge_handle(e, 0)).norm(); }
  /// The length of an edge as a share of what is aimed at.
  double relative_length(EdgeHandle e) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(e, 0);
    return vector_of(h).norm() / size_of(mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h));
  }
  bool bounded() const { return !std::isinf(options_.max_error); }
  bool too_far(const Vec3& p, std::uint32_t hint) const {
    return surface_->closest(p, hint).distance > options_.max_error;
  }

  void split() {
    double most = 0;
    for (std::size_t i = 0; i < mesh_.n_edges(); ++i) {
      const EdgeHandle e(static_cast<int>(i));
      if (!mesh_.status(e).deleted() && view_.may_change(e)) most = std::max(most, relative_length(e));
    }
    // Halving the long ones first makes better shapes than halving in any order.
    double limit = longest;
    while (limit * 2 < most) limit *= 2;
    for (;; limit /= 2) {
      const bool last = limit <= longest * 1.001;
      for (std::size_t i = 0; i < mesh_.n_edges(); ++i) {
        if (i % 256 == 0) checkpoint(0);
        const EdgeHandle e(static_cast<int>(i));
        if (mesh_.status(e).deleted() || !view_.may_change(e)) continue;
        while ((relative_length(e) > limit || (last && bounded() && stands_off(e))) && !beside_longer(e)) split(e);
      }
      if (last) break;
    }
  }

  /// Whether, with a selection, a triangle of the edge has a longer side. That may be at the rim, where nothing is
  /// split, and halving what is beside it would never end.
  bool beside_longer(EdgeHandle e) const {
    if (!view_.selection) return false;
    for (HalfedgeHandle h : {mesh_.halfedge_handle(e, 0), mesh_.halfedge_handle(e, 1)})
      for (int k = 0; k < 2 && !mesh_.is_boundary(h); ++k) {
        h = mesh_.next_halfedge_handle(h);
        if (vector_of(h).norm() > length_of(e)) return true;
      }
    return false;
  }

  /// Whether the middle of an edge is too far from the input, and the edge long enough for that to be helped.
  bool stands_off(EdgeHandle e) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(e, 0);
    const VertexHandle v = mesh_.from_vertex_handle(h);
    return vector_of(h).norm() > 4 * options_.max_error &&
           too_far(view_.point(v) + 0.5 * vector_of(h), near_[index(v)]);
  }

  void split(EdgeHandle e) {
    const HalfedgeHandle h = mesh_.halfedge_handle(e, 0);
    const VertexHandle a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
    const std::int32_t line = line_[index(e)];
    const Vec3 middle = 0.5 * (view_.point(a) + view_.point(b));
    const std::size_t new_edge = mesh_.n_edges();
    const VertexHandle v = split_edge(view_, e, middle, 0.5);
    guard_->split(v);
    kinds_.resize(mesh_.n_vertices(), EdgeKind::free);
    near_.resize(mesh_.n_vertices(), near_[index(a)]);
    line_.resize(mesh_.n_edges(), EdgeLines::none);
    lengths_.add_between(a, b);
    if (line != EdgeLines::none) {
      kinds_[index(v)] = EdgeKind::along;
      line_[new_edge] = line;
      // Where a line comes close to itself the nearest place may be no place between.
      const Vec3 place = lines_->closest(middle, line);
      const double most = 0.81 * (view_.point(b) - view_.point(a)).sqrnorm();
      if ((place - view_.point(a)).sqrnorm() < most && (place - view_.point(b)).sqrnorm() < most)
        move_unless_worse(v, place);
      return;
    }
    const ClosestTriangle::Hit hit = surface_->closest(middle, near_[index(v)]);
    near_[index(v)] = hit.triangle;
    // On the surface at once, if that is near: a fold of the input may lie between.
    if (hit.distance < 0.25 * (view_.point(b) - view_.point(a)).norm() && fits(v, hit.point))
      move_unless_worse(v, hit.point);
  }

  /// Unless triangles would cross.
  void move_unless_worse(VertexHandle v, const Vec3& to) {
    if (to == view_.point(v) || guard_->move_makes_worse(v, to)) return;
    set_point(view_, v, to);
    guard_->done();
  }

  /// Whether a vertex can move without turning over a triangle.
  bool fits(VertexHandle v, const Vec3& to) const {
    const HalfedgeHandle first = mesh_.halfedge_handle(v);
    HalfedgeHandle h = first;
    do {
      if (!mesh_.is_boundary(h)) {
        const Vec3 &p = view_.point(mesh_.to_vertex_handle(h)),
                   &q = view_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
        if (!directions_agree((q - p) % (view_.point(v) - p), (q - p) % (to - p), least_tilt_cosine)) return false;
      }
      h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
    } while (h != first);
    return true;
  }

  void collapse_short() {
    std::vector<EdgeHandle> now;
    for (std::size_t i = 0; i < mesh_.n_edges(); ++i) {
      const EdgeHandle e(static_cast<int>(i));
      if (!mesh_.status(e).deleted() && relative_length(e) < shortest) now.push_back(e);
    }
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (i % 256 == 0) checkpoint(0.25);
      const EdgeHandle e = now[i];
      if (mesh_.status(e).deleted() || !(relative_length(e) < shortest)) continue;
      const HalfedgeHandle h = mesh_.halfedge_handle(e, 0), o = mesh_.opposite_halfedge_handle(h);
      // Towards the end whose edges stay closer to the length aimed at.
      const double there = collapse_cost(h), back = collapse_cost(o);
      for (const bool forth : {there <= back, there > back}) {
        const HalfedgeHandle g = forth ? h : o;
        if (std::isinf(forth ? there : back) || guard_->collapse_makes_worse(g, view_.point(mesh_.to_vertex_handle(g))))
          continue;
        do_collapse(g);
        break;
      }
    }
  }

  /// The longest edge, as a share of what is aimed at, after a collapse; infinite if it is not allowed.
  double collapse_cost(HalfedgeHandle h) {
    constexpr double no = std::numeric_limits<double>::infinity();
    const VertexHandle goes = mesh_.from_vertex_handle(h), stays = mesh_.to_vertex_handle(h);
    const EdgeKind a = kinds_[index(goes)], b = kinds_[index(stays)];
    const std::int32_t line = line_[index(mesh_.edge_handle(h))];
    if (a == EdgeKind::fixed || (a == EdgeKind::along && (line == EdgeLines::none || b == EdgeKind::free))) return no;
    stars_.look_at(h);
    const Vec3 from = view_.point(goes), to = view_.point(stays);
    double most = 0, worst = 1, worst_before = 1;
    for (const auto& [v, w] : stars_.fan(0)) {
      const Vec3 &p = view_.point(v), &q = view_.point(w);
      most = std::max({most, (p - to).norm() / size_of(v, stays), (q - to).norm() / size_of(w, stays)});
      if (most > longest) return no;
      if (!directions_agree((q - p) % (from - p), (q - p) % (to - p), least_tilt_cosine)) return no;
      worst = std::min(worst, roundness(p, q, to));
      worst_before = std::min(worst_before, roundness(p, q, from));
    }
    if (worst < least_roundness && worst < worst_before) return no;
    if (!stars_.keeps_topology([&](EdgeHandle e) { return line_[index(e)] != EdgeLines::none; })) return no;
    if (bounded())
      for (const auto& [v, w] : stars_.fan(0)) {
        const Vec3 &p = view_.point(v), &q = view_.point(w);
        if (too_far((p + q + to) / 3.0, near_[index(v)]) || too_far(0.5 * (p + to), near_[index(v)])) return no;
      }
    if (a == EdgeKind::along && line_stands_off(goes, stays, line)) return no;
    return most;
  }

  double line_limit(VertexHandle v) const { return std::min(options_.max_error, line_share * size_of(v)); }

  /// Whether a line without one of its vertices would be too far from what it was.
  bool line_stands_off(VertexHandle goes, VertexHandle stays, std::int32_t line) const {
    const HalfedgeHandle first = mesh_.halfedge_handle(goes);
    HalfedgeHandle h = first;
    do {
      if (line_[index(mesh_.edge_handle(h))] == line && mesh_.to_vertex_handle(h) != stays) {
        const Vec3 &p = view_.point(mesh_.to_vertex_handle(h)), &q = view_.point(stays), &v = view_.point(goes);
        const double limit = line_limit(goes);
        return (closest_on_segment(p, q, v) - v).norm() > limit || lines_->chord_error(p, q, line) > limit;
      }
      h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
    } while (h != first);
    return false;
  }

  void do_collapse(HalfedgeHandle h) {
    for (const HalfedgeHandle g : {h, mesh_.opposite_halfedge_handle(h)}) {
      if (mesh_.is_boundary(g)) continue;
      // Of the two other sides, that of the vertex that stays remains.
      std::int32_t& next = line_[index(mesh_.edge_handle(mesh_.next_halfedge_handle(g)))];
      std::int32_t& prev = line_[index(mesh_.edge_handle(mesh_.prev_halfedge_handle(g)))];
      next = prev = std::max(next, prev);
    }
    collapse(view_, h);
    guard_->done();
  }

  void equalise_valences() {
    const std::size_t n = mesh_.n_vertices();
    std::vector<int> excess(n, 0);  // of the valence over what suits the angle around the vertex
    for_each_block(context_, "", n, remesh_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        excess[i] = valence_excess(view_, VertexHandle(static_cast<int>(i)), kinds_[i] != EdgeKind::free);
      }
    });
    for (int sweep = 0; sweep < 4; ++sweep) {
      std::size_t flips = 0;
      for (std::size_t i = 0; i < mesh_.n_edges(); ++i) {
        if (i % 256 == 0) checkpoint(0.5);
        const EdgeHandle e(static_cast<int>(i));
        if (mesh_.status(e).deleted() || mesh_.is_boundary(e) || line_[i] != EdgeLines::none || !view_.may_change(e))
          continue;
        const HalfedgeHandle h = mesh_.halfedge_handle(e, 0), o = mesh_.halfedge_handle(e, 1);
        const VertexHandle a = mesh_.to_vertex_handle(o), b = mesh_.to_vertex_handle(h);
        const VertexHandle c = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h));
        const VertexHandle d = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o));
        // The sum of squares changes by twice this, plus 4.
        const int change = -excess[index(a)] - excess[index(b)] + excess[index(c)] + excess[index(d)] + 2;
        if (change > 0) continue;
        if (!flip_is_good(a, b, c, d, change < 0) || !mesh_.is_flip_ok(e) || guard_->flip_makes_worse(e)) continue;
        flip_edge(view_, e);
        guard_->done();
        --excess[index(a)], --excess[index(b)], ++excess[index(c)], ++excess[index(d)];
        ++flips;
      }
      report_.edges_flipped += flips;
      if (flips == 0) break;
    }
  }

  /// Whether the triangles (c, a, d) and (d, b, c) may stand for (a, b, c) and (b, a, d).
  /// @param evens  the flip makes valences more even; else only the shape speaks for it
  bool flip_is_good(VertexHandle a, VertexHandle b, VertexHandle c, VertexHandle d, bool evens) const {
    const Vec3 &p = view_.point(a), &q = view_.point(b), &r = view_.point(c), &s = view_.point(d);
    const Vec3 before[2]{(q - p) % (r - p), (p - q) % (s - q)}, after[2]{(p - r) % (s - r), (q - s) % (r - s)};
    const Vec3 mean = before[0] + before[1];
    for (const Vec3& normal : after)
      if (!(normal.sqrnorm() > 0) || !directions_agree(normal, mean, flip_cosine)) return false;
    const double old_shape = std::min(roundness(p, q, r), roundness(p, q, s));
    const double new_shape = std::min(roundness(r, p, s), roundness(s, q, r));
    if (evens ? new_shape < std::min(old_shape, 0.5) : !(new_shape > 1.05 * old_shape)) return false;
    if (bounded()) {
      const std::uint32_t hint = near_[index(c)];
      if (too_far(0.5 * (r + s), hint) || too_far((r + p + s) / 3.0, hint) || too_far((s + q + r) / 3.0, hint))
        return false;
    }
    return true;
  }

  void smooth() {
    const std::size_t n = mesh_.n_vertices();
    to_.resize(n);
    hits_.resize(n);
    moves_.assign(n, 0);
    for_each_block(context_, "", n, remesh_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) find_place(VertexHandle(static_cast<int>(i)));
    });
    do take_back_folds();
    while (take_back_crossings());
    for (std::size_t i = 0; i < n; ++i) {
      if (i % 65536 == 0) checkpoint(0.9);
      if (!moves_[i]) continue;
      const VertexHandle v(static_cast<int>(i));
      set_point(view_, v, to_[i]);
      if (kinds_[i] == EdgeKind::along) continue;
      near_[i] = hits_[i];
      if (options_.adaptive)
        lengths_.move(v, triangles_[hits_[i]], triangle_weights(surface_->corners(hits_[i]), to_[i]));
    }
  }

  /// Where a vertex would be better, on the input.
  void find_place(VertexHandle v) {
    const std::size_t i = index(v);
    const HalfedgeHandle first = mesh_.halfedge_handle(v);
    if (mesh_.status(v).deleted() || !first.is_valid() || kinds_[i] == EdgeKind::fixed) return;
    const Vec3& p = view_.point(v);
    if (kinds_[i] == EdgeKind::along) {
      Vec3 sum(0, 0, 0);
      double total = 0;
      std::int32_t line = EdgeLines::none;
      HalfedgeHandle h = first;
      do {
        if (const std::int32_t l = line_[index(mesh_.edge_handle(h))]; l != EdgeLines::none) {
          // An edge that is long for its place pulls harder.
          const double weight = 1 / size_of(mesh_.to_vertex_handle(h), v);
          sum += weight * vector_of(h), total += weight;
          line = l;
        }
        h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
      } while (h != first);
      if (!(total > 0)) return;
      to_[i] = lines_->closest(p + sum / total, line);
      const double limit = line_limit(v);
      do {
        if (line_[index(mesh_.edge_handle(h))] == line) {
          const Vec3& q = view_.point(mesh_.to_vertex_handle(h));
          const double error = lines_->chord_error(to_[i], q, line);
          if (error > limit && error > lines_->chord_error(p, q, line)) return;
        }
        h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
      } while (h != first);
    } else {
      Vec3 sum(0, 0, 0), normal(0, 0, 0);
      double total = 0;
      HalfedgeHandle h = first;
      do {
        const Vec3 a = vector_of(h), b = -vector_of(mesh_.prev_halfedge_handle(h));
        const Vec3 twice_area = a % b;
        double weight = twice_area.norm();
        if (options_.adaptive) {
          const double size =
              size_of(mesh_.to_vertex_handle(h)) + size_of(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
          weight /= size * size;
        }
        sum += weight * (a + b), total += 3 * weight;
        normal += twice_area;
        h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
      } while (h != first);
      const double length2 = normal.sqrnorm();
      if (!(total > 0) || !(length2 > 0)) return;
      Vec3 step = sum / total;
      step -= normal * ((step | normal) / length2);
      const ClosestTriangle::Hit hit = surface_->closest(p + step, near_[i]);
      const auto& t = surface_->corners(hit.triangle);
      if ((((t[1] - t[0]) % (t[2] - t[0])) | normal) < 0) return;  // the other side of a thin wall
      to_[i] = hit.point;
      hits_[i] = hit.triangle;
    }
    moves_[i] = (to_[i] - p).norm() > still * size_of(v);
  }

  Vec3 place_of(VertexHandle v) const { return moves_[index(v)] ? to_[index(v)] : view_.point(v); }

  /// Vertices of triangles that would be turned over, or come too far off, stay where they are.
  void take_back_folds() {
    const std::size_t n = mesh_.n_faces();
    std::vector<char> bad(n);
    for (;;) {
      for_each_block(context_, "", n, remesh_block, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) bad[i] = spoiled(FaceHandle(static_cast<int>(i)));
      });
      bool any = false;
      for (std::size_t i = 0; i < n; ++i) {
        if (!bad[i]) continue;
        any = true;
        for (const VertexHandle v : corners(FaceHandle(static_cast<int>(i)))) moves_[index(v)] = 0;
      }
      if (!any) return;
    }
  }

  /// Vertices of triangles that would cross others stay where they are. @return whether there are any
  bool take_back_crossings() {
    const MeshBefore now(view_);
    std::vector<Vec3> places = now.points();
    for (std::size_t i = 0; i < places.size(); ++i)
      if (moves_[i]) places[i] = to_[i];
    bool any = false;
    crossings_ = 0;
    for (const auto& pair : crossing_pairs(places, now.triangles(), context_)) {
      bool moves = false;
      for (const std::uint32_t t : pair)
        for (const std::uint32_t v : now.triangles()[t]) moves = moves || moves_[v], moves_[v] = 0;
      any = any || moves;
      if (++crossings_ > 1) continue;
      const Triangle& t = now.triangles()[pair[0]];
      crossing_at_ = (places[t[0]] + places[t[1]] + places[t[2]]) / 3.0;
    }
    return any;
  }

  bool spoiled(FaceHandle f) const {
    if (mesh_.status(f).deleted()) return false;
    const auto [a, b, c] = corners(f);
    if (!moves_[index(a)] && !moves_[index(b)] && !moves_[index(c)]) return false;
    const Vec3 &p = view_.point(a), &q = view_.point(b), &r = view_.point(c);
    const Vec3 x = place_of(a), y = place_of(b), z = place_of(c);
    const Vec3 before = (q - p) % (r - p), after = (y - x) % (z - x);
    if (!directions_agree(before, after, least_tilt_cosine)) return true;
    if (const double shape = roundness(x, y, z); shape < least_roundness && shape < roundness(p, q, r)) return true;
    if (!bounded()) return false;
    const std::uint32_t hint = near_[index(a)];
    for (const auto& [now, then] :
         {std::pair{(x + y + z) / 3.0, (p + q + r) / 3.0}, std::pair{0.5 * (x + y), 0.5 * (p + q)},
          std::pair{0.5 * (y + z), 0.5 * (q + r)}, std::pair{0.5 * (z + x), 0.5 * (r + p)}}) {
      const double distance = surface_->closest(now, hint).distance;
      if (distance > options_.max_error && distance > surface_->closest(then, hint).distance) return true;
    }
    return false;
  }

  void describe() {
    const SurfaceSurvey all = survey_surface(view_, *surface_, near_, context_);
    double in_range = 0, edges = 0, aim = 0;
    for (std::size_t i = 0; i < mesh_.n_edges(); ++i) {
      const EdgeHandle e(static_cast<int>(i));
      if (mesh_.status(e).deleted() || !view_.may_change(e)) continue;
      const double relative = relative_length(e);
      edges += 1;
      in_range += relative >= shortest && relative <= longest;
      aim += relative > 0 ? length_of(e) / relative : 0;
    }
    report_.figures["faces"] = static_cast<double>(all.faces);
    report_.figures["greatest distance"] = all.greatest_distance;
    report_.figures["smallest angle"] = all.smallest_angle * 180 / std::numbers::pi;
    report_.figures["edges in range"] = edges > 0 ? in_range / edges : 1;
    if (crossings_ > 0) report_.figures["crossing pairs"] = static_cast<double>(crossings_);
    if (crossings_ > crossings_before_)
      report_.notes.push_back(fmt::format("{} pairs of triangles cross, {} did before; one at ({:.6g}, {:.6g}, {:.6g})",
                                          crossings_, crossings_before_, crossing_at_[0], crossing_at_[1],
                                          crossing_at_[2]));
    report_.figures["length"] = options_.adaptive && edges > 0 ? aim / edges : lengths_.longest();
    before_.compare(view_, report_, &context_);
    if (bounded() && !report_.unchanged()) report_distance(before_, view_, report_, context_);
  }

  template <class Handle>
  static std::size_t index(Handle h) {
    return static_cast<std::size_t>(h.idx());
  }
  std::array<VertexHandle, 3> corners(FaceHandle f) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(f), next = mesh_.next_halfedge_handle(h);
    return {mesh_.to_vertex_handle(h), mesh_.to_vertex_handle(next),
            mesh_.to_vertex_handle(mesh_.next_halfedge_handle(next))};
  }
  /// @param part  of a round
  void checkpoint(double part) {
    context_.checkpoint();
    share_ = std::max(share_, (round_ + part) / (options_.iterations + 1));
    context_.progress("remesh", share_);
  }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  const RemeshOptions& options_;
  Context& context_;
  Report report_;
  CollapseStars stars_;
  int round_ = 0;
  double share_ = 0;
  std::size_t crossings_before_ = 0, crossings_ = 0;  ///< pairs of triangles
  Vec3 crossing_at_{0, 0, 0};                         ///< the middle of one of them
  std::optional<CrossingGuard> guard_;

  const MeshBefore before_;
  PlaceValues values_;
  const std::vector<Vec3>& points_ = before_.points();            ///< of the input
  const std::vector<Triangle>& triangles_ = before_.triangles();  ///< of the input
  std::optional<ClosestTriangle> surface_;
  std::optional<EdgeLines> lines_;

  TargetLengths lengths_;
  std::vector<EdgeKind> kinds_;      ///< per vertex
  std::vector<std::uint32_t> near_;  ///< per vertex: a triangle of the input close by
  std::vector<std::int32_t> line_;   ///< per edge
  std::vector<Vec3> to_;             ///< per vertex: where it would move
  std::vector<std::uint32_t> hits_;  ///< per vertex: the triangle there
  std::vector<char> moves_;          ///< per vertex
};

}  // namespace

const OptionSchema& RemeshOptions::schema() {
  using O = RemeshOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("length", &O::length,
                  {.unit = "mm", .min = 0, .help = "edge length aimed at; 0: the mean of the edges"})
          .integer(
              "iterations", &O::iterations,
              {.unit = "rounds", .min = 1, .max = 1000, .help = "rounds of splitting, collapsing, flipping, smoothing"})
          .boolean("adaptive", &O::adaptive, {.help = "shorter edges where the surface is curved, by max-error"})
          .number("min-length", &O::min_length,
                  {.unit = "mm", .min = 0, .help = "with adaptive: aim at no shorter edges; 0: a twentieth of length"})
          .number("max-error", &O::max_error,
                  {.unit = "mm",
                   .min = 0,
                   .min_open = true,
                   .infinite = true,
                   .help = "distance from the input that middles of edges and triangles may have; that of all "
                           "places, which may be more, is measured and reported"})
          .angle("feature-angle", &O::feature_angle,
                 {.min = 0, .max = 180, .help = "angle between two normals above which an edge is a crease"})
          .integer("min-feature-edges", &O::min_feature_edges,
                   {.unit = "edges", .min = 1, .help = "creases that hang together in fewer edges are noise"});
  return schema;
}

Report remesh(MeshView mesh, const RemeshOptions& options, Context& context) {
  validate(options);
  return Remesher(mesh, options, context).run();
}

}  // namespace tri

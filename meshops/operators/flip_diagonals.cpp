#include "meshops/operators/flip_diagonals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "meshops/mesh_edit.hpp"

namespace tri {
namespace {

/// What the global order knows of one triangle; the same bits for the same corners, however they are listed.
struct Shape {
  Vec3 normal{0, 0, 0};  ///< not normalised; zero if the triangle has no area
  double smallest_angle = 0;
};

class Flipper {
 public:
  Flipper(MeshView view, const FlipDiagonalsOptions& options, Context& context)
      : view_(view), mesh_(view.mesh), sharp_angle_(options.sharp_angle), context_(context) {}

  Report run() {
    prepare();
    describe("before");
    work();
    count_refused();
    describe("after");
    collect_touched();
    return std::move(report_);
  }

 private:
  using Corners = std::array<VertexHandle, 3>;

  using Ends = std::pair<int, int>;

  /// Two triangles on an inner edge, and the two they would become. `side[k]` has the triangle that keeps it inside.
  struct Quad {
    EdgeHandle edge;
    std::array<HalfedgeHandle, 4> side;
    std::array<FaceHandle, 2> face;
    std::array<Shape, 2> flipped;  ///< the new triangle of side 0 and 3, and that of side 1 and 2
  };

  void prepare() {
    shapes_.resize(mesh_.n_faces());
    excess_.resize(mesh_.n_edges());
    queued_.resize(mesh_.n_edges());
    touched_.resize(mesh_.n_faces());
    for (int i = 0; i < count(mesh_.n_faces()); ++i) {
      if (i % 1024 == 0) context_.checkpoint();
      const FaceHandle f(i);
      if (!mesh_.status(f).deleted()) shapes_[i] = shape(corners(f));
    }
    for (int i = 0; i < count(mesh_.n_edges()); ++i) {
      if (i % 1024 == 0) context_.checkpoint();
      const EdgeHandle e(i);
      if (!is_inner(e)) continue;
      excess_[i] = excess_of(shapes_[face(e, 0).idx()], shapes_[face(e, 1).idx()]);
      enter(e);
    }
  }

  void work() {
    std::size_t looked_at = 0;
    double share = 0;
    while (!queue_.empty()) {
      if (looked_at++ % 1024 == 0) {
        context_.checkpoint();
        share = std::max(share, static_cast<double>(looked_at) / static_cast<double>(looked_at + queue_.size()));
        context_.progress("flip-diagonals", share);
      }
      const EdgeHandle e = queue_.front();
      queue_.pop_front();
      queued_[e.idx()] = 0;
      const Quad quad = quad_of(e);
      if (!rule_prefers_flip(quad) || !lowers_order(quad)) continue;
      if (mesh_.is_flip_ok(e)) {
        flip(quad);
      } else {
        blocked_[other_ends(quad)].push_back(e);
      }
    }
    context_.progress("flip-diagonals", 1);
  }

  void count_refused() {
    std::uint64_t not_lower = 0, there_already = 0;
    for (int i = 0; i < count(mesh_.n_edges()); ++i) {
      const EdgeHandle e(i);
      if (!is_inner(e) || !view_.may_change(e)) continue;
      const Quad quad = quad_of(e);
      if (!rule_prefers_flip(quad)) continue;
      if (!mesh_.is_flip_ok(e)) {
        ++there_already;
      } else {
        ++not_lower;
      }
    }
    if (not_lower) report_.skipped["would not lower the global order"] = not_lower;
    if (there_already) report_.skipped["is an edge already"] = there_already;
  }

  bool rule_prefers_flip(const Quad& quad) const {
    if (excess_[quad.edge.idx()] > 0) return excess_change(quad) < 0;
    const double before =
        std::min(shapes_[quad.face[0].idx()].smallest_angle, shapes_[quad.face[1].idx()].smallest_angle);
    return std::min(quad.flipped[0].smallest_angle, quad.flipped[1].smallest_angle) > before;
  }

  bool lowers_order(const Quad& quad) const {
    const std::int64_t change = excess_change(quad);
    if (change != 0) return change < 0;
    const double before =
        std::min(shapes_[quad.face[0].idx()].smallest_angle, shapes_[quad.face[1].idx()].smallest_angle);
    return std::min(quad.flipped[0].smallest_angle, quad.flipped[1].smallest_angle) > before;
  }

  /// Change of the first part of the global order: only the diagonal and the four sides count.
  std::int64_t excess_change(const Quad& quad) const {
    std::int64_t change = excess_of(quad.flipped[0], quad.flipped[1]) - excess_[quad.edge.idx()];
    for (int k = 0; k < 4; ++k) {
      if (const auto after = side_excess(quad, k)) change += *after - excess_[mesh_.edge_handle(quad.side[k]).idx()];
    }
    return change;
  }

  /// Excess of a side once the diagonal is flipped; none at the boundary.
  std::optional<std::int64_t> side_excess(const Quad& quad, int k) const {
    const FaceHandle beyond = mesh_.face_handle(mesh_.opposite_halfedge_handle(quad.side[k]));
    if (!beyond.is_valid()) return std::nullopt;
    // A neighbour on two sides is itself replaced; only a closed pair of triangles has that, and it cannot be flipped.
    return excess_of(quad.flipped[k == 0 || k == 3 ? 0 : 1], shapes_[beyond.idx()]);
  }

  void flip(const Quad& quad) {
    const std::int64_t diagonal = excess_of(quad.flipped[0], quad.flipped[1]);
    std::array<std::optional<std::int64_t>, 4> sides;
    for (int k = 0; k < 4; ++k) sides[k] = side_excess(quad, k);
    const Ends ends = ends_of(quad);
    flip_edge(view_, quad.edge);
    if (const auto it = blocked_.find(ends); it != blocked_.end()) {
      for (const EdgeHandle e : it->second) enter(e);
      blocked_.erase(it);
    }
    ++report_.edges_flipped;
    for (const FaceHandle f : quad.face) {
      shapes_[f.idx()] = shape(corners(f));
      touched_[f.idx()] = 1;
    }
    excess_[quad.edge.idx()] = diagonal;
    for (int k = 0; k < 4; ++k) {
      const EdgeHandle e = mesh_.edge_handle(quad.side[k]);
      if (!sides[k]) continue;
      excess_[e.idx()] = *sides[k];
      enter(e);
      // The quadrilaterals beyond have a changed triangle beside them.
      const HalfedgeHandle beyond = mesh_.opposite_halfedge_handle(quad.side[k]);
      enter(mesh_.edge_handle(mesh_.next_halfedge_handle(beyond)));
      enter(mesh_.edge_handle(mesh_.prev_halfedge_handle(beyond)));
    }
  }

  Quad quad_of(EdgeHandle e) const {
    // a -> b is the edge, c beyond it on the left, d on the right; the sides run b c, c a, a d, d b.
    const HalfedgeHandle left = mesh_.halfedge_handle(e, 0), right = mesh_.halfedge_handle(e, 1);
    Quad quad{e,
              {mesh_.next_halfedge_handle(left), mesh_.prev_halfedge_handle(left), mesh_.next_halfedge_handle(right),
               mesh_.prev_halfedge_handle(right)},
              {mesh_.face_handle(left), mesh_.face_handle(right)},
              {}};
    const VertexHandle a = mesh_.to_vertex_handle(right), b = mesh_.to_vertex_handle(left);
    const VertexHandle c = mesh_.to_vertex_handle(quad.side[0]), d = mesh_.to_vertex_handle(quad.side[2]);
    quad.flipped = {shape({b, c, d}), shape({a, d, c})};
    return quad;
  }

  Ends ends_of(const Quad& quad) const {
    return std::minmax({mesh_.to_vertex_handle(quad.side[1]).idx(), mesh_.to_vertex_handle(quad.side[3]).idx()});
  }
  Ends other_ends(const Quad& quad) const {
    return std::minmax({mesh_.to_vertex_handle(quad.side[0]).idx(), mesh_.to_vertex_handle(quad.side[2]).idx()});
  }

  Shape shape(Corners v) const {
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    const std::array<Vec3, 3> p{view_.point(v[0]), view_.point(v[1]), view_.point(v[2])};
    const Vec3 normal = (p[1] - p[0]) % (p[2] - p[0]);
    const double twice_area = normal.norm();
    if (!(twice_area > 0) || !std::isfinite(twice_area)) return {};
    int shortest = 0;  // side k lies opposite corner k
    double length = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double l = (p[(k + 2) % 3] - p[(k + 1) % 3]).sqrnorm();
      if (l < length) {
        length = l;
        shortest = k;
      }
    }
    const double along = (p[(shortest + 1) % 3] - p[shortest]) | (p[(shortest + 2) % 3] - p[shortest]);
    return {normal, std::atan2(twice_area, along)};
  }

  /// Microradians by which the angle between two normals exceeds the sharp angle.
  std::int64_t excess_of(const Shape& a, const Shape& b) const {
    double angle = std::numbers::pi;
    if (a.smallest_angle > 0 && b.smallest_angle > 0) {
      // The product of normals in a fixed order: with fused multiply-adds, swapping them may change the last bit.
      const bool swap =
          std::lexicographical_compare(b.normal.data(), b.normal.data() + 3, a.normal.data(), a.normal.data() + 3);
      const Vec3 m = (swap ? b : a).normal, n = (swap ? a : b).normal;
      angle = std::atan2((m % n).norm(), m | n);
    }
    return std::max<std::int64_t>(0, std::llround((angle - sharp_angle_) * 1e6));
  }

  void describe(const char* when) {
    double smallest = std::numbers::pi;
    std::size_t sharp = 0, faces = 0;
    for (int i = 0; i < count(mesh_.n_faces()); ++i) {
      if (mesh_.status(FaceHandle(i)).deleted()) continue;
      smallest = std::min(smallest, shapes_[i].smallest_angle);
      ++faces;
    }
    for (const std::int64_t e : excess_) sharp += e > 0;
    report_.figures[std::string("sharp edges ") + when] = static_cast<double>(sharp);
    if (faces) report_.figures[std::string("smallest angle ") + when] = smallest * 180 / std::numbers::pi;
  }

  void collect_touched() {
    for (std::size_t i = 0; i < touched_.size(); ++i)
      if (touched_[i]) report_.touched_faces.push_back(static_cast<std::uint32_t>(i));
  }

  void enter(EdgeHandle e) {
    if (queued_[e.idx()] || !is_inner(e) || !view_.may_change(e)) return;
    queued_[e.idx()] = 1;
    queue_.push_back(e);
  }

  bool is_inner(EdgeHandle e) const { return !mesh_.status(e).deleted() && !mesh_.is_boundary(e); }
  FaceHandle face(EdgeHandle e, int k) const { return mesh_.face_handle(mesh_.halfedge_handle(e, k)); }
  Corners corners(FaceHandle f) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(f), next = mesh_.next_halfedge_handle(h);
    return {mesh_.to_vertex_handle(h), mesh_.to_vertex_handle(next),
            mesh_.to_vertex_handle(mesh_.next_halfedge_handle(next))};
  }
  static int count(std::size_t n) { return static_cast<int>(n); }

  MeshView view_;
  const OpenMesh::TriConnectivity& mesh_;
  const double sharp_angle_;
  Context& context_;
  Report report_;
  std::vector<Shape> shapes_;         ///< per face
  std::vector<std::int64_t> excess_;  ///< per edge; 0 at the boundary
  std::vector<char> queued_;          ///< per edge
  std::vector<char> touched_;         ///< per face
  std::deque<EdgeHandle> queue_;
  std::map<Ends, std::vector<EdgeHandle>> blocked_;  ///< edges that wait for the edge between these ends to go
};

}  // namespace

const OptionSchema& FlipDiagonalsOptions::schema() {
  using O = FlipDiagonalsOptions;
  static const OptionSchema schema = Schema<O>().angle(
      "sharp-angle", &O::sharp_angle,
      {.min = 0, .max = 179, .help = "angle between two normals above which smoothness decides, not shape"});
  return schema;
}

Report flip_diagonals(MeshView mesh, const FlipDiagonalsOptions& options, Context& context) {
  validate(options);
  return Flipper(mesh, options, context).run();
}

}  // namespace tri

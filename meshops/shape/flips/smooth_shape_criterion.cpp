#include "meshops/shape/flips/smooth_shape_criterion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace tri {
namespace {

/// What the global order knows of one triangle; the same bits for the same corners, however they are listed.
struct SmoothShape {
  Vec3 normal{0, 0, 0};  ///< not normalised; zero if the triangle has no area
  double smallest_angle = 0;
};

class SmoothShapeCriterion final : public FlipCriterion {
 public:
  SmoothShapeCriterion(MeshView view, double sharp_angle, const Context& context)
      : view_(view), mesh_(view.mesh), sharp_angle_(sharp_angle) {
    shapes_.resize(mesh_.n_faces());
    excess_.resize(mesh_.n_edges());
    for (int i = 0; i < count(mesh_.n_faces()); ++i) {
      if (i % 1024 == 0) context.checkpoint();
      const FaceHandle f(i);
      if (!mesh_.status(f).deleted()) shapes_[i] = shape(face_corners(mesh_, f));
    }
    for (int i = 0; i < count(mesh_.n_edges()); ++i) {
      if (i % 1024 == 0) context.checkpoint();
      const EdgeHandle e(i);
      if (is_inner_edge(mesh_, e)) excess_[i] = excess_of(shapes_[face(e, 0).idx()], shapes_[face(e, 1).idx()]);
    }
  }

  Verdict judge(const FlipQuad& quad) override {
    const auto [a, b, c, d] = quad.corner;
    new_ = {shape({b, c, d}), shape({a, d, c})};
    if (excess_[quad.edge.idx()] > 0) return excess_change(quad) < 0 ? Verdict::flip : Verdict::keep;
    const double before =
        std::min(shapes_[quad.face[0].idx()].smallest_angle, shapes_[quad.face[1].idx()].smallest_angle);
    if (!(std::min(new_[0].smallest_angle, new_[1].smallest_angle) > before)) return Verdict::keep;
    return excess_change(quad) <= 0 ? Verdict::flip : Verdict::refuse;
  }

  void flipped(const FlipQuad& quad) override {
    for (int k = 0; k < 4; ++k)
      if (const auto after = side_excess(quad, k)) excess_[mesh_.edge_handle(quad.side[k]).idx()] = *after;
    excess_[quad.edge.idx()] = excess_of(new_[0], new_[1]);
    for (const FaceHandle f : quad.face) shapes_[f.idx()] = shape(face_corners(mesh_, f));
  }

  void describe(const char* when, Report& report, const Context&) const override {
    double smallest = std::numbers::pi;
    std::size_t sharp = 0, faces = 0;
    for (int i = 0; i < count(mesh_.n_faces()); ++i) {
      if (mesh_.status(FaceHandle(i)).deleted()) continue;
      smallest = std::min(smallest, shapes_[i].smallest_angle);
      ++faces;
    }
    for (const std::int64_t e : excess_) sharp += e > 0;
    report.figures[std::string("sharp edges ") + when] = static_cast<double>(sharp);
    if (faces) report.figures[std::string("smallest angle ") + when] = smallest * 180 / std::numbers::pi;
  }

 private:
  using Corners = std::array<VertexHandle, 3>;

  /// Change of the first part of the global order: only the diagonal and the four sides count.
  std::int64_t excess_change(const FlipQuad& quad) const {
    std::int64_t change = excess_of(new_[0], new_[1]) - excess_[quad.edge.idx()];
    for (int k = 0; k < 4; ++k) {
      if (const auto after = side_excess(quad, k)) change += *after - excess_[mesh_.edge_handle(quad.side[k]).idx()];
    }
    return change;
  }

  /// Excess of a side once the diagonal is flipped; none at the boundary.
  std::optional<std::int64_t> side_excess(const FlipQuad& quad, int k) const {
    const FaceHandle beyond = mesh_.face_handle(mesh_.opposite_halfedge_handle(quad.side[k]));
    if (!beyond.is_valid()) return std::nullopt;
    // A neighbour on two sides is itself replaced; only a closed pair of triangles has that, and it cannot be flipped.
    return excess_of(new_[FlipQuad::flipped_face[k]], shapes_[beyond.idx()]);
  }

  SmoothShape shape(Corners v) const {
    v = lowest_first(v);
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
  std::int64_t excess_of(const SmoothShape& a, const SmoothShape& b) const {
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

  FaceHandle face(EdgeHandle e, int k) const { return mesh_.face_handle(mesh_.halfedge_handle(e, k)); }
  static int count(std::size_t n) { return static_cast<int>(n); }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  const double sharp_angle_;
  std::vector<SmoothShape> shapes_;   ///< per face
  std::vector<std::int64_t> excess_;  ///< per edge; 0 at the boundary
  std::array<SmoothShape, 2> new_;    ///< of the quadrilateral judged last: (b, c, d) and (a, d, c)
};

}  // namespace

std::unique_ptr<FlipCriterion> smooth_shape_criterion(MeshView mesh, double sharp_angle, const Context& context) {
  return std::make_unique<SmoothShapeCriterion>(mesh, sharp_angle, context);
}

}  // namespace tri

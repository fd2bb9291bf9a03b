#include "meshops/shape/flips/curvature_criterion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t curvature_block = 4096;
constexpr std::int64_t most_units = std::int64_t{1} << 50;  ///< of one edge; only points that are not finite reach it

class CurvatureCriterion final : public FlipCriterion {
 public:
  CurvatureCriterion(MeshView view, const Context& context)
      : view_(view), mesh_(view.mesh), unit_(std::ldexp(diagonal(), -40)), normals_(mesh_.n_faces()),
        costs_(mesh_.n_edges(), 0) {
    for_each_block(context, "", normals_.size(), curvature_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FaceHandle f(static_cast<int>(i));
        if (!mesh_.status(f).deleted()) normals_[i] = normal(face_corners(mesh_, f));
      }
    });
    for_each_block(context, "", costs_.size(), curvature_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const EdgeHandle e(static_cast<int>(i));
        if (!is_inner_edge(mesh_, e)) continue;
        const HalfedgeHandle h = mesh_.halfedge_handle(e, 0), o = mesh_.halfedge_handle(e, 1);
        costs_[i] = cost(mesh_.to_vertex_handle(o), mesh_.to_vertex_handle(h), normals_[index(mesh_.face_handle(h))],
                         normals_[index(mesh_.face_handle(o))]);
      }
    });
  }

  Verdict judge(const FlipQuad& quad) override {
    const auto [a, b, c, d] = quad.corner;
    new_normals_ = {normal({b, c, d}), normal({a, d, c})};
    new_costs_[4] = cost(c, d, new_normals_[0], new_normals_[1]);
    change_ = new_costs_[4] - costs_[index(quad.edge)];
    for (int k = 0; k < 4; ++k) {
      const std::size_t side = index(mesh_.edge_handle(quad.side[k]));
      const FaceHandle beyond = mesh_.face_handle(mesh_.opposite_halfedge_handle(quad.side[k]));
      new_costs_[k] = costs_[side];
      if (!beyond.is_valid()) continue;
      // Sides run b c, c a, a d, d b.
      static constexpr std::array<std::array<int, 2>, 4> ends{{{1, 2}, {2, 0}, {0, 3}, {3, 1}}};
      new_costs_[k] = cost(quad.corner[ends[k][0]], quad.corner[ends[k][1]], new_normals_[FlipQuad::flipped_face[k]],
                           normals_[index(beyond)]);
      change_ += new_costs_[k] - costs_[side];
    }
    return change_ < 0 ? Verdict::flip : Verdict::keep;
  }

  std::int64_t gain() const override { return -change_; }
  bool largest_gain_first() const override { return true; }

  void flipped(const FlipQuad& quad) override {
    for (int k = 0; k < 4; ++k) costs_[index(mesh_.edge_handle(quad.side[k]))] = new_costs_[k];
    costs_[index(quad.edge)] = new_costs_[4];
    for (const FaceHandle f : quad.face) normals_[index(f)] = normal(face_corners(mesh_, f));
  }

  void describe(const char* when, Report& report, const Context&) const override {
    double sum = 0;
    for (const std::int64_t c : costs_) sum += static_cast<double>(c);
    report.figures[std::string("total absolute mean curvature ") + when] = sum * unit_ / 2;
  }

 private:
  template <class Handle>
  static std::size_t index(Handle h) {
    return static_cast<std::size_t>(h.idx());
  }

  double diagonal() const {
    const double inf = std::numeric_limits<double>::infinity();
    Vec3 low(inf, inf, inf), high(-inf, -inf, -inf);
    for (std::size_t i = 0; i < mesh_.n_vertices(); ++i) {
      const Vec3& p = view_.point(VertexHandle(static_cast<int>(i)));
      if (!std::isfinite(p[0] + p[1] + p[2])) continue;
      low.minimize(p);
      high.maximize(p);
    }
    const double length = low[0] <= high[0] ? (high - low).norm() : 0;
    return length > 0 && std::isfinite(length) ? length : 1;
  }

  /// Not normalised; zero without area. The same bits for the same corners, however they are listed.
  Vec3 normal(std::array<VertexHandle, 3> corners) const {
    corners = lowest_first(corners);
    const Vec3& p = view_.point(corners[0]);
    return (view_.point(corners[1]) - p) % (view_.point(corners[2]) - p);
  }

  /// Length times angle in whole units; the same for the same edge and triangles, in whatever order.
  std::int64_t cost(VertexHandle a, VertexHandle b, Vec3 m, Vec3 n) const {
    if (b < a) std::swap(a, b);
    if (std::lexicographical_compare(n.data(), n.data() + 3, m.data(), m.data() + 3)) std::swap(m, n);
    const double length = (view_.point(b) - view_.point(a)).norm();
    const bool flat = !(m.sqrnorm() > 0) || !(n.sqrnorm() > 0);
    const double angle = flat ? std::numbers::pi : std::atan2((m % n).norm(), m | n);
    const double units = length * angle / unit_;
    return units < static_cast<double>(most_units) ? std::llround(units) : most_units;
  }

  MeshView view_;
  const OpenMesh::TriConnectivity& mesh_;
  const double unit_;                        ///< model units
  std::vector<Vec3> normals_;                ///< per face
  std::vector<std::int64_t> costs_;          ///< per edge; 0 at the boundary
  std::array<Vec3, 2> new_normals_;          ///< of the quadrilateral judged last: (b, c, d) and (a, d, c)
  std::array<std::int64_t, 5> new_costs_{};  ///< of its sides and its other diagonal
  std::int64_t change_ = 0;                  ///< of the sum, by its flip
};

}  // namespace

std::unique_ptr<FlipCriterion> curvature_criterion(MeshView mesh, const Context& context) {
  return std::make_unique<CurvatureCriterion>(mesh, context);
}

}  // namespace tri

#include "meshops/shape/flips/delaunay_criterion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t delaunay_block = 4096;
constexpr double infinite = std::numeric_limits<double>::infinity();

class DelaunayCriterion final : public FlipCriterion {
 public:
  DelaunayCriterion(MeshView view, double sharp_angle, const Context& context)
      : view_(view), mesh_(view.mesh), sharp_cosine_(std::cos(sharp_angle)), shapes_(mesh_.n_faces()) {
    for_each_block(context, "", shapes_.size(), delaunay_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FaceHandle f(static_cast<int>(i));
        if (!mesh_.status(f).deleted()) shapes_[i] = shape(face_corners(mesh_, f));
      }
    });
  }

  Verdict judge(const FlipQuad& quad) override {
    const auto [a, b, c, d] = quad.corner;
    const std::array<const Shape*, 2> old{&shapes_[index(quad.face[0])], &shapes_[index(quad.face[1])]};
    if (is_delaunay(view_.point(a), view_.point(b), view_.point(c), view_.point(d))) return Verdict::keep;
    if (old[0]->has_area() && old[1]->has_area() && cosine(*old[0], *old[1]) < sharp_cosine_) return Verdict::keep;
    new_ = {shape({b, c, d}), shape({a, d, c})};
    if (!new_[0].has_area() || !new_[1].has_area()) return Verdict::refuse;
    const bool fewer_flat = !old[0]->has_area() || !old[1]->has_area();
    if (!fewer_flat && !(new_[0].index + new_[1].index < old[0]->index + old[1]->index)) return Verdict::refuse;
    return stays_smooth(quad) ? Verdict::flip : Verdict::refuse;
  }

  const char* reason() const override { return "would fold, or make an edge sharp"; }

  void flipped(const FlipQuad& quad) override {
    for (const FaceHandle f : quad.face) shapes_[index(f)] = shape(face_corners(mesh_, f));
  }

  void describe(const char* when, Report& report, const Context& context) const override {
    std::vector<std::size_t> counts((mesh_.n_edges() + delaunay_block - 1) / delaunay_block, 0);
    for_each_block(context, "", mesh_.n_edges(), delaunay_block,
                   [&](std::size_t block, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i) {
                       const EdgeHandle e(static_cast<int>(i));
                       if (!is_inner_edge(mesh_, e)) continue;
                       const auto [a, b, c, d] = flip_quad(mesh_, e).corner;
                       counts[block] += !is_delaunay(view_.point(a), view_.point(b), view_.point(c), view_.point(d));
                     }
                   });
    const std::size_t count = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
    report.figures[std::string("edges not Delaunay ") + when] = static_cast<double>(count);
  }

 private:
  /// The same bits for the same corners, however they are listed.
  struct Shape {
    Vec3 normal{0, 0, 0};     ///< of unit length; zero without area
    double index = infinite;  ///< sum of the squared sides over twice the area; infinite without area

    bool has_area() const { return index < infinite; }
  };

  static std::size_t index(FaceHandle f) { return static_cast<std::size_t>(f.idx()); }

  static double cosine(const Shape& m, const Shape& n) { return m.normal | n.normal; }

  Shape shape(std::array<VertexHandle, 3> corners) const {
    corners = lowest_first(corners);
    const Vec3 &p = view_.point(corners[0]), &q = view_.point(corners[1]), &r = view_.point(corners[2]);
    const Vec3 normal = (q - p) % (r - p);
    const double twice_area = normal.norm();
    const double value = ((q - p).sqrnorm() + (r - q).sqrnorm() + (p - r).sqrnorm()) / twice_area;
    if (!(twice_area > 0) || !std::isfinite(value)) return {};
    return {normal / twice_area, value};
  }

  /// Whether the angles at c and d opposite to a b add up to pi at most: their cotangents do not add up to less than
  /// zero.
  static bool is_delaunay(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 ca = a - c, cb = b - c, da = a - d, db = b - d;
    const double dot_c = ca | cb, dot_d = da | db;
    if (dot_c >= 0 && dot_d >= 0) return true;
    const double cross_c = (ca % cb).norm(), cross_d = (da % db).norm();
    const double length_c = ca.norm() * cb.norm(), length_d = da.norm() * db.norm();
    return !(dot_c * cross_d + dot_d * cross_c < -1e-12 * length_c * length_d);
  }

  bool stays_smooth(const FlipQuad& quad) const {
    if (cosine(new_[0], new_[1]) < sharp_cosine_) return false;
    for (int k = 0; k < 4; ++k) {
      const FaceHandle beyond = mesh_.face_handle(mesh_.opposite_halfedge_handle(quad.side[k]));
      if (!beyond.is_valid()) continue;
      const Shape &other = shapes_[index(beyond)], &before = shapes_[index(quad.face[k / 2])];
      if (!other.has_area()) continue;
      const double allowed = before.has_area() ? std::min(sharp_cosine_, cosine(other, before) - 1e-9) : -1;
      if (cosine(other, new_[FlipQuad::flipped_face[k]]) < allowed) return false;
    }
    return true;
  }

  MeshView view_;
  const OpenMesh::TriConnectivity& mesh_;
  const double sharp_cosine_;
  std::vector<Shape> shapes_;  ///< per face
  std::array<Shape, 2> new_;   ///< of the quadrilateral judged last: (b, c, d) and (a, d, c)
};

}  // namespace

std::unique_ptr<FlipCriterion> delaunay_criterion(MeshView mesh, double sharp_angle, const Context& context) {
  return std::make_unique<DelaunayCriterion>(mesh, sharp_angle, context);
}

}  // namespace tri

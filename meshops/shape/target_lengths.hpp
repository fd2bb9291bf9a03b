#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "meshops/mesh_view.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Model units: of the edges that may be changed; 1 if there are none.
inline double mean_edge_length(const MeshView& view) {
  double sum = 0, edges = 0;
  for (std::size_t i = 0; i < view.mesh.n_edges(); ++i) {
    const EdgeHandle e(static_cast<int>(i));
    if (view.mesh.status(e).deleted() || !view.may_change(e)) continue;
    const HalfedgeHandle h = view.mesh.halfedge_handle(e, 0);
    sum += (view.point(view.mesh.to_vertex_handle(h)) - view.point(view.mesh.from_vertex_handle(h))).norm();
    edges += 1;
  }
  return edges > 0 ? sum / edges : 1;
}

/// Of the box around triangles, model units. @param triangles  at least one
inline double diagonal_of(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  Vec3 low = points[triangles[0][0]], high = low;
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) low.minimize(points[v]), high.maximize(points[v]);
  return (high - low).norm();
}

/// How long the edges at each vertex are to be while a mesh is made anew: everywhere alike, or as its input says.
class TargetLengths {
 public:
  TargetLengths() = default;
  /// @param length    model units, above 0: everywhere, or at most
  /// @param of_input  per vertex of the input; empty: alike everywhere
  TargetLengths(double length, std::vector<double> of_input)
      : length_(length), of_input_(std::move(of_input)), now_(of_input_) {}

  /// The length that was given.
  double longest() const { return length_; }
  /// Of a vertex of the mesh as it is now.
  double at(VertexHandle v) const { return now_.empty() ? length_ : now_[static_cast<std::size_t>(v.idx())]; }

  /// A new vertex comes after all others, between two.
  void add_between(VertexHandle a, VertexHandle b) {
    if (!now_.empty()) now_.push_back(0.5 * (at(a) + at(b)));
  }

  /// A vertex lies within a triangle of the input now, by its weights there. Only where lengths are not alike.
  void move(VertexHandle v, const Triangle& t, const std::array<double, 3>& weights) {
    now_[static_cast<std::size_t>(v.idx())] =
        weights[0] * of_input_[t[0]] + weights[1] * of_input_[t[1]] + weights[2] * of_input_[t[2]];
  }

  /// How many equilateral triangles of these lengths would cover the input, roughly.
  double triangle_count(std::span<const Vec3> points, std::span<const Triangle> triangles) const {
    double area = 0;
    for (const Triangle& t : triangles) {
      const double size = of_input_.empty() ? length_ : (of_input_[t[0]] + of_input_[t[1]] + of_input_[t[2]]) / 3;
      area += 0.5 * ((points[t[1]] - points[t[0]]) % (points[t[2]] - points[t[0]])).norm() / (size * size);
    }
    return area * 4 / std::numbers::sqrt3;
  }

 private:
  double length_ = 1;
  std::vector<double> of_input_, now_;
};

}  // namespace tri

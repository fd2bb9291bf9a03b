#pragma once

#include <algorithm>
#include <cmath>

#include "libtri/triangulation/shell/edit_mesh.hpp"

namespace tri {

/// What a triangle of the shell costs: its area, more for facing away from the model's normals at its corners, and a
/// little for its shape, so that equal areas are decided as Delaunay would [Musin 1997]. The shape is weighed by the
/// area that its corners stand for, not by its own size: long edges are right between scan lines. Unit mm^2; a sum over
/// triangles.
class TriangleCost {
 public:
  explicit TriangleCost(const EditMesh& mesh) : mesh_(mesh) {}

  double operator()(std::uint32_t ia, std::uint32_t ib, std::uint32_t ic) const {
    const EditMesh::Vertex &a = mesh_.vertices[ia], &b = mesh_.vertices[ib], &c = mesh_.vertices[ic];
    const Vec3 ab = b.p - a.p, ac = c.p - a.p;
    const Vec3 n = ab % ac;
    const double twice_area = n.norm();
    double misfit = 0;
    if (twice_area > 0) {
      for (const EditMesh::Vertex* v : {&a, &b, &c}) {
        if (v->normal[0] == 0 && v->normal[1] == 0 && v->normal[2] == 0) continue;
        const double away = 1 - (n[0] * v->normal[0] + n[1] * v->normal[1] + n[2] * v->normal[2]) / twice_area;
        misfit += away > turned ? away + turned_weight * (away - turned) : away;
      }
    }
    const double squares = ab.sqrnorm() + ac.sqrnorm() + (c.p - b.p).sqrnorm();
    const double shape = squares < needle * twice_area ? squares / twice_area : needle_shape(squares, twice_area);
    return 0.5 * twice_area * (1 + misfit) + shape_weight * shape * (a.area + b.area + c.area);
  }
  double operator()(const Triangle& t) const { return (*this)(t[0], t[1], t[2]); }

 private:
  /// Needles grow costlier slowly: enough to prefer the better of two, not enough to fold the surface for it. The bound
  /// keeps rounding from deciding between two without area.
  static double needle_shape(double squares, double twice_area) {
    constexpr double thinnest = 1e-8;
    const double ratio = twice_area > thinnest * squares ? squares / twice_area : 1 / thinnest;  // all three may be one
                                                                                                 // place
    return needle + 20 * std::log(ratio / needle);
  }

  static constexpr double shape_weight = 0.005;
  static constexpr double needle = 60;  ///< squared edges over twice the area; 3.5 for an equilateral triangle
  /// Across the rim of a thin wall a triangle stands at right angles to both sides; only beyond that it is turned
  /// against one.
  static constexpr double turned = 1.3;  ///< 1 - cos of the angle to the model's normal
  static constexpr double turned_weight = 50;

  const EditMesh& mesh_;
};

}  // namespace tri

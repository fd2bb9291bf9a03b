#pragma once

#include <array>
#include <span>
#include <vector>

#include "meshops/mesh_view.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// Two stretches of mesh boundary that face each other across a gap.
struct ContourPair {
  /// Vertices along the mesh boundary, each joined to the next by a boundary half-edge that runs first[i] -> first[i +
  /// 1] (the side of the edge that has no face). At least one vertex.
  std::vector<VertexHandle> first;
  /// The same, of the other side; so it runs against `first` in space.
  std::vector<VertexHandle> second;
  bool closed = false;  ///< both are whole loops; the first vertex is not repeated
};

/// What operators may ask a model that the mesh was measured from: a CAD model, a base surface, an analytic shape.
///
/// Every operator that takes one works without it too, by what the neighbours say. Answers must depend on the arguments
/// alone; they are asked from one thread at a time.
class Reference {
 public:
  virtual ~Reference() = default;

  /// Outward unit normal of the model at the triangle (a, b, c), said about its centroid; zero where the model has none
  /// to give.
  virtual Vec3 normal(VertexHandle a, VertexHandle b, VertexHandle c) const = 0;

  /// Whether a place of triangle (a, b, c) lies inside the trimmed region.
  /// @param barycentric  weights of a, b, c; they sum to 1. On a parametric surface the place is the same mean of
  /// parameters.
  virtual bool inside(VertexHandle a, VertexHandle b, VertexHandle c,
                      const std::array<double, 3>& barycentric) const = 0;

  /// The stretches of boundary to be joined, in the order in which they are to be joined.
  virtual std::vector<ContourPair> contour_pairs(MeshView mesh) const = 0;

  /// Whether the hole with this rim (one position per vertex, closed) is one of the part and is to stay open.
  virtual bool keeps_open(std::span<const VertexHandle> rim) const {
    (void)rim;
    return false;
  }
};

}  // namespace tri

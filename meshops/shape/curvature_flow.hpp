#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/editing/vertex_rows.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// Implicit steps of mean curvature flow [Desbrun, Meyer, Schroeder & Barr 1999, "Implicit fairing of irregular meshes
/// using diffusion and curvature flow"] on a surface, and of curve shortening on lines in it.
///
/// One step solves (M + t K) x' = M x: M has a third of the area of the triangles around each vertex, K the cotangent
/// weights, both of the surface before the step; on lines half the length of the edges beside a vertex, and the inverse
/// lengths. Weights below 0 (at obtuse angles) are taken as 0 and those above 1000 (at needles) as 1000, so the matrix
/// is symmetric with positive diagonal and no positive entry beside it: whatever the triangles and the time, every new
/// point lies within the hull of old ones, and a plane with constant coordinate keeps it bit for bit. Solved by
/// conjugate gradients, for the three coordinates at once, to 1e-4 of the step. Parallel; the result does not depend on
/// the number of threads.
class CurvatureFlow {
 public:
  /// What moves a vertex.
  enum class Part : std::uint8_t { fixed, line, surface };

  /// @param view  its links are used, its positions are not
  /// @param rows  of line vertices their neighbours along the line, of surface vertices all; must outlive this, as
  /// must `parts`
  CurvatureFlow(MeshView view, const VertexRows& rows, std::span<const Part> parts);

  /// Moves the points by one step of `time` (model units squared, above 0): those of lines first, then those of the
  /// surface with lines and fixed points where they are. `time` = h^2 / 8, with h the length of edges, does about as
  /// much as one pass of Laplacian smoothing with factor 0.5.
  /// @param points  one per vertex; all that are used must be finite
  /// @throws Cancelled; the points are as before, or lines have been moved
  void step(std::vector<Vec3>& points, double time, const Context& context);

 private:
  void solve(Part part, std::vector<Vec3>& points, double time, const Context& context);
  void weigh(Part part, const std::vector<Vec3>& points, double time, const Context& context);
  Vec3 sum_over(const Context& context, const std::function<void(std::size_t begin, std::size_t end, Vec3& sum)>& body);

  MeshView view_;
  const VertexRows& rows_;
  std::span<const Part> parts_;
  bool any_line_ = false;
  std::vector<double> cotangents_;  ///< per half-edge: of the angle opposite to it
  std::vector<double> weights_;     ///< per entry of the rows: entry of time * K, with opposite sign
  std::vector<double> mass_, diagonal_;
  std::vector<Vec3> step_, residual_, direction_, image_;
};

}  // namespace tri

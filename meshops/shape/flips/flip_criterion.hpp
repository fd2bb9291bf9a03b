#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Two triangles (a, b, c) and (b, a, d) on an inner edge, which may become (b, c, d) and (a, d, c).
struct FlipQuad {
  EdgeHandle edge;
  std::array<VertexHandle, 4> corner;  ///< a and b where the edge ends, c and d beyond it on its two sides
  std::array<HalfedgeHandle, 4> side;  ///< b c, c a, a d, d b; each has the triangle that the flip leaves at it inside
  std::array<FaceHandle, 2> face;      ///< of sides 0 and 1, of sides 2 and 3
  static constexpr std::array<int, 4> flipped_face{0, 1, 1, 0};  ///< which of the new triangles lies at side k
};

/// The quadrilateral of an edge with two triangles.
inline FlipQuad flip_quad(const OpenMesh::TriConnectivity& mesh, EdgeHandle e) {
  const HalfedgeHandle left = mesh.halfedge_handle(e, 0), right = mesh.halfedge_handle(e, 1);
  FlipQuad quad;
  quad.edge = e;
  quad.side = {mesh.next_halfedge_handle(left), mesh.prev_halfedge_handle(left), mesh.next_halfedge_handle(right),
               mesh.prev_halfedge_handle(right)};
  quad.corner = {mesh.to_vertex_handle(right), mesh.to_vertex_handle(left), mesh.to_vertex_handle(quad.side[0]),
                 mesh.to_vertex_handle(quad.side[2])};
  quad.face = {mesh.face_handle(left), mesh.face_handle(right)};
  return quad;
}

/// What decides which diagonal of a quadrilateral is better. It may keep what it knows of triangles and edges between
/// calls, and learns of every flip.
///
/// So that flipping ends, `flip` may be said only if the flip lowers an order of whole meshes that depends on nothing
/// but their triangles.
class FlipCriterion {
 public:
  enum class Verdict {
    keep,    ///< the other diagonal is not better
    refuse,  ///< it is by the rule, but would not lower the order
    flip,
  };

  virtual ~FlipCriterion() = default;

  virtual Verdict judge(const FlipQuad& quad) = 0;
  /// By how much the flip lowers the order, of the quadrilateral that was judged last; 0 if the flips of this criterion
  /// are done as they are found, above 0 if the largest gain goes first.
  virtual std::int64_t gain() const { return 0; }
  virtual bool largest_gain_first() const { return false; }
  /// Why `refuse`, for the report.
  virtual const char* reason() const { return "would not lower the global order"; }
  /// The edge of the quadrilateral that was judged last was flipped: now it joins c and d.
  virtual void flipped(const FlipQuad& quad) = 0;
  /// Adds figures about the mesh as it is. @param when "before" or "after"
  virtual void describe(const char* when, Report& report, const Context& context) const = 0;
};

/// Corners of a triangle, the lowest index first: what is computed from them has the same bits however they are listed.
inline std::array<VertexHandle, 3> lowest_first(std::array<VertexHandle, 3> corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

inline std::array<VertexHandle, 3> face_corners(const OpenMesh::TriConnectivity& mesh, FaceHandle f) {
  const HalfedgeHandle h = mesh.halfedge_handle(f), next = mesh.next_halfedge_handle(h);
  return {mesh.to_vertex_handle(h), mesh.to_vertex_handle(next),
          mesh.to_vertex_handle(mesh.next_halfedge_handle(next))};
}

/// Whether an edge is there and has two triangles.
inline bool is_inner_edge(const OpenMesh::TriConnectivity& mesh, EdgeHandle e) {
  return !mesh.status(e).deleted() && !mesh.is_boundary(e);
}

}  // namespace tri

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/search/moving_boxes.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Whether two triangles meet in more than the corners or the side that they have in common, by their places. Exact;
/// triangles without an area meet nothing. @param a, b  finite
bool triangles_cross(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Pairs of triangles that cross by `triangles_cross`, as (lower index, higher index), ascending. Parallel; the same
/// for any number of threads. @param points  finite where a triangle uses them @throws Cancelled
std::vector<std::array<std::uint32_t, 2>> crossing_pairs(std::span<const Vec3> points,
                                                         std::span<const Triangle> triangles, const Context& context);

/// Says of one small change of a mesh after another whether more triangles would cross each other than now.
///
/// What is asked is exact, but for one short cut: where the triangles that go, those that come and all around them face
/// one way, none of these cross one another if none did before. Who asks makes the change afterwards, or not; `done`
/// follows what was made. Not to be shared between threads.
class CrossingGuard {
 public:
  /// A triangle as it would be.
  struct Piece {
    std::array<VertexHandle, 3> corners;
    std::array<Vec3, 3> at;
  };

  /// @throws Cancelled
  CrossingGuard(MeshView mesh, const Context& context);

  /// Looks at the mesh as it is now, after it was changed without being asked. @throws Cancelled
  void build();

  /// Whether the pieces, put in the place of some faces, would cross one another or other faces in more pairs than
  /// those do now. Pieces without an area cross nothing.
  /// @param pieces  oriented as the faces are; with their outline
  bool makes_worse(std::span<const Piece> pieces, std::span<const FaceHandle> gone);

  /// The same of the collapse of a half-edge into its end, which goes to `place`.
  bool collapse_makes_worse(HalfedgeHandle h, const Vec3& place);
  /// The same of turning an edge between two triangles into their other diagonal.
  bool flip_makes_worse(EdgeHandle e);
  /// The same of moving a vertex.
  bool move_makes_worse(VertexHandle v, const Vec3& place);

  /// What was asked last was done. @throws Cancelled
  void done();
  /// An edge was split at a new vertex: the faces around it are new, or smaller now. @throws Cancelled
  void split(VertexHandle v);

 private:
  struct Candidate {
    Piece piece;
    Vec3 normal;
    MovingBoxes::Box box;
  };
  Piece piece_of(FaceHandle f) const;
  void collect(std::span<const Piece> pieces, std::uint32_t stamp);
  bool all_face_one_way(std::span<const Piece> pieces);
  std::size_t crossings(std::span<const Piece> pieces, bool one_another, std::size_t enough) const;
  void add_fan(VertexHandle v, VertexHandle other, VertexHandle to, const Vec3& place);

  MeshView view_;
  const Context& context_;
  MovingBoxes boxes_;
  std::size_t alive_ = 0, alive_at_build_ = 0;
  std::vector<Piece> pieces_;     // of the question
  std::vector<FaceHandle> gone_;  // of the question
  std::vector<Piece> old_;        // what these are now
  std::vector<MovingBoxes::Box> piece_boxes_;
  std::vector<Candidate> candidates_;  // other faces near by
  std::vector<std::uint32_t> face_stamps_, vertex_stamps_;
  std::uint32_t stamp_ = 0;
};

}  // namespace tri

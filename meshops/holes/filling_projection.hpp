#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "meshops/editing/add_faces.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/search/overlap_tree.hpp"

namespace tri {

/// Shows of most triangles of a filling, without comparing them with each other, that they meet nothing but their
/// neighbours: neither others of the filling nor the surface around the hole, as far as that is connected to the rim.
///
/// Both are projected along the mean normal of the ring. Over almost every point of the plane the triangles that keep
/// their orientation, less those that are turned over, are as many as the boundary of the whole winds round it. Where
/// that is one at most and nothing is turned over, no two triangles lie over each other, so they cannot meet in space.
/// The boundary is that of the surface around the hole, far from the rim, not the rim itself. In doubt are triangles
/// that come near a triangle which is turned over or a place where the boundary crosses itself. [The idea that normals
/// in a half-space and a simple outline leave no room for self-intersections: Volino & Magnenat-Thalmann 1994.] All
/// tests allow for rounding, so what is shown holds exactly.
class FillingProjection {
 public:
  /// Takes the faces that can be reached from the rim and overlap `box`. Time linear in the vertices and faces of the
  /// mesh for memory that is cleared, and near-linear in the faces taken for everything else.
  /// @param ring  the vertices of the hole in order, as its filling runs
  /// @param box   of the ring
  FillingProjection(MeshView mesh, std::span<const VertexHandle> ring, const OverlapTree::Box& box);

  /// Whether a face belongs to the surface around the hole that this is about.
  bool covers(FaceHandle f) const {
    return static_cast<std::size_t>(f.idx()) < taken_.size() && taken_[static_cast<std::size_t>(f.idx())];
  }

  /// For each triangle of a filling, which has all of the ring as its boundary: 0 if it meets neither another one nor a
  /// face that is covered in more than the vertices or the edge that they share, else 1.
  std::vector<char> in_doubt(std::span<const VertexTriple> filling) const;

 private:
  /// What a triangle must keep clear of: a convex polygon, counter-clockwise if `oriented`.
  struct Region {
    std::array<Vec2, 4> corners;
    int size = 0;
    bool oriented = false;
  };
  struct Step {
    std::int32_t from, to;
  };

  void take_faces(std::span<const VertexHandle> ring, const OverlapTree::Box& box);
  void find_boundary(std::span<const VertexHandle> ring);
  void check_loop(std::span<const std::int32_t> loop);
  void check_loops(const std::vector<std::vector<std::int32_t>>& loops);
  bool apart(const Step& a, const Step& b) const;
  void add_region(const OverlapTree::Box& box);
  Region region_of(const std::array<Vec2, 3>& corners, int turn) const;
  std::array<Vec2, 3> corners_of(FaceHandle f) const;
  std::int32_t number(VertexHandle v);
  Vec2 flat(const Vec3& p) const { return {u_ | (p - center_), v_ | (p - center_)}; }
  double slack(const Vec2& p, const Vec2& q) const;
  int turn(const Vec2& a, const Vec2& b, const Vec2& c) const;
  OverlapTree::Box box_of(std::span<const Vec2> corners) const;
  bool clear(const std::array<Vec2, 3>& triangle, const Region& region) const;

  MeshView view_;
  Vec3 center_{0, 0, 0}, u_{0, 0, 0}, v_{0, 0, 0};
  double error_ = 0;                  ///< bound for that of a projected coordinate
  std::vector<char> taken_;           ///< by face
  std::vector<std::int32_t> number_;  ///< by vertex: its place in `places_`, or -1
  std::vector<Vec2> places_;
  std::vector<FaceHandle> faces_;  ///< that were taken
  std::vector<Region> regions_;
  bool hopeless_ = false;
};

}  // namespace tri

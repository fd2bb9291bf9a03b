#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "meshops/crossings/arrangement/grid_geometry.hpp"

namespace tri {

/// A triangulation of one triangle through points and segments that lie in it, by exact arithmetic.
///
/// Points are put in one by one; segments are then forced by flips [Sloan 1993]; where two of them cross, their common
/// point becomes a vertex. At the end edges that no segment needs are flipped towards Delaunay.
class FaceTriangulation {
 public:
  /// @param corners not along one line; they become vertices 0, 1, 2
  explicit FaceTriangulation(const GridTriangle& corners);

  /// A point inside the triangle or on a side of it. @return its vertex, which may be there already
  int add_point(const ExactPoint& point);
  /// @param from, to  different vertices
  /// @param plane     goes through both and is not the plane of the triangle
  /// @return false if it could not be forced within the bound on steps (the triangulation stays valid)
  bool add_segment(int from, int to, const GridPlane& plane);
  /// @param rank  of each vertex: decides between the diagonals of four points on a circle, so that two triangles that
  /// lie upon each other are cut alike
  void improve(const std::function<std::uint64_t(int)>& rank);

  const std::vector<ExactPoint>& points() const { return points_; }
  /// Runs as the triangle does.
  std::vector<std::array<int, 3>> triangles() const;

 private:
  static constexpr int outside = -1;    ///< beyond a side
  static constexpr int free_edge = -1;  ///< no segment
  static constexpr int side_edge = -2;  ///< of the triangle itself

  struct Part {
    std::array<int, 3> v;     ///< counter-clockwise after projection
    std::array<int, 3> next;  ///< beyond edge k, which runs from v[k] to v[k + 1]
    std::array<int, 3> kind;  ///< of edge k: `free_edge`, `side_edge` or a segment's plane
  };
  struct Place {
    int part = 0, edge = -1, vertex = -1;
  };

  int orientation(int a, int b, int c) const { return turn(points_[a], points_[b], points_[c], i_, j_); }
  Place locate(const ExactPoint& point) const;
  bool place_in(int part, const ExactPoint& point, Place& place) const;
  int new_vertex(const ExactPoint& point);
  void split_part(int part, int vertex);
  void split_edge(int part, int edge, int vertex);
  void flip(int part, int edge);
  bool convex(int part, int edge) const;
  void link(int part, int edge, int other, int old_neighbor);
  int corner_of(int part, int vertex) const;
  int edge_towards(int part, int neighbor_part) const;
  bool find_edge(int from, int to, int& part, int& edge) const;
  bool force(int from, int to, int plane, std::vector<std::array<int, 2>> crossed);
  bool ahead(int a, int b, int v) const;

  GridPlane plane_;
  int i_ = 0, j_ = 1;
  bool mirrored_ = false;
  std::vector<ExactPoint> points_;
  std::vector<Part> parts_;
  std::vector<int> part_of_;  ///< one part at each vertex
  std::vector<GridPlane> segment_planes_;
  mutable int last_ = 0;
};

}  // namespace tri

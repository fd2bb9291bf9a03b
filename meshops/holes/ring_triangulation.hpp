#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/holes/polygon_triangulation.hpp"

namespace tri {

/// A triangulation of a ring that is being made better. The ring may be known in part: `left` are the positions that
/// the triangles use so far, and ears are then added in the reverse of the order in which they were cut.
class RingTriangulation {
 public:
  /// All spans and references must outlive this object.
  /// @param ring, edge_normals, chord_allowed, objective  as `triangulate_ring`
  /// @param left  ascending positions of the smaller ring
  /// @param triangles  a triangulation of the smaller ring, in positions of the whole one
  RingTriangulation(std::span<const Vec3> ring, std::span<const Vec3> edge_normals, const ChordTest& chord_allowed,
                    RingObjective objective, std::span<const std::int32_t> left,
                    std::span<const RingTriangle> triangles);

  /// Puts an ear (p, b, r) on the edge p -> r of the smaller ring, then flips diagonals around it as long as each flip
  /// makes the triangulation lighter (with `RingObjective::dihedral_area`: by the weight of `RingObjective::bending`).
  void add_ear(const RingTriangle& ear);

  /// Takes out the connected pieces of `piece` triangles around each edge between triangles whose normals differ by
  /// more than `least_turn` (1 - cos), triangulates each by `triangulate_ring` and puts that back if it is lighter;
  /// then again where something changed, until no piece gets better or each triangle was in the middle of a piece 8
  /// times. Linear time.
  /// @return how many pieces were changed.
  /// @throws Cancelled between pieces (below a millisecond with 30 triangles)
  std::size_t improve_pieces(int piece, double least_turn, const Context& context);

  const std::vector<RingTriangle>& triangles() const { return triangles_; }

  /// Chooses triangles for a piece: `triangles` (indices into `triangles()`) lie within the ring of `corners`
  /// (ascending positions). Fills `found` with indices into `corners` and returns true to have the piece replaced.
  using PieceSolver = std::function<bool(std::span<const std::int32_t> triangles, std::span<const std::int32_t> corners,
                                         std::vector<RingTriangle>& found)>;
  /// Hands the connected `size` triangles around one (all, if there are fewer) to `solver`.
  /// @return whether they were replaced.
  bool solve_piece(std::int32_t around, int size, const PieceSolver& solver);

 private:
  /// What lies beyond each side: a triangle, or ~i for the ring edge that starts at position i.
  using Sides = std::array<std::int32_t, 3>;
  struct Side {
    std::int32_t low, high, triangle, corner;
  };
  struct Outside {
    std::int32_t from, beyond;
  };

  void link(const std::vector<std::int32_t>& piece, const std::vector<Outside>& outside);
  Vec3 normal_beyond(std::int32_t beyond) const;
  double side_cost(const Vec3& a, const Vec3& b, const Vec3& normal, const Vec3& beyond) const;
  int side_towards(std::int32_t triangle, std::int32_t other) const;
  bool flip_if_lighter(std::int32_t triangle, int side);
  void collect(std::int32_t seed, std::size_t size);
  bool replace_if_lighter();
  void find_ring_of_piece();
  void put_piece();

  std::span<const Vec3> ring_, edge_normals_;
  const ChordTest& chord_allowed_;
  RingObjective objective_;
  double scale_;
  std::vector<Vec3> along_;         ///< sums of length * normal over the ring edges before each position
  std::vector<std::int32_t> next_;  ///< in the smaller ring
  std::vector<RingTriangle> triangles_;
  std::vector<Sides> beside_;
  std::vector<Vec3> normal_;
  std::vector<std::int32_t> owner_;  ///< by position: the triangle at the ring edge that starts there

  std::vector<std::pair<std::int32_t, int>> flips_;
  std::vector<char> in_piece_;
  std::vector<std::int32_t> piece_, corners_;
  std::vector<Side> sides_;
  std::vector<Outside> outside_;
  std::vector<Vec3> places_, normals_;
  std::vector<RingTriangle> found_;
};

}  // namespace tri

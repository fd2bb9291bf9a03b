#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libtri/triangulation/delaunay.hpp"
#include "meshops/crossings/predicates.hpp"

namespace tri {

/// A Delaunay triangulation into which straight segments are forced by flips [Sloan 1993], with exact tests.
class ConstrainedDelaunay {
 public:
  enum class Outcome {
    inserted,
    crosses_segment,  ///< an earlier segment is in the way; nothing was changed
    meets_vertex,     ///< `blocking()` lies on the segment; nothing was changed
    missing_vertex,   ///< an end is a duplicate, so it is in no triangle
  };

  /// @param points  stays the caller's and must outlive this object
  ConstrainedDelaunay(std::span<const Vec2> points, Delaunay delaunay);

  Outcome insert(std::uint32_t from, std::uint32_t to);
  std::uint32_t blocking() const { return blocking_; }

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<std::array<std::int32_t, 3>>& neighbors() const { return neighbors_; }
  /// Gives both away; afterwards only `fixed` may be asked.
  void release(std::vector<Triangle>& triangles, std::vector<std::array<std::int32_t, 3>>& neighbors) {
    triangles = std::move(triangles_);
    neighbors = std::move(neighbors_);
  }
  /// Whether the edge of triangle t opposite corner k is a segment.
  bool fixed(std::int32_t t, int k) const { return fixed_[static_cast<std::size_t>(t)] >> k & 1; }

  struct Side {
    std::int32_t triangle = -1;
    int corner = 0;  ///< opposite the edge
  };
  /// The triangle to the left of the directed edge; triangle -1 if there is none.
  Side left_of(std::uint32_t from, std::uint32_t to) const;

 private:
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return test_.orientation(points_[a], points_[b], points_[c]);
  }
  int corner(std::int32_t t, std::uint32_t v) const;
  void flip(std::int32_t t, int k);
  void fix(const Side& side);

  std::span<const Vec2> points_;
  PlanePredicates test_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<std::int32_t, 3>> neighbors_;
  std::vector<std::uint8_t> fixed_;
  std::vector<std::int32_t> at_vertex_;
  std::uint32_t blocking_ = 0;
};

}  // namespace tri

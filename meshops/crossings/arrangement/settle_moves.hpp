#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/crossings/arrangement/grid_hash.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/number_map.hpp"
#include "meshops/soup.hpp"

namespace tri {

inline Vec3 vector_of(const GridPoint& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// Numbers for places, and how many vertices are in each.
class GridPlaces {
 public:
  /// @param context  null: cannot be cancelled @throws Cancelled
  explicit GridPlaces(const std::vector<GridPoint>& points, const Context* context = nullptr)
      : points_(points), seen_(points.size()), number_(points.size()) {
    Pace pace(context);
    for (std::uint32_t v = 0; v < points.size(); ++v) pace(), enter(v);
  }
  std::uint32_t number(std::uint32_t v) const { return number_[v]; }
  bool crowded(std::uint32_t v) const { return count_[number_[v]] > 1; }
  /// After a point was changed.
  void update(std::uint32_t v) {
    --count_[number_[v]];
    enter(v);
  }

 private:
  void enter(std::uint32_t v) {
    number_[v] = seen_.insert(points_[v], static_cast<std::uint32_t>(count_.size())).first;
    if (number_[v] == count_.size()) count_.push_back(0);
    ++count_[number_[v]];
  }

  const std::vector<GridPoint>& points_;
  NumberMap<GridPoint, GridHash> seen_;
  std::vector<std::uint32_t> number_, count_;
};

/// For each vertex whether it is used and another that is used lies in its place. @throws Cancelled
std::vector<char> share_places(const std::vector<GridPoint>& points, const std::vector<char>& used,
                               const Context& context);

/// A vertex that is to leave its place.
struct VertexMove {
  std::uint32_t vertex;
  Vec3 base, direction;  ///< unit
  double height;         ///< grid steps
  bool may_rest;         ///< else it has to move by a step at least
};

/// Moves vertices as far as they want, and shortens the way of those that make triangles cross, or come to lie in the
/// place of another vertex, until none does. What then rests is tried once more by itself. Triangles with the same
/// corners, by place, may lie upon each other.
/// @param moves   on return `height` is how far each went: 0 for those that rest, also for those that may not
/// @param changed of each move: whether it has to be looked at; others cross nothing but, perhaps, those
/// @param least   grid steps; a vertex that may rest moves no less than this
void settle_moves(std::vector<GridPoint>& points, const std::vector<Triangle>& triangles,
                  std::vector<VertexMove>& moves, std::vector<char> changed, double least, Context& context);

}  // namespace tri

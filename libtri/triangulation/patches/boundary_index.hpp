#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libtri/triangulation/patches/edge_chains.hpp"

namespace tri {

/// Finds the trimming curve that a point of a face's plane lies close to. Immutable; may be shared between threads.
class BoundaryIndex {
 public:
  /// @param reach  mm, per edge of the model: how close counts
  BoundaryIndex(const FaceDomain& domain, std::span<const double> reach);

  struct Place {
    int edge = -1;  ///< position in CadModel::edges; -1 if no curve is close enough
    double s = 0;   ///< share of the edge's length
    double distance = 0;
  };
  /// The closest of the curves within their reach of `p`.
  Place close(const Vec2& p) const;
  /// The closest curve at any distance.
  Place closest(const Vec2& p) const;

 private:
  struct Segment {
    const CoedgeCurve* curve;
    std::uint32_t index;
  };
  double cell_size() const { return 1 / per_cell_; }
  void consider(const Segment& segment, const Vec2& p, bool any, Place& best) const;

  std::vector<double> reach_;
  std::vector<Segment> segments_;
  std::vector<std::uint32_t> cell_start_, cell_segments_;
  Vec2 low_{0, 0};
  double per_cell_ = 0;  // cells per mm
  int columns_ = 0, rows_ = 0;
};

}  // namespace tri

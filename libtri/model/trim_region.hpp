#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "libtri/model/cad_model.hpp"

namespace tri {

/// The trimmed domain of one face: which (u,v) are inside its loops. Immutable; may be shared between threads.
///
/// Each trimming curve is cut into pieces that are monotone in v. A horizontal ray is counted against their chords in
/// slabs of v, and against the curve itself within the proven distance between the two, so the answer is that of the
/// curves and not of a polygon. Gaps between consecutive curves of a loop are closed by straight lines.
class TrimRegion {
 public:
  enum class Side { inside, outside, crossing };

  /// A face without loops is inside everywhere in its parameter box.
  explicit TrimRegion(const CadFace& face);

  bool contains(double u, double v) const;
  /// Shifts `uv` by whole periods of the surface into the region; false if no shift lies inside.
  bool locate(Vec2& uv) const;
  /// `crossing` may also be said of a rectangle that a trimming curve only comes close to.
  Side classify(double u0, double u1, double v0, double v1) const;

  double u_min() const { return u_min_; }
  double u_max() const { return u_max_; }
  double v_min() const { return v_min_; }
  double v_max() const { return v_max_; }

 private:
  struct Segment {
    double u0, v0, u1, v1;  // v0 <= v1
    double slope;           // du / dv
    double band;            // the curve crosses a horizontal line within this distance of its chord
    double deviation_u, deviation_v;
    double t0, t1;        // parameters of the two ends
    const Curve2* curve;  // null for a straight line
  };

  void add_curve(const Curve2& curve, double t0, double t1, int depth);
  void add_segment(const Vec2& a, const Vec2& b, double ta, double tb, const Vec2& deviation, const Curve2* curve);
  void build_slabs();
  int slab(double v) const;
  static double crossing(const Segment& s, double v);

  std::vector<std::shared_ptr<const Curve2>> curves_;
  std::vector<Segment> segments_;
  std::vector<std::uint32_t> slab_start_, slab_segments_;
  double slab_scale_ = 0;
  bool natural_ = false;
  double u_min_, u_max_, v_min_, v_max_;
  double u_period_, v_period_;
};

}  // namespace tri

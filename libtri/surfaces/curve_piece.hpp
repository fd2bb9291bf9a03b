#pragma once

#include <cstdint>
#include <vector>

#include "libtri/surfaces/surface_patch.hpp"

namespace tri {

/// A curve on a face: a trimming curve, or a line of constant u or v along which the surface has a kink.
struct FaceCurve {
  std::shared_ptr<const Curve2> pcurve;
  double first = 0, last = 0;
  std::int32_t edge = -1;    ///< position in CadModel::edges; -1 for a kink
  std::uint32_t face = 0;    ///< position in CadModel::faces
  bool boundary = true;      ///< material on one side only; false for seams, poles and kinks
  bool inside_only = false;  ///< a kink: counts only where it runs inside the trimmed region
  bool point = false;        ///< a pole
};

/// A piece of a FaceCurve with proven bounds; t is counted as s in [-1,1].
struct CurvePiece {
  Vec3 center, half;  // E(0) and dE/ds there
  double t, half_t;
  float remainder;      // |E(s) - center - s half| is at most this
  float first, second;  // bounds of |dE/ds|, |d2E/dss|
  std::uint32_t curve;  // position among the face curves
  bool point;

  /// A distance that no point of the piece goes below.
  double lower_bound(const Vec3& p) const {
    const Vec3 w = p - center;
    const double hh = half | half;
    double s = hh > 0 ? (w | half) / hh : 0;
    s = s < -1 ? -1 : s > 1 ? 1 : s;
    return (w - half * s).norm() - remainder;
  }
  Box box() const;
};

/// Cuts face curve number `index` into pieces.
/// @param diagonal mm, of the model
/// @param context  once it is cancelled, pieces are missing
void make_pieces(const FaceCurve& curve, std::uint32_t index, const Surface& surface, double diagonal,
                 const Context& context, std::vector<CurvePiece>& pieces);

/// Replaces `best` if the piece holds a place that it yields to.
/// @param index     written to best.item
/// @param tolerance mm: parts that could better the distance by less are left
void closest_on_piece(const CurvePiece& piece, std::uint32_t index, const FaceCurve& curve, const Surface& surface,
                      const TrimRegion& region, const Vec3& p, double tolerance, FootCandidate& best);

/// Parameter in [t0,t1] of a local minimum of the distance to `p`, from `t` by Newton's method.
double closest_parameter(const FaceCurve& curve, const Surface& surface, const Vec3& p, double t0, double t1, double t);

/// Position, first and second derivative of a curve on a surface.
CurvePoint3 on_surface(const Surface& surface, const Curve2& curve, double t, Vec2* uv = nullptr,
                       Vec3* normal = nullptr);

}  // namespace tri

#include "libtri/surfaces/curve_piece.hpp"

#include <algorithm>
#include <cmath>

#include "libtri/surfaces/round_up.hpp"

namespace tri {

namespace {

struct PieceBounds {
  double first, second;  // of |dE/dt|, |d2E/dt2|; second is infinite where a kink is crossed
  double cut;            // where to halve the piece: at the kink, or in the middle
};

// A kink strictly between low and high; NaN if there is none.
double kink_between(const std::vector<ParameterBreak>& breaks, double period, double low, double high) {
  const double margin = 1e-9 * (high - low);
  for (const ParameterBreak& b : breaks) {
    if (b.continuity > 0) continue;
    double at = b.at;
    if (period > 0) at += std::ceil((low + margin - at) / period) * period;
    if (at > low + margin && at < high - margin) return at;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

class CurvePieceBuilder {
 public:
  CurvePieceBuilder(const FaceCurve& curve, std::uint32_t index, const Surface& surface, double diagonal,
                    const Context& context, std::vector<CurvePiece>& out)
      : curve_(curve), index_(index), surface_(surface), diagonal_(diagonal), context_(context), out_(out),
        u_(surface.u_breaks()), v_(surface.v_breaks()) {}

  void run() {
    if (curve_.point) {
      CurvePiece piece{};
      piece.t = (curve_.first + curve_.last) / 2;
      piece.half_t = (curve_.last - curve_.first) / 2;
      piece.center = on_surface(surface_, *curve_.pcurve, piece.t).p;
      piece.half = Vec3(0, 0, 0);
      piece.curve = index_;
      piece.point = true;
      // A pole of a sloppy file is a small curve.
      for (int i = 0; i <= 4; ++i) {
        const double t = curve_.first + (curve_.last - curve_.first) * i / 4;
        piece.remainder =
            std::max(piece.remainder, round_up((on_surface(surface_, *curve_.pcurve, t).p - piece.center).norm()));
      }
      out_.push_back(piece);
      return;
    }
    std::vector<double> t{curve_.first};
    for (const ParameterBreak& b : curve_.pcurve->breaks())
      if (b.at > curve_.first && b.at < curve_.last) t.push_back(b.at);
    t.push_back(curve_.last);
    for (std::size_t i = 0; i + 1 < t.size(); ++i) split(t[i], t[i + 1], 0);
  }

 private:
  // The piece's box in (u,v): its ends, grown by how far the curve leaves its chord where it may turn back.
  struct UvBox {
    Vec2 low, high;
  };

  UvBox uv_box(double t0, double t1, const CurveBounds<Vec2>& c) const {
    const Vec2 a = curve_.pcurve->point(t0), b = curve_.pcurve->point(t1);
    const Vec2 slope = curve_.pcurve->evaluate((t0 + t1) / 2).d;
    const double h = t1 - t0;
    UvBox box;
    for (int k = 0; k < 2; ++k) {
      const double grow = std::abs(slope[k]) > c.dd[k] * h / 2 ? 0 : c.dd[k] * h * h / 8;
      box.low[k] = std::min(a[k], b[k]) - grow;
      box.high[k] = std::max(a[k], b[k]) + grow;
    }
    return box;
  }

  PieceBounds bounds(double t0, double t1) const {
    const CurveBounds<Vec2> c = curve_.pcurve->bounds(t0, t1);
    const UvBox box = uv_box(t0, t1, c);
    const SurfaceBounds s = surface_.bounds(box.low[0], box.high[0], box.low[1], box.high[1]);
    PieceBounds out;
    out.first = s.du * c.d[0] + s.dv * c.d[1];
    out.second = s.duu * c.d[0] * c.d[0] + 2 * s.duv * c.d[0] * c.d[1] + s.dvv * c.d[1] * c.d[1] + s.du * c.dd[0] +
                 s.dv * c.dd[1];
    out.cut = (t0 + t1) / 2;
    for (int k = 0; k < 2; ++k) {
      const double kink =
          kink_between(k == 0 ? u_ : v_, k == 0 ? surface_.u_period() : surface_.v_period(), box.low[k], box.high[k]);
      if (std::isnan(kink)) continue;
      out.second = SurfaceBounds::unknown;
      out.cut = crossing(t0, t1, k, kink);
    }
    return out;
  }

  // Where the curve meets the line on which coordinate k is `value`; the middle if its ends are on the same side.
  double crossing(double t0, double t1, int k, double value) const {
    const double side = curve_.pcurve->point(t0)[k] - value;
    double low = t0, high = t1;
    if (side * (curve_.pcurve->point(t1)[k] - value) >= 0) return (t0 + t1) / 2;
    for (double middle = (low + high) / 2; middle > low && middle < high; middle = (low + high) / 2)
      ((curve_.pcurve->point(middle)[k] - value) * side > 0 ? low : high) = middle;
    return high;
  }

  void split(double t0, double t1, int depth) {
    if (context_.cancelled()) return;
    const PieceBounds b = bounds(t0, t1);
    CurvePiece piece{};
    piece.t = (t0 + t1) / 2;
    piece.half_t = (t1 - t0) / 2;
    const CurvePoint3 e = on_surface(surface_, *curve_.pcurve, piece.t);
    piece.center = e.p;
    piece.half = e.d * piece.half_t;
    double first = b.first * piece.half_t;
    const double second = b.second * piece.half_t * piece.half_t;
    double remainder = second / 2;
    if (!std::isfinite(first)) first = 4 * piece.half.norm();  // nothing is proven beside a pole of an offset's base
    if (!std::isfinite(second)) remainder = first + piece.half.norm();
    const double length = piece.half.norm();
    const bool straight = remainder <= 0.05 * length && std::isfinite(second);
    const bool least = std::max(length, first) <= 1e-4 * diagonal_;
    if ((length > diagonal_ / 24 || (!straight && !least)) && depth < 30) {
      split(t0, b.cut, depth + 1);
      split(b.cut, t1, depth + 1);
      return;
    }
    piece.first = round_up(first * (1 + 1e-6));
    piece.second = round_up(second * (1 + 1e-6));
    piece.remainder = round_up(remainder + 1e-12 * diagonal_);
    piece.curve = index_;
    out_.push_back(piece);
  }

  const FaceCurve& curve_;
  std::uint32_t index_;
  const Surface& surface_;
  double diagonal_;
  const Context& context_;
  std::vector<CurvePiece>& out_;
  std::vector<ParameterBreak> u_, v_;
};

void offer(const FaceCurve& curve, std::uint32_t index, const Surface& surface, const TrimRegion& region, const Vec3& p,
           double t, FootCandidate& best) {
  t = std::clamp(t, curve.first, curve.last);
  Vec2 uv;
  Vec3 normal;
  const CurvePoint3 e = on_surface(surface, *curve.pcurve, t, &uv, &normal);
  const double distance = (e.p - p).norm();
  if (!best.yields_to(distance, curve.boundary, curve.face, index)) return;
  if (curve.inside_only && !region.contains(uv[0], uv[1])) return;
  best.distance = distance;
  best.foot = e.p;
  best.normal = normal;
  best.uv = uv;
  best.face = curve.face;
  best.item = index;
  best.on_curve = true;
  best.boundary = curve.boundary;
  best.t = t;
}

// Halves the interval until each part is convex, or too far away, or without a stationary point.
void branch(const CurvePiece& piece, std::uint32_t index, const FaceCurve& curve, const Surface& surface,
            const TrimRegion& region, const Vec3& p, double tolerance, FootCandidate& best) {
  struct Interval {
    double middle, half;
  };
  std::vector<Interval> stack{{0, 1}};
  while (!stack.empty()) {
    const Interval r = stack.back();
    stack.pop_back();
    const double t = piece.t + r.middle * piece.half_t;
    const CurvePoint3 e = on_surface(surface, *curve.pcurve, t);
    const Vec3 w = e.p - p, half = e.d * (piece.half_t * r.half);
    const double second = piece.second * r.half * r.half;
    double bound;
    if (std::isfinite(second)) {
      const double hh = half | half;
      const double s = hh > 0 ? std::clamp(-(w | half) / hh, -1.0, 1.0) : 0;
      bound = (w + half * s).norm() - second / 2;
    } else {
      bound = w.norm() - piece.first * r.half;
    }
    offer(curve, index, surface, region, p, t, best);
    if (bound >= best.distance - tolerance) continue;
    if (std::isfinite(second)) {
      const double first = piece.first * r.half, reach = w.norm() + first;
      const double gradient = w | half;
      const bool inner = r.middle - r.half > -1 + 1e-12 && r.middle + r.half < 1 - 1e-12;
      if (inner && std::abs(gradient) > first * first + reach * second) continue;
      const double hessian = (half | half) + (w | e.dd) * (piece.half_t * piece.half_t * r.half * r.half);
      if (hessian > 3 * first * second + 2 * w.norm() * second) {
        const double t0 = t - r.half * piece.half_t, t1 = t + r.half * piece.half_t;
        offer(curve, index, surface, region, p, closest_parameter(curve, surface, p, t0, t1, t), best);
        continue;
      }
    }
    if (piece.first * r.half <= tolerance || r.half < 1e-12) continue;
    stack.push_back({r.middle - r.half / 2, r.half / 2});
    stack.push_back({r.middle + r.half / 2, r.half / 2});
  }
}

}  // namespace

double closest_parameter(const FaceCurve& curve, const Surface& surface, const Vec3& p, double t0, double t1,
                         double t) {
  double previous = std::numeric_limits<double>::infinity(), last = t;
  for (int i = 0; i < 60; ++i) {
    const CurvePoint3 e = on_surface(surface, *curve.pcurve, t);
    const Vec3 w = e.p - p;
    const double distance = w.norm();
    if (distance > previous * (1 + 1e-12) && i < 50) {
      t = (t + last) / 2;
      continue;
    }
    previous = distance;
    const double g = w | e.d, metric = e.d | e.d;
    double h = metric + (w | e.dd);
    const bool newton = h > 1e-3 * metric;
    if (!newton) h = metric;
    if (!(h > 0)) return t;
    last = t;
    const double next = std::clamp(t - g / h, t0, t1);
    const double step = std::abs(next - t);
    t = next;
    if (step <= (newton ? 1e-8 : 1e-12) * (t1 - t0)) return t;
  }
  return t;
}

CurvePoint3 on_surface(const Surface& surface, const Curve2& curve, double t, Vec2* uv, Vec3* normal) {
  const CurvePoint2 c = curve.evaluate(t);
  const SurfacePoint s = surface.evaluate(c.p[0], c.p[1]);
  if (uv) *uv = c.p;
  if (normal) *normal = s.du % s.dv;
  const double du = c.d[0], dv = c.d[1];
  return {s.p, s.du * du + s.dv * dv,
          s.duu * (du * du) + s.duv * (2 * du * dv) + s.dvv * (dv * dv) + s.du * c.dd[0] + s.dv * c.dd[1]};
}

Box CurvePiece::box() const {
  Vec3 reach;
  for (int c = 0; c < 3; ++c) reach[c] = std::abs(half[c]) + remainder;
  return {center - reach, center + reach};
}

void make_pieces(const FaceCurve& curve, std::uint32_t index, const Surface& surface, double diagonal,
                 const Context& context, std::vector<CurvePiece>& pieces) {
  CurvePieceBuilder(curve, index, surface, diagonal, context, pieces).run();
}

void closest_on_piece(const CurvePiece& piece, std::uint32_t index, const FaceCurve& curve, const Surface& surface,
                      const TrimRegion& region, const Vec3& p, double tolerance, FootCandidate& best) {
  if (piece.point) {
    // The longitude under which the point is seen, by the least distance close to the pole.
    double nearest = std::numeric_limits<double>::infinity(), at = piece.t;
    for (int i = 0; i <= 16; ++i) {
      const double t = curve.first + (curve.last - curve.first) * i / 16;
      const double distance = (on_surface(surface, *curve.pcurve, t).p - p).norm();
      if (distance < nearest) {
        nearest = distance;
        at = t;
      }
    }
    offer(curve, index, surface, region, p, at, best);
    return;
  }
  const double hh = piece.half | piece.half;
  const double s = hh > 0 ? std::clamp(((p - piece.center) | piece.half) / hh, -1.0, 1.0) : 0;
  const double t0 = piece.t - piece.half_t, t1 = piece.t + piece.half_t;
  const double t = closest_parameter(curve, surface, p, t0, t1, piece.t + s * piece.half_t);
  offer(curve, index, surface, region, p, t, best);
  const CurvePoint3 e = on_surface(surface, *curve.pcurve, t);
  const double distance = (e.p - p).norm(), h2 = piece.half_t * piece.half_t;
  const double hessian = ((e.d | e.d) + ((e.p - p) | e.dd)) * h2;
  const bool convex = hessian > 6.0 * piece.first * piece.second + 2.0 * distance * piece.second;
  if (!convex) branch(piece, index, curve, surface, region, p, tolerance, best);
}

}  // namespace tri

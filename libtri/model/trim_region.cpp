#include "libtri/model/trim_region.hpp"

#include <algorithm>
#include <cmath>

namespace tri {

namespace {

constexpr int max_depth = 40;

// The parameters first..last of a coedge's curve, cut at its breaks.
std::vector<double> pieces(const Coedge& coedge) {
  std::vector<double> t{coedge.first};
  for (const ParameterBreak& b : coedge.pcurve->breaks())
    if (b.at > coedge.first && b.at < coedge.last) t.push_back(b.at);
  t.push_back(coedge.last);
  return t;
}

}  // namespace

TrimRegion::TrimRegion(const CadFace& face) : u_period_(face.surface->u_period()), v_period_(face.surface->v_period()) {
  u_min_ = face.u_min;
  u_max_ = face.u_max;
  v_min_ = face.v_min;
  v_max_ = face.v_max;
  natural_ = true;
  for (const TrimLoop& loop : face.loops) {
    const std::size_t n = loop.coedges.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Coedge& coedge = loop.coedges[i];
      natural_ = false;
      curves_.push_back(coedge.pcurve);
      const std::vector<double> t = pieces(coedge);
      // Eight pieces at least, so that the parts where the chord is not enough stay small.
      for (std::size_t k = 0; k + 1 < t.size(); ++k) {
        const bool straight = coedge.pcurve->bounds(t[k], t[k + 1]).dd.norm() == 0;
        const int parts = straight ? 1 : 8;
        for (int p = 0; p < parts; ++p) {
          const double a = t[k] + (t[k + 1] - t[k]) * p / parts;
          const double b = p + 1 == parts ? t[k + 1] : t[k] + (t[k + 1] - t[k]) * (p + 1) / parts;
          add_curve(*coedge.pcurve, a, b, 0);
        }
      }
      const Coedge& next = loop.coedges[(i + 1) % n];
      const Vec2 end = coedge.pcurve->point(coedge.reversed ? coedge.first : coedge.last);
      const Vec2 begin = next.pcurve->point(next.reversed ? next.last : next.first);
      if (end != begin) add_segment(end, begin, 0, 0, Vec2(0, 0), nullptr);
    }
  }
  if (natural_) return;
  u_min_ = v_min_ = std::numeric_limits<double>::infinity();
  u_max_ = v_max_ = -u_min_;
  for (const Segment& s : segments_) {
    u_min_ = std::min({u_min_, s.u0 - s.deviation_u, s.u1 - s.deviation_u});
    u_max_ = std::max({u_max_, s.u0 + s.deviation_u, s.u1 + s.deviation_u});
    v_min_ = std::min(v_min_, s.v0);  // monotone in v
    v_max_ = std::max(v_max_, s.v1);
  }
  build_slabs();
}

void TrimRegion::add_curve(const Curve2& curve, double t0, double t1, int depth) {
  const double h = t1 - t0;
  const CurveBounds<Vec2> b = curve.bounds(t0, t1);
  const Vec2 deviation = b.dd * (h * h / 8);
  const double middle = t0 + h / 2;
  const Vec2 a = curve.point(t0), c = curve.point(t1);
  const double size_u = u_max_ - u_min_, size_v = v_max_ - v_min_;
  const bool straight = deviation[0] <= 1e-14 * size_u && deviation[1] <= 1e-14 * size_v;
  const bool flat = b.d[1] * h <= 1e-13 * size_v;
  if (straight || flat) {
    add_segment(a, c, t0, t1, deviation, nullptr);
    return;
  }
  const bool monotone = std::abs(curve.evaluate(middle).d[1]) > b.dd[1] * h / 2;
  // Beyond the flatness of a coarse polygon the exact crossing takes over.
  const bool fine = deviation[0] <= 1e-4 * size_u && deviation[1] <= 1e-4 * size_v;
  if ((monotone && fine) || depth >= max_depth || middle <= t0 || middle >= t1) {
    add_segment(a, c, t0, t1, deviation, monotone ? &curve : nullptr);
    return;
  }
  add_curve(curve, t0, middle, depth + 1);
  add_curve(curve, middle, t1, depth + 1);
}

void TrimRegion::add_segment(const Vec2& a, const Vec2& b, double ta, double tb, const Vec2& deviation,
                             const Curve2* curve) {
  const bool up = a[1] <= b[1];
  const Vec2 &low = up ? a : b, &high = up ? b : a;
  Segment s;
  s.u0 = low[0];
  s.v0 = low[1];
  s.u1 = high[0];
  s.v1 = high[1];
  s.slope = s.v1 > s.v0 ? (s.u1 - s.u0) / (s.v1 - s.v0) : 0;
  s.deviation_u = deviation[0];
  s.deviation_v = deviation[1];
  s.band = curve ? deviation[0] + std::abs(s.slope) * deviation[1] : 0;
  s.t0 = up ? ta : tb;
  s.t1 = up ? tb : ta;
  s.curve = curve;
  segments_.push_back(s);
}

int TrimRegion::slab(double v) const {
  const double x = (v - v_min_) * slab_scale_;
  const int last = static_cast<int>(slab_start_.size()) - 2;
  return x > 0 ? (x < last ? static_cast<int>(x) : last) : 0;
}

void TrimRegion::build_slabs() {
  const int slabs = std::clamp(static_cast<int>(segments_.size()), 4, 1024);
  slab_scale_ = v_max_ > v_min_ ? slabs / (v_max_ - v_min_) : 0;
  slab_start_.assign(slabs + 1, 0);
  const auto range = [&](const Segment& s, auto&& use) {
    if (s.v0 == s.v1 && s.deviation_v == 0 && s.u0 == s.u1) return;
    for (int k = slab(s.v0 - s.deviation_v), end = slab(s.v1 + s.deviation_v); k <= end; ++k) use(k);
  };
  for (const Segment& s : segments_) range(s, [&](int k) { ++slab_start_[k + 1]; });
  for (int k = 0; k < slabs; ++k) slab_start_[k + 1] += slab_start_[k];
  slab_segments_.resize(slab_start_[slabs]);
  std::vector<std::uint32_t> next(slab_start_.begin(), slab_start_.end() - 1);
  for (std::uint32_t i = 0; i < segments_.size(); ++i)
    range(segments_[i], [&](int k) { slab_segments_[next[k]++] = i; });
}

double TrimRegion::crossing(const Segment& s, double v) {
  // Newton on the monotone v(t), kept in a bracket.
  double low = s.t0, high = s.t1;
  double t = low + (high - low) * (v - s.v0) / (s.v1 - s.v0);
  CurvePoint2 c{};
  for (int i = 0; i < 60; ++i) {
    c = s.curve->evaluate(t);
    const double error = c.p[1] - v;
    if (error == 0) break;
    (error < 0 ? low : high) = t;
    double next = t - error / c.d[1];
    const bool bracketed = low < high ? next > low && next < high : next < low && next > high;
    if (!bracketed) next = low + (high - low) / 2;
    if (std::abs(next - t) <= 1e-15 * std::abs(t) || next == low || next == high) break;
    t = next;
  }
  return c.p[0];
}

bool TrimRegion::contains(double u, double v) const {
  if (natural_) return u >= u_min_ && u <= u_max_ && v >= v_min_ && v <= v_max_;
  if (!(v >= v_min_ && v <= v_max_ && u >= u_min_ && u <= u_max_)) return false;
  const int k = slab(v);
  bool inside = false;
  for (std::uint32_t i = slab_start_[k]; i < slab_start_[k + 1]; ++i) {
    const Segment& s = segments_[slab_segments_[i]];
    if (v < s.v0 || v >= s.v1) continue;
    double at = s.u0 + (v - s.v0) * s.slope;
    if (s.curve && std::abs(at - u) <= s.band) at = crossing(s, v);
    inside ^= at > u;
  }
  return inside;
}

bool TrimRegion::locate(Vec2& uv) const {
  const auto lowest = [](double x, double low, double period) {
    return period > 0 ? x - std::floor((x - low) / period + 1e-12) * period : x;
  };
  const double u0 = lowest(uv[0], u_min_, u_period_), v0 = lowest(uv[1], v_min_, v_period_);
  for (double u = u0;; u += u_period_) {
    for (double v = v0;; v += v_period_) {
      if (contains(u, v)) {
        uv = Vec2(u, v);
        return true;
      }
      if (v_period_ <= 0 || v + v_period_ > v_max_) break;
    }
    if (u_period_ <= 0 || u + u_period_ > u_max_) break;
  }
  return false;
}

TrimRegion::Side TrimRegion::classify(double u0, double u1, double v0, double v1) const {
  const double u = (u0 + u1) / 2, v = (v0 + v1) / 2;
  if (natural_) return u0 >= u_min_ && u1 <= u_max_ && v0 >= v_min_ && v1 <= v_max_ ? Side::inside : Side::crossing;
  if (u0 > u_max_ || u1 < u_min_ || v0 > v_max_ || v1 < v_min_) return Side::outside;
  const double hu = (u1 - u0) / 2, hv = (v1 - v0) / 2;
  for (int k = slab(v0), end = slab(v1); k <= end; ++k) {
    for (std::uint32_t i = slab_start_[k]; i < slab_start_[k + 1]; ++i) {
      const Segment& s = segments_[slab_segments_[i]];
      const double eu = hu + s.deviation_u, ev = hv + s.deviation_v;
      if (std::max(s.u0, s.u1) < u - eu || std::min(s.u0, s.u1) > u + eu || s.v1 < v - ev || s.v0 > v + ev) continue;
      // The chord's line against the rectangle.
      const double du = s.u1 - s.u0, dv = s.v1 - s.v0;
      const double offset = (u - s.u0) * dv - (v - s.v0) * du;
      if (std::abs(offset) <= (std::abs(dv) * eu + std::abs(du) * ev) * (1 + 1e-12)) return Side::crossing;
    }
  }
  return contains(u, v) ? Side::inside : Side::outside;
}

}  // namespace tri

#include "libtri/triangulation/patches/edge_chains.hpp"

#include <algorithm>
#include <cmath>

namespace tri {

CoedgeCurve::CoedgeCurve(const CadFace& face, const Coedge& coedge, const Vec2& scale)
    : edge_(coedge.edge), reversed_(coedge.reversed) {
  std::vector<Vec2> uv = coedge.polyline;
  if (reversed_) std::reverse(uv.begin(), uv.end());
  for (const Vec2& p : uv) {
    plane_.emplace_back(p[0] * scale[0], p[1] * scale[1]);
    space_.push_back(face.surface->point(p[0], p[1]));
  }
  if (plane_.size() == 1) {
    plane_.push_back(plane_[0]);
    space_.push_back(space_[0]);
  }
  double in_plane = 0;
  std::vector<double> plane_share{0};
  share_.push_back(0);
  for (std::size_t i = 1; i < plane_.size(); ++i) {
    length_ += (space_[i] - space_[i - 1]).norm();
    in_plane += (plane_[i] - plane_[i - 1]).norm();
    share_.push_back(length_);
    plane_share.push_back(in_plane);
  }
  if (length_ <= 1e-6 * in_plane) {  // a pole
    length_ = in_plane;
    share_ = plane_share;
  }
  for (double& s : share_) s = length_ > 0 ? s / length_ : 0;
  share_.back() = 1;
}

std::size_t CoedgeCurve::segment_at(double s) const {
  const auto above = std::upper_bound(share_.begin(), share_.end(), s);
  const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - share_.begin(), 1)) - 1;
  return std::min(i, n_segments() - 1);
}

Vec2 CoedgeCurve::plane_point(double s) const {
  if (s <= 0) return plane_.front();
  if (s >= 1) return plane_.back();
  const std::size_t i = segment_at(s);
  const double width = share_[i + 1] - share_[i];
  const double t = width > 0 ? (s - share_[i]) / width : 0;
  return plane_[i] * (1 - t) + plane_[i + 1] * t;
}

Vec3 CoedgeCurve::space_point(double s) const {
  if (s <= 0) return space_.front();
  if (s >= 1) return space_.back();
  const std::size_t i = segment_at(s);
  const double width = share_[i + 1] - share_[i];
  const double t = width > 0 ? (s - share_[i]) / width : 0;
  return space_[i] * (1 - t) + space_[i + 1] * t;
}

double CoedgeCurve::sagitta(double s0, double s1) const {
  const Vec2 a = plane_point(s0), b = plane_point(s1);
  const Vec3 c = space_point(s0), d = space_point(s1);
  const auto off = [](const auto& p, const auto& from, const auto& to) {
    const auto along = to - from;
    const double square = along.sqrnorm();
    const double t = square > 0 ? std::clamp(((p - from) | along) / square, 0.0, 1.0) : 0.0;
    return (p - (from + along * t)).norm();
  };
  double largest = 0;
  for (std::size_t i = segment_at(s0) + 1; i < plane_.size() && share_[i] < s1; ++i)
    largest = std::max({largest, off(plane_[i], a, b), off(space_[i], c, d)});
  return largest;
}

double CoedgeCurve::project(std::size_t segment, const Vec2& p, double& distance) const {
  const Vec2& a = plane_[segment];
  const Vec2 along = plane_[segment + 1] - a;
  const double square = along.sqrnorm();
  const double t = square > 0 ? std::clamp(((p - a) | along) / square, 0.0, 1.0) : 0.0;
  distance = (p - (a + along * t)).norm();
  return share_[segment] + t * (share_[segment + 1] - share_[segment]);
}

FaceDomain face_domain(const CadFace& face) {
  FaceDomain domain;
  // Mean lengths of the derivatives over the face's box.
  constexpr int n = 9;
  constexpr double largest_distortion = 1.25;
  double du = 0, dv = 0;
  std::vector<SurfacePoint> samples;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u = face.u_min + (face.u_max - face.u_min) * (i + 0.5) / n;
      const double v = face.v_min + (face.v_max - face.v_min) * (j + 0.5) / n;
      const SurfacePoint s = face.surface->evaluate(u, v);
      du += s.du.norm();
      dv += s.dv.norm();
      samples.push_back(s);
    }
  if (du > 0 && std::isfinite(du)) domain.scale[0] = du / (n * n);
  if (dv > 0 && std::isfinite(dv)) domain.scale[1] = dv / (n * n);
  for (const SurfacePoint& s : samples) {
    // Largest over smallest stretch of the map from the plane to the surface.
    const Vec3 x = s.du / domain.scale[0], y = s.dv / domain.scale[1];
    const double mean = 0.5 * (x.sqrnorm() + y.sqrnorm()), half = 0.5 * (x.sqrnorm() - y.sqrnorm()), skew = x | y;
    const double spread = std::hypot(half, skew);
    domain.uniform &= mean + spread <= largest_distortion * largest_distortion * (mean - spread);
  }
  for (const TrimLoop& loop : face.loops) {
    auto& curves = domain.loops.emplace_back();
    for (const Coedge& coedge : loop.coedges)
      if (!coedge.polyline.empty()) curves.emplace_back(face, coedge, domain.scale);
    if (curves.empty()) domain.loops.pop_back();
  }
  return domain;
}

}  // namespace tri

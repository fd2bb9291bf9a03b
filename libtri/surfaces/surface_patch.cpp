#include "libtri/surfaces/surface_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libtri/surfaces/round_up.hpp"

namespace tri {

namespace {

// The surface over (a,b) in [-1,1] x [-1,1].
struct Local {
  Vec3 p, a, b, aa, ab, bb;
};

Local evaluate(const SurfacePatch& patch, const Surface& surface, double a, double b) {
  const double hu = patch.half_u, hv = patch.half_v;
  const SurfacePoint s = surface.evaluate(patch.u + a * hu, patch.v + b * hv);
  return {s.p, s.du * hu, s.dv * hv, s.duu * (hu * hu), s.duv * (hu * hv), s.dvv * (hv * hv)};
}

// Gradient and Hessian of half the squared distance.
struct Quadric {
  double ga, gb, aa, ab, bb, distance;
};

Quadric quadric(const Local& s, const Vec3& p) {
  const Vec3 w = s.p - p;
  return {w | s.a, w | s.b, (s.a | s.a) + (w | s.aa), (s.a | s.b) + (w | s.ab), (s.b | s.b) + (w | s.bb), w.norm()};
}

bool convex(const SurfacePatch& patch, const Quadric& q, double share) {
  const double aa = q.aa - share * (patch.e0[0] + q.distance * patch.e1[0]);
  const double bb = q.bb - share * (patch.e0[2] + q.distance * patch.e1[2]);
  const double ab = std::abs(q.ab) + share * (patch.e0[1] + q.distance * patch.e1[1]);
  return aa > 0 && bb > 0 && aa * bb > ab * ab;
}

struct Rectangle {
  double a0, a1, b0, b1;
};

struct Minimum {
  double a, b;
  Vec3 foot, normal;
  Quadric last;  // at the last evaluation
};

// Newton's method for the least distance over the rectangle; on its sides, along them.
Minimum minimise(const SurfacePatch& patch, const Surface& surface, const Vec3& p, const Rectangle& r, double a,
                 double b) {
  a = std::clamp(a, r.a0, r.a1);
  b = std::clamp(b, r.b0, r.b1);
  Minimum out{};
  double previous = std::numeric_limits<double>::infinity(), last_a = a, last_b = b;
  for (int i = 0;; ++i) {
    const Local s = evaluate(patch, surface, a, b);
    const Quadric q = quadric(s, p);
    if (q.distance > previous * (1 + 1e-12) && i < 50) {
      a = (a + last_a) / 2;
      b = (b + last_b) / 2;
      continue;
    }
    previous = q.distance;
    const bool stop_a = (a <= r.a0 && q.ga > 0) || (a >= r.a1 && q.ga < 0);
    const bool stop_b = (b <= r.b0 && q.gb > 0) || (b >= r.b1 && q.gb < 0);
    const double g11 = s.a | s.a, g12 = s.a | s.b, g22 = s.b | s.b;
    double haa = q.aa, hab = q.ab, hbb = q.bb;
    // Where the Hessian is of no use, Gauss-Newton's is; its metric vanishes at poles only.
    bool newton = true;
    const double floor = 1e-14 * (g11 + g22);
    if (!(stop_a || haa > 1e-3 * g11) || !(stop_b || hbb > 1e-3 * g22) ||
        (!stop_a && !stop_b && !(haa * hbb > hab * hab))) {
      newton = false;
      haa = g11 + floor;
      hab = g12;
      hbb = g22 + floor;
    }
    const auto along_a = [&](double db) { return haa > 0 ? -(q.ga + hab * db) / haa : 0.0; };
    const auto along_b = [&](double da) { return hbb > 0 ? -(q.gb + hab * da) / hbb : 0.0; };
    double da = 0, db = 0;
    if (!stop_a && !stop_b) {
      const double determinant = haa * hbb - hab * hab;
      if (determinant > 1e-14 * haa * hbb) {
        da = (hab * q.gb - hbb * q.ga) / determinant;
        db = (hab * q.ga - haa * q.gb) / determinant;
      } else {
        da = along_a(0);
        db = along_b(0);
      }
      if (a + da < r.a0 || a + da > r.a1) {
        da = std::clamp(a + da, r.a0, r.a1) - a;
        db = along_b(da);
      } else if (b + db < r.b0 || b + db > r.b1) {
        db = std::clamp(b + db, r.b0, r.b1) - b;
        da = along_a(db);
      }
    } else if (!stop_a) {
      da = along_a(0);
    } else if (!stop_b) {
      db = along_b(0);
    }
    da = std::clamp(a + da, r.a0, r.a1) - a;
    db = std::clamp(b + db, r.b0, r.b1) - b;
    const double step = std::sqrt(g11 * da * da + g22 * db * db);
    const double size = std::sqrt(g11 + g22);
    if (step <= (newton ? 1e-6 : 1e-11) * size || i >= 60) {
      // The step is so short that the Taylor polynomial is exact to rounding.
      if (i < 60 || step <= 1e-3 * size) {
        a += da;
        b += db;
        out.foot = s.p + s.a * da + s.b * db + s.aa * (da * da / 2) + s.ab * (da * db) + s.bb * (db * db / 2);
        out.normal = (s.a + s.aa * da + s.ab * db) % (s.b + s.ab * da + s.bb * db);
      } else {
        out.foot = s.p;
        out.normal = s.a % s.b;
      }
      out.a = a;
      out.b = b;
      out.last = q;
      return out;
    }
    last_a = a;
    last_b = b;
    a += da;
    b += db;
  }
}

void offer(const SurfacePatch& patch, std::uint32_t index, const TrimRegion& region, const Vec3& p, double a, double b,
           const Vec3& foot, const Vec3& normal, FootCandidate& best) {
  const double distance = (foot - p).norm();
  if (!best.yields_to(distance, false, patch.face, index)) return;
  const Vec2 uv(patch.u + a * patch.half_u, patch.v + b * patch.half_v);
  if (!patch.inside && !region.contains(uv[0], uv[1])) return;
  best.distance = distance;
  best.foot = foot;
  best.normal = normal;
  best.uv = uv;
  best.face = patch.face;
  best.item = index;
  best.on_curve = best.boundary = false;
}

// Halves the patch until each piece is convex, or too far away, or without a stationary point.
void branch(const SurfacePatch& patch, std::uint32_t index, const Surface& surface, const TrimRegion& region,
            const Vec3& p, double tolerance, FootCandidate& best) {
  std::vector<Rectangle> stack{{-1, 1, -1, 1}};
  while (!stack.empty()) {
    const Rectangle r = stack.back();
    stack.pop_back();
    const double a = (r.a0 + r.a1) / 2, b = (r.b0 + r.b1) / 2;
    const double ha = (r.a1 - r.a0) / 2, hb = (r.b1 - r.b0) / 2;
    const Local s = evaluate(patch, surface, a, b);
    const Quadric q = quadric(s, p);
    const double remainder = patch.second[0] * ha * ha / 2 + patch.second[1] * ha * hb + patch.second[2] * hb * hb / 2;
    const double length_a = s.a.norm() * ha, length_b = s.b.norm() * hb;
    double bound = q.distance - length_a - length_b - remainder;
    if (length_a > 0 && length_b > 0) {
      // The parallelogram of the tangents, grown by the remainder, in its own frame.
      const Vec3 w = s.p - p, e1 = s.a * (ha / length_a);
      const Vec3 across = s.b - e1 * (s.b | e1);
      const double width = across.norm();
      if (width > 0) {
        const Vec3 e2 = across / width, n = e1 % e2;
        const double x = std::max(0.0, std::abs(w | e1) - length_a - std::abs(s.b | e1) * hb - remainder);
        const double y = std::max(0.0, std::abs(w | e2) - width * hb - remainder);
        const double z = std::max(0.0, std::abs(w | n) - remainder);
        bound = std::max(bound, std::sqrt(x * x + y * y + z * z));
      }
    }
    offer(patch, index, region, p, a, b, s.p, s.a % s.b, best);
    if (bound >= best.distance - tolerance) continue;
    // No stationary point if a derivative cannot reach zero. The least distance is then on a side, that is in a
    // neighbour, on a crease or on a trimming curve, all of which are searched by themselves.
    const double reach = q.distance + length_a + length_b + remainder;
    const double la = patch.first[0], lb = patch.first[1];
    const double vary_a = (la * la + reach * patch.second[0]) * ha + (la * lb + reach * patch.second[1]) * hb;
    const double vary_b = (la * lb + reach * patch.second[1]) * ha + (lb * lb + reach * patch.second[2]) * hb;
    if (std::abs(q.ga) > vary_a || std::abs(q.gb) > vary_b) continue;
    if (convex(patch, q, std::max(ha, hb) / 2)) {
      const Minimum m = minimise(patch, surface, p, r, a, b);
      offer(patch, index, region, p, m.a, m.b, m.foot, m.normal, best);
      continue;
    }
    if (length_a + length_b + remainder <= tolerance || ha + hb < 1e-12) continue;
    if (length_a + patch.second[0] * ha * ha >= length_b + patch.second[2] * hb * hb) {
      stack.push_back({r.a0, a, r.b0, r.b1});
      stack.push_back({a, r.a1, r.b0, r.b1});
    } else {
      stack.push_back({r.a0, r.a1, r.b0, b});
      stack.push_back({r.a0, r.a1, b, r.b1});
    }
  }
}

// How much the Hessian may change over a patch, and whether it stays positive definite for points near the surface.
//
// With |x| the bound over the patch and c its centre, |S_i(y).S_jk(z)| <= |S_i(c).S_jk(c)| + |S_i| |dS_jk| + |S_jk|
// |dS_i| for all y, z in the patch. These products bound how the metric S_i.S_j and the term (S - p).S_jk change
// between two places whose (a,b) differ by at most 2 in each coordinate.
struct Certificate {
  double first[2], second[3], e0[3], e1[3];

  Certificate(const Local& s, const SurfaceBounds& bounds, double hu, double hv, double diagonal)
      : first{bounds.du * hu, bounds.dv * hv}, second{bounds.duu * hu * hu, bounds.duv * hu * hv, bounds.dvv * hv * hv},
        aa_(s.a | s.a), ab_(s.a | s.b), bb_(s.b | s.b) {
    const double third[4] = {bounds.duuu * hu * hu * hu, bounds.duuv * hu * hu * hv, bounds.duvv * hu * hv * hv,
                             bounds.dvvv * hv * hv * hv};
    const Vec3* d1[2] = {&s.a, &s.b};
    const Vec3* d2[3] = {&s.aa, &s.ab, &s.bb};
    double product[2][3];
    for (int k = 0; k < 3; ++k) {
      const double from_center = std::min(third[k] + third[k + 1], 2 * second[k]);
      e1[k] = 2 * std::min(from_center, second[k]);
      for (int i = 0; i < 2; ++i)
        product[i][k] = std::min(first[i] * second[k], std::abs(*d1[i] | *d2[k]) + first[i] * from_center +
                                                           second[k] * (second[i] + second[i + 1]));
    }
    e0[0] = 4 * (product[0][0] + product[0][1]) + 2 * (product[0][0] + product[1][0]);
    e0[1] = 2 * (product[1][0] + product[0][1] + product[1][1] + product[0][2]) + 2 * (product[0][1] + product[1][1]);
    e0[2] = 4 * (product[1][1] + product[1][2]) + 2 * (product[0][2] + product[1][2]);
    const double radius =
        std::min(second[0] > 0 ? aa_ / second[0] : diagonal, second[2] > 0 ? bb_ / second[2] : diagonal);
    const double distance = std::min(1e-3 * diagonal, 0.25 * radius);
    for (int k = 0; k < 3; ++k) change_[k] = e0[k] + distance * (e1[k] + second[k]);
  }

  bool holds() const {
    const double a = aa_ - change_[0], b = bb_ - change_[2], mixed = std::abs(ab_) + change_[1];
    return a > 0 && b > 0 && a * b > mixed * mixed;
  }
  double badness() const { return std::max(change_[0] / aa_, change_[2] / bb_) + change_[1] / std::sqrt(aa_ * bb_); }

 private:
  double aa_, ab_, bb_, change_[3];
};

class PatchBuilder {
 public:
  PatchBuilder(const CadFace& face, const TrimRegion& region, std::uint32_t position, double diagonal,
               const Context& context, std::vector<SurfacePatch>& out)
      : surface_(*face.surface), region_(region), position_(position), diagonal_(diagonal), context_(context),
        out_(out), begin_(out.size()) {
    Vec2 feet[2];
    closed_form_ = surface_.closest(surface_.point(face.u_min, face.v_min), feet) >= 0;
  }

  void run() {
    const std::vector<double> u = cuts(surface_.u_breaks(), surface_.u_period(), region_.u_min(), region_.u_max());
    const std::vector<double> v = cuts(surface_.v_breaks(), surface_.v_period(), region_.v_min(), region_.v_max());
    for (std::size_t i = 0; i + 1 < u.size(); ++i)
      for (std::size_t j = 0; j + 1 < v.size(); ++j) split(u[i], u[i + 1], v[j], v[j + 1], 0);
  }

 private:
  static std::vector<double> cuts(const std::vector<ParameterBreak>& breaks, double period, double low, double high) {
    std::vector<double> result{low};
    const double least = 1e-12 * (high - low);
    std::vector<double> at;
    for (const ParameterBreak& b : breaks) {
      double t = b.at;
      if (period > 0) t -= std::floor((t - low) / period) * period;
      for (; t < high; t += period) {
        at.push_back(t);
        if (period <= 0) break;
      }
    }
    std::sort(at.begin(), at.end());
    for (const double t : at)
      if (t > result.back() + least && t < high - least) result.push_back(t);
    result.push_back(high);
    return result;
  }

  void split(double u0, double u1, double v0, double v1, int depth) {
    if (context_.cancelled()) return;
    const TrimRegion::Side side = region_.classify(u0, u1, v0, v1);
    if (side == TrimRegion::Side::outside) return;
    SurfacePatch patch;
    patch.u = (u0 + u1) / 2;
    patch.v = (v0 + v1) / 2;
    patch.half_u = (u1 - u0) / 2;
    patch.half_v = (v1 - v0) / 2;
    patch.face = position_;
    patch.inside = side == TrimRegion::Side::inside;
    patch.closed_form = closed_form_;
    const Local s = evaluate(patch, surface_, 0, 0);
    patch.center = s.p;
    const SurfaceBounds bounds = proven(u0, u1, v0, v1, s, patch);
    const Certificate whole(s, bounds, patch.half_u, patch.half_v, diagonal_);
    const double la = whole.first[0], lb = whole.first[1];
    const double remainder = whole.second[0] / 2 + whole.second[1] + whole.second[2] / 2;
    const bool flat = remainder <= 0.1 * std::max(la, lb);
    const bool good = flat && (closed_form_ || whole.holds());
    const bool too_long = std::max(la, lb) > diagonal_ / 24;
    const bool crowded = out_.size() - begin_ > 100000;
    if ((too_long || (!good && !crowded)) && depth < 60) {
      // The half that is better to have, told from the bounds of the whole.
      bool in_a = la >= lb;
      if (!too_long && closed_form_)
        in_a = whole.second[0] > whole.second[2] || (whole.second[0] == whole.second[2] && la >= lb);
      if (!too_long && !closed_form_) {
        const Local half_a{s.p, s.a / 2.0, s.b, s.aa / 4.0, s.ab / 2.0, s.bb};
        const Local half_b{s.p, s.a, s.b / 2.0, s.aa, s.ab / 2.0, s.bb / 4.0};
        in_a = Certificate(half_a, bounds, patch.half_u / 2, patch.half_v, diagonal_).badness() <
               Certificate(half_b, bounds, patch.half_u, patch.half_v / 2, diagonal_).badness();
      }
      const double least = diagonal_ / 2000;
      if ((in_a ? la : lb) < least && (in_a ? lb : la) > least) in_a = !in_a;
      if (too_long || (in_a ? la : lb) > least) {
        if (in_a) {
          split(u0, patch.u, v0, v1, depth + 1);
          split(patch.u, u1, v0, v1, depth + 1);
        } else {
          split(u0, u1, v0, patch.v, depth + 1);
          split(u0, u1, patch.v, v1, depth + 1);
        }
        return;
      }
    }
    for (int k = 0; k < 2; ++k) patch.first[k] = round_up(whole.first[k]);
    for (int k = 0; k < 3; ++k) {
      patch.second[k] = round_up(whole.second[k]);
      patch.e0[k] = round_up(whole.e0[k] * (1 + 1e-6));
      patch.e1[k] = round_up(whole.e1[k] * (1 + 1e-6));
    }
    orient(patch, s, remainder);
    out_.push_back(patch);
  }

  // Where nothing is proven (an offset beside a pole of its base), samples stand in with a wide margin.
  SurfaceBounds proven(double u0, double u1, double v0, double v1, const Local& s, const SurfacePatch& patch) const {
    SurfaceBounds b = surface_.bounds(u0, u1, v0, v1);
    if (std::isfinite(b.du + b.dv + b.duu + b.duv + b.dvv)) return b;
    double most[5] = {s.a.norm(), s.b.norm(), s.aa.norm(), s.ab.norm(), s.bb.norm()};
    for (int i = -2; i <= 2; ++i) {
      for (int j = -2; j <= 2; ++j) {
        const Local x = evaluate(patch, surface_, i * 0.49, j * 0.49);
        const double at[5] = {x.a.norm(), x.b.norm(), x.aa.norm(), x.ab.norm(), x.bb.norm()};
        for (int k = 0; k < 5; ++k)
          if (std::isfinite(at[k])) most[k] = std::max(most[k], at[k]);
      }
    }
    const double hu = patch.half_u, hv = patch.half_v;
    b.du = 2 * most[0] / hu;
    b.dv = 2 * most[1] / hv;
    b.duu = 2 * most[2] / (hu * hu);
    b.duv = 2 * most[3] / (hu * hv);
    b.dvv = 2 * most[4] / (hv * hv);
    b.duuu = b.duuv = b.duvv = b.dvvv = SurfaceBounds::unknown;
    return b;
  }

  static void orient(SurfacePatch& patch, const Local& s, double remainder) {
    // The longer tangent first; at a pole any frame that holds it will do.
    const Vec3& longer = (s.a | s.a) >= (s.b | s.b) ? s.a : s.b;
    const Vec3& other = &longer == &s.a ? s.b : s.a;
    Vec3 e[3];
    const double length = longer.norm();
    e[0] = length > 0 ? longer / length : Vec3(1, 0, 0);
    Vec3 across = other - e[0] * (other | e[0]);
    if (!(across.norm() > 1e-9 * length)) {
      const int least = std::abs(e[0][0]) <= std::abs(e[0][1]) && std::abs(e[0][0]) <= std::abs(e[0][2]) ? 0
                        : std::abs(e[0][1]) <= std::abs(e[0][2])                                         ? 1
                                                                                                         : 2;
      Vec3 unit(0, 0, 0);
      unit[least] = 1;
      across = unit - e[0] * e[0][least];
    }
    e[1] = across.normalized();
    e[2] = e[0] % e[1];
    const double pad = 1e-6 * (s.a.norm() + s.b.norm());
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c) patch.axis[k][c] = static_cast<float>(e[k][c]);
      patch.half[k] = round_up(std::abs(s.a | e[k]) + std::abs(s.b | e[k]) + remainder + pad);
    }
    const double aa = s.a | s.a, ab = s.a | s.b, bb = s.b | s.b, determinant = aa * bb - ab * ab;
    for (int c = 0; c < 3; ++c) {
      const bool regular = determinant > 1e-12 * aa * bb;
      patch.seed[0][c] = regular ? static_cast<float>((bb * s.a[c] - ab * s.b[c]) / determinant) : 0;
      patch.seed[1][c] = regular ? static_cast<float>((aa * s.b[c] - ab * s.a[c]) / determinant) : 0;
    }
  }

  const Surface& surface_;
  const TrimRegion& region_;
  std::uint32_t position_;
  double diagonal_;
  const Context& context_;
  std::vector<SurfacePatch>& out_;
  std::size_t begin_;
  bool closed_form_ = false;
};

}  // namespace

Box SurfacePatch::box() const {
  Vec3 reach;
  for (int c = 0; c < 3; ++c) {
    reach[c] = 0;
    for (int k = 0; k < 3; ++k) reach[c] += std::abs(static_cast<double>(axis[k][c])) * half[k];
    reach[c] *= 1 + 1e-6;
  }
  return {center - reach, center + reach};
}

void make_patches(const CadFace& face, const TrimRegion& region, std::uint32_t position, double diagonal,
                  const Context& context, std::vector<SurfacePatch>& patches) {
  PatchBuilder(face, region, position, diagonal, context, patches).run();
}

void closest_on_patch(const SurfacePatch& patch, std::uint32_t index, const Surface& surface, const TrimRegion& region,
                      const Vec3& p, double tolerance, FootCandidate& best) {
  const Vec3 d = p - patch.center;
  const double a = patch.seed[0][0] * d[0] + patch.seed[0][1] * d[1] + patch.seed[0][2] * d[2];
  const double b = patch.seed[1][0] * d[0] + patch.seed[1][1] * d[1] + patch.seed[1][2] * d[2];
  const Minimum m = minimise(patch, surface, p, {-1, 1, -1, 1}, a, b);
  offer(patch, index, region, p, m.a, m.b, m.foot, m.normal, best);
  if (!convex(patch, m.last, 1)) branch(patch, index, surface, region, p, tolerance, best);
}

void closest_in_closed_form(const Surface& surface, const TrimRegion& region, std::uint32_t face, std::uint32_t index,
                            const Vec3& p, FootCandidate& best) {
  Vec2 feet[2];
  const int n = surface.closest(p, feet);
  for (int k = 0; k < n; ++k) {
    const Vec3 foot = surface.point(feet[k][0], feet[k][1]);
    const double distance = (foot - p).norm();
    if (!best.yields_to(distance, false, face, index)) continue;
    Vec2 uv = feet[k];
    if (!region.locate(uv)) continue;
    best.distance = distance;
    best.foot = foot;
    best.uv = uv;
    best.normal = Vec3(0, 0, 0);
    best.face = face;
    best.item = index;
    best.on_curve = best.boundary = false;
  }
}

}  // namespace tri

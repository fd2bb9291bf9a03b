#include "libtri/surfaces/swept_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libtri/surfaces/third_order.hpp"
#include "meshops/error.hpp"

namespace tri {

namespace {

class Revolution final : public ThirdOrderSurface {
 public:
  Revolution(std::shared_ptr<const Curve3> profile, const Vec3& origin, const Vec3& axis)
      : profile_(std::move(profile)), origin_(origin), axis_(axis) {}

  Vec3 point(double u, double v) const override { return origin_ + Turn(u, *this)(profile_->point(v) - origin_); }
  SurfacePoint evaluate(double u, double v) const override {
    const CurvePoint3 c = profile_->evaluate(v);
    const Turn turn(u, *this);
    const Vec3 p = turn(c.p - origin_), d = turn(c.d);
    const Vec3 du = axis_ % p;
    return {origin_ + p, du, d, axis_ % du, axis_ % d, turn(c.dd)};
  }
  void third_derivatives(double u, double v, Vec3 out[4]) const override {
    const CurvePoint3 c = profile_->evaluate(v);
    const Turn turn(u, *this);
    out[0] = -(axis_ % turn(c.p - origin_));
    out[1] = axis_ % (axis_ % turn(c.d));
    out[2] = axis_ % turn(c.dd);
    out[3] = turn(profile_->third_derivative(v));
  }
  double u_period() const override { return 2 * std::numbers::pi; }
  double v_period() const override { return profile_->period(); }
  std::vector<ParameterBreak> v_breaks() const override { return profile_->breaks(); }
  SurfaceBounds bounds(double, double, double v0, double v1) const override {
    const CurveBounds<Vec3> b = profile_->bounds(v0, v1);
    const double d = b.d.norm(), dd = b.dd.norm(), ddd = b.ddd.norm();
    const double r = (axis_ % (profile_->point((v0 + v1) / 2) - origin_)).norm() + d * (v1 - v0) / 2;
    return {r, d, r, d, dd, r, d, dd, ddd};
  }

 private:
  struct Turn {
    Turn(double u, const Revolution& s) : cos(std::cos(u)), sin(std::sin(u)), axis(s.axis_) {}
    Vec3 operator()(const Vec3& x) const {
      const Vec3 along = axis * (axis | x);
      return along + (x - along) * cos + (axis % x) * sin;
    }
    double cos, sin;
    const Vec3& axis;
  };

  std::shared_ptr<const Curve3> profile_;
  Vec3 origin_, axis_;
};

class Extrusion final : public ThirdOrderSurface {
 public:
  Extrusion(std::shared_ptr<const Curve3> profile, const Vec3& direction)
      : profile_(std::move(profile)), direction_(direction) {}

  Vec3 point(double u, double v) const override { return profile_->point(u) + direction_ * v; }
  SurfacePoint evaluate(double u, double v) const override {
    const CurvePoint3 c = profile_->evaluate(u);
    const Vec3 zero(0, 0, 0);
    return {c.p + direction_ * v, c.d, direction_, c.dd, zero, zero};
  }
  void third_derivatives(double u, double, Vec3 out[4]) const override {
    out[0] = profile_->third_derivative(u);
    out[1] = out[2] = out[3] = Vec3(0, 0, 0);
  }
  double u_period() const override { return profile_->period(); }
  std::vector<ParameterBreak> u_breaks() const override { return profile_->breaks(); }
  SurfaceBounds bounds(double u0, double u1, double, double) const override {
    const CurveBounds<Vec3> b = profile_->bounds(u0, u1);
    return {b.d.norm(), 1, b.dd.norm(), 0, 0, b.ddd.norm(), 0, 0, 0};
  }

 private:
  std::shared_ptr<const Curve3> profile_;
  Vec3 direction_;
};

class OffsetSurface final : public Surface {
 public:
  OffsetSurface(std::shared_ptr<const ThirdOrderSurface> base, double distance)
      : base_(std::move(base)), distance_(distance) {}

  Vec3 point(double u, double v) const override {
    const SurfacePoint s = base_->evaluate(u, v);
    return s.p + (s.du % s.dv).normalized() * distance_;
  }
  SurfacePoint evaluate(double u, double v) const override {
    const SurfacePoint s = base_->evaluate(u, v);
    Vec3 t[4];
    base_->third_derivatives(u, v, t);
    const Vec3 m = s.du % s.dv;
    const double length = m.norm();
    const Vec3 n = m / length;
    const Vec3 mu = s.duu % s.dv + s.du % s.duv, mv = s.duv % s.dv + s.du % s.dvv;
    const Vec3 muu = t[0] % s.dv + (s.duu % s.duv) * 2.0 + s.du % t[1];
    const Vec3 muv = t[1] % s.dv + s.duu % s.dvv + s.du % t[2];
    const Vec3 mvv = t[2] % s.dv + (s.duv % s.dvv) * 2.0 + s.du % t[3];
    const double lu = n | mu, lv = n | mv;
    const Vec3 nu = (mu - n * lu) / length, nv = (mv - n * lv) / length;
    const auto second = [&](const Vec3& mab, const Vec3& ma, const Vec3& na, double la, const Vec3& nb, double lb) {
      const double lab = (n | mab) + (nb | ma);
      return (mab - na * lb - nb * la - n * lab) / length;
    };
    const double o = distance_;
    return {s.p + n * o,
            s.du + nu * o,
            s.dv + nv * o,
            s.duu + second(muu, mu, nu, lu, nu, lu) * o,
            s.duv + second(muv, mu, nu, lu, nv, lv) * o,
            s.dvv + second(mvv, mv, nv, lv, nv, lv) * o};
  }
  double u_period() const override { return base_->u_period(); }
  double v_period() const override { return base_->v_period(); }
  std::vector<ParameterBreak> u_breaks() const override { return rougher(base_->u_breaks()); }
  std::vector<ParameterBreak> v_breaks() const override { return rougher(base_->v_breaks()); }
  SurfaceBounds bounds(double u0, double u1, double v0, double v1) const override {
    const SurfaceBounds b = base_->bounds(u0, u1, v0, v1);
    const SurfacePoint s = base_->evaluate((u0 + u1) / 2, (v0 + v1) / 2);
    const double mu = b.duu * b.dv + b.du * b.duv, mv = b.duv * b.dv + b.du * b.dvv;
    const double shortest = (s.du % s.dv).norm() - mu * (u1 - u0) / 2 - mv * (v1 - v0) / 2;
    if (!(shortest > 0)) return {};
    const double muu = b.duuu * b.dv + 2 * b.duu * b.duv + b.du * b.duuv;
    const double muv = b.duuv * b.dv + b.duu * b.dvv + b.du * b.duvv;
    const double mvv = b.duvv * b.dv + 2 * b.duv * b.dvv + b.du * b.dvvv;
    const double ru = mu / shortest, rv = mv / shortest, o = std::abs(distance_);
    SurfaceBounds out;
    out.du = b.du + o * ru;
    out.dv = b.dv + o * rv;
    out.duu = b.duu + o * (2 * muu / shortest + 5 * ru * ru);
    out.duv = b.duv + o * (2 * muv / shortest + 5 * ru * rv);
    out.dvv = b.dvv + o * (2 * mvv / shortest + 5 * rv * rv);
    return out;
  }

 private:
  static std::vector<ParameterBreak> rougher(std::vector<ParameterBreak> breaks) {
    for (ParameterBreak& b : breaks) b.continuity = std::max(0, b.continuity - 1);
    return breaks;
  }

  std::shared_ptr<const ThirdOrderSurface> base_;
  double distance_;
};

}  // namespace

std::shared_ptr<const Surface> make_revolution(std::shared_ptr<const Curve3> profile, const Vec3& origin,
                                               const Vec3& axis) {
  return std::make_shared<Revolution>(std::move(profile), origin, axis);
}

std::shared_ptr<const Surface> make_extrusion(std::shared_ptr<const Curve3> profile, const Vec3& direction) {
  return std::make_shared<Extrusion>(std::move(profile), direction);
}

std::shared_ptr<const Surface> make_offset_surface(std::shared_ptr<const Surface> base, double distance) {
  auto third = std::dynamic_pointer_cast<const ThirdOrderSurface>(base);
  if (!third) throw CadError("offset of a surface without third derivatives");
  return std::make_shared<OffsetSurface>(std::move(third), distance);
}

}  // namespace tri

#include "libtri/model/face_measure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tri {
namespace {

// Gauss-Legendre on [0,1].
constexpr std::array<double, 5> gauss5_x{0.04691007703066802, 0.23076534494715845, 0.5, 0.76923465505284155,
                                         0.95308992296933198};
constexpr std::array<double, 5> gauss5_w{0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                         0.23931433524968324, 0.11846344252809454};

double area_element(const Surface& surface, double u, double v) {
  const SurfacePoint s = surface.evaluate(u, v);
  return (s.du % s.dv).norm();
}

/// The area element from u0 to u1 (either order) at v, smooth piece by smooth piece.
double row_integral(const Surface& surface, const std::vector<double>& breaks, double u0, double u1, double v) {
  const double low = std::min(u0, u1), high = std::max(u0, u1);
  double sum = 0, from = low;
  const auto add = [&](double to) {
    for (std::size_t k = 0; k < gauss5_x.size(); ++k)
      sum += gauss5_w[k] * (to - from) * area_element(surface, from + gauss5_x[k] * (to - from), v);
    from = to;
  };
  for (auto it = std::upper_bound(breaks.begin(), breaks.end(), low); it != breaks.end() && *it < high; ++it) add(*it);
  if (from < high) add(high);
  return u0 <= u1 ? sum : -sum;
}

/// Parameter between t0 and t1 where the curve reaches height v, which lies between those of its ends.
double parameter_at(const Curve2& curve, double t0, double t1, double v) {
  const bool rising = curve.point(t0)[1] < v;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (t0 + t1);
    ((curve.point(middle)[1] < v) == rising ? t0 : t1) = middle;
  }
  return 0.5 * (t0 + t1);
}

}  // namespace

double area_share(const Surface& surface, const SurfaceBreaks& breaks, const Curve2& curve,
                  const ParameterPolyline& line, double u_start) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < line.parameters.size(); ++i) {
    const double v0 = line.points[i][1], v1 = line.points[i + 1][1];
    if (v0 == v1 && curve.evaluate(0.5 * (line.parameters[i] + line.parameters[i + 1])).d[1] == 0) continue;
    std::vector<double> cuts{line.parameters[i]};
    const auto first = std::upper_bound(breaks.v.begin(), breaks.v.end(), std::min(v0, v1));
    for (auto it = first; it != breaks.v.end() && *it < std::max(v0, v1); ++it)
      cuts.push_back(parameter_at(curve, line.parameters[i], line.parameters[i + 1], *it));
    if (v0 > v1) std::reverse(cuts.begin() + 1, cuts.end());
    cuts.push_back(line.parameters[i + 1]);
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c)
      for (std::size_t k = 0; k < gauss5_x.size(); ++k) {
        const double length = cuts[c + 1] - cuts[c];
        const CurvePoint2 at = curve.evaluate(cuts[c] + gauss5_x[k] * length);
        if (at.d[1] == 0) continue;
        sum += gauss5_w[k] * length * at.d[1] * row_integral(surface, breaks.u, u_start, at.p[0], at.p[1]);
      }
  }
  return sum;
}

bool inside_loops(const CadFace& face, const Vec2& uv) {
  bool inside = false;
  for (const TrimLoop& loop : face.loops) {
    const Vec2* previous = &loop.coedges.back().polyline.back();
    for (const Coedge& coedge : loop.coedges)
      for (const Vec2& b : coedge.polyline) {
        const Vec2& a = *previous;
        previous = &b;
        if ((a[1] > uv[1]) == (b[1] > uv[1])) continue;
        if (uv[0] < (b[0] - a[0]) * (uv[1] - a[1]) / (b[1] - a[1]) + a[0]) inside = !inside;
      }
  }
  return inside;
}

void extend_box(const CadFace& face, const SurfaceBreaks& breaks, Vec3& box_min, Vec3& box_max) {
  if (face.surface_type == "plane") return;  // reaches no farther than its loops
  const auto count = [](std::size_t inner_breaks) {
    return std::clamp<int>(3 * static_cast<int>(inner_breaks + 1), 12, 60);
  };
  const int nu = count(breaks.u.size()), nv = count(breaks.v.size());
  const double du = (face.u_max - face.u_min) / nu, dv = (face.v_max - face.v_min) / nv;
  struct Best {
    double value = -1e300;
    Vec2 uv{0, 0};
  };
  std::array<Best, 6> best;  // +x, -x, +y, ...
  const auto reach = [](const Vec3& p, int direction) {
    return direction % 2 == 0 ? p[direction / 2] : -p[direction / 2];
  };
  double cell = 0;
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) {
      const Vec2 uv(face.u_min + (i + 0.5) * du, face.v_min + (j + 0.5) * dv);
      const SurfacePoint s = face.surface->evaluate(uv[0], uv[1]);
      cell = std::max(cell, s.du.norm() * du + s.dv.norm() * dv);
      bool beats = false;
      for (int d = 0; d < 6; ++d) beats = beats || reach(s.p, d) > best[d].value;
      if (!beats || !inside_loops(face, uv)) continue;
      for (int d = 0; d < 6; ++d)
        if (reach(s.p, d) > best[d].value) best[d] = {reach(s.p, d), uv};
    }
  for (int d = 0; d < 6; ++d) {
    const double bound = d % 2 == 0 ? box_max[d / 2] : -box_min[d / 2];
    if (best[d].value + cell < bound) continue;
    // Compass search inside the loops, from the best sample.
    double step = 1;
    while (step > 1e-6) {
      bool moved = false;
      for (const Vec2& way :
           {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1), Vec2(1, 1), Vec2(-1, -1), Vec2(1, -1), Vec2(-1, 1)}) {
        const Vec2 uv(best[d].uv[0] + step * way[0] * du, best[d].uv[1] + step * way[1] * dv);
        const double value = reach(face.surface->point(uv[0], uv[1]), d);
        if (value <= best[d].value || !inside_loops(face, uv)) continue;
        best[d] = {value, uv};
        moved = true;
        break;
      }
      if (!moved) step *= 0.5;
    }
    if (best[d].value <= bound) continue;
    (d % 2 == 0 ? box_max : box_min)[d / 2] = d % 2 == 0 ? best[d].value : -best[d].value;
  }
}

}  // namespace tri

#include "libtri/model/outward_normals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tri {

namespace {

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? v / length : Vec3(0, 0, 0);
}

// Direction in space in which the loop runs at one end of a coedge; chords stand in where the derivative vanishes.
Vec3 direction(const CadFace& face, const Coedge& coedge, bool at_begin) {
  const bool forward = !coedge.reversed;
  const double span = coedge.last - coedge.first;
  const double t = (at_begin == forward) ? coedge.first : coedge.last;
  const CurvePoint3 e = on_surface(*face.surface, *coedge.pcurve, t);
  Vec3 d = e.d;
  const double inward = t == coedge.first ? 1e-4 * span : -1e-4 * span;
  const Vec3 chord = (on_surface(*face.surface, *coedge.pcurve, t + inward).p - e.p) / inward;
  if (!(d.norm() > 1e-3 * chord.norm())) d = chord;
  return unit(forward ? d : -d);
}

}  // namespace

Vec3 outward_normal(const CadFace& face, const TrimRegion& region, const Vec2& uv) {
  const Vec2 size(region.u_max() - region.u_min(), region.v_max() - region.v_min());
  const Vec2 middle((region.u_max() + region.u_min()) / 2, (region.v_max() + region.v_min()) / 2);
  Vec3 best(0, 0, 0);
  for (double step = 0; step < 0.1; step = step == 0 ? 1e-6 : step * 10) {
    const Vec2 at = uv + (middle - uv) * step;
    const SurfacePoint s = face.surface->evaluate(at[0], at[1]);
    const Vec3 n = s.du % s.dv;
    const double length = n.norm(), lu = s.du.norm(), lv = s.dv.norm();
    if (!(length > 0) || !std::isfinite(length)) continue;
    best = n / length;
    // Both tangents must be more than what rounding leaves of a vanishing one, and not parallel.
    const bool regular =
        lu * size[0] > 1e-7 * lv * size[1] && lv * size[1] > 1e-7 * lu * size[0] && length > 1e-7 * lu * lv;
    if (regular) break;
  }
  return face.reversed ? -best : best;
}

PseudoNormals::PseudoNormals(const CadModel& model, const std::vector<TrimRegion>& regions,
                             const std::vector<FaceCurve>& curves)
    : uses_(model.edges.size()), poles_(curves.size(), Vec3(0, 0, 0)) {
  int most = static_cast<int>(model.vertices.size());
  for (const CadEdge& e : model.edges) most = std::max({most, e.start_vertex + 1, e.end_vertex + 1});
  vertices_.assign(most, Vec3(0, 0, 0));
  for (std::uint32_t i = 0; i < curves.size(); ++i) {
    const FaceCurve& c = curves[i];
    if (c.edge >= 0) uses_[c.edge].push_back(i);
    if (!c.point) continue;
    constexpr int samples = 32;
    for (int k = 0; k < samples; ++k) {
      const double t = c.first + (c.last - c.first) * (k + 0.5) / samples;
      poles_[i] += outward_normal(model.faces[c.face], regions[c.face], c.pcurve->point(t));
    }
    poles_[i] /= samples;
  }
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const CadFace& face = model.faces[f];
    for (const TrimLoop& loop : face.loops) {
      const std::size_t n = loop.coedges.size();
      for (std::size_t i = 0; i < n; ++i) {
        const Coedge &in = loop.coedges[i], &out = loop.coedges[(i + 1) % n];
        const CadEdge& edge = model.edges[in.edge];
        const int vertex = in.reversed ? edge.start_vertex : edge.end_vertex;
        if (vertex < 0 || edge.degenerate || model.edges[out.edge].degenerate) continue;
        const Vec2 uv = out.pcurve->point(out.reversed ? out.last : out.first);
        Vec3 n1 = outward_normal(face, regions[f], uv);
        const Vec3 upward = face.reversed ? -n1 : n1;  // the material lies left of the loop about du x dv
        const Vec3 a = direction(face, out, true), b = -direction(face, in, false);
        double angle = std::atan2(upward | (a % b), a | b);
        if (angle <= 1e-9) angle += 2 * std::numbers::pi;
        if (n == 1 && std::abs(angle - 2 * std::numbers::pi) < 1e-6) angle = std::numbers::pi;
        vertices_[vertex] += n1 * angle;
      }
    }
  }
}

Vec3 PseudoNormals::at(const CadModel& model, const std::vector<TrimRegion>& regions,
                       const std::vector<FaceCurve>& curves, std::uint32_t index, double t) const {
  const FaceCurve& c = curves[index];
  if (c.point) return poles_[index];
  Vec3 sum(0, 0, 0);
  if (c.edge < 0 || !c.boundary) return outward_normal(model.faces[c.face], regions[c.face], c.pcurve->point(t));
  const double share = (t - c.first) / (c.last - c.first);
  const CadEdge& edge = model.edges[c.edge];
  const int vertex = share < 1e-9 ? edge.start_vertex : share > 1 - 1e-9 ? edge.end_vertex : -1;
  if (vertex >= 0 && vertices_[vertex].norm() > 1e-9) return vertices_[vertex];
  for (const std::uint32_t use : uses_[c.edge]) {
    const FaceCurve& other = curves[use];
    sum += outward_normal(model.faces[other.face], regions[other.face],
                          other.pcurve->point(other.first + share * (other.last - other.first)));
  }
  return sum;
}

}  // namespace tri

#include "libtri/alignment/rim.hpp"

#include <algorithm>
#include <cmath>

#include "libtri/quiet_context.hpp"

namespace tri {
namespace {

constexpr double spacing = 1e-3;       // of the diagonal
constexpr double beyond = 1e-3;        // of the diagonal: the surface ends if there is nothing so far over the edge
constexpr double still_surface = 0.5;  // of that step
constexpr int coarse_steps = 32, most_steps = 4000;
constexpr std::size_t most_near = 8;

}  // namespace

Rim::Rim(const CadModel& model, const Registration& registration, const Context& context) {
  std::vector<Place> all;
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const CadFace& face = model.faces[f];
    for (const TrimLoop& loop : face.loops) {
      for (const Coedge& coedge : loop.coedges) {
        context.checkpoint();
        const CadEdge& edge = model.edges[static_cast<std::size_t>(coedge.edge)];
        if (edge.degenerate || (edge.faces.size() == 2 && edge.faces[0] == edge.faces[1])) continue;
        const auto uv = [&](double share) {
          return coedge.pcurve->evaluate(coedge.first + share * (coedge.last - coedge.first));
        };
        double length = 0;
        Vec3 last(0, 0, 0);
        for (int i = 0; i <= coarse_steps; ++i) {
          const Vec2 at = uv(static_cast<double>(i) / coarse_steps).p;
          const Vec3 p = face.surface->point(at[0], at[1]);
          if (i > 0) length += (p - last).norm();
          last = p;
        }
        const int steps = static_cast<int>(std::clamp(length / (spacing * model.diagonal), 1.0, double{most_steps}));
        for (int i = 0; i < steps; ++i) {
          const CurvePoint2 c = uv((i + 0.5) / steps);
          const SurfacePoint s = face.surface->evaluate(c.p[0], c.p[1]);
          const Vec3 normal = s.du % s.dv;
          // The material lies to the left of the loop in (u,v).
          const Vec3 inward = normal % (s.du * c.d[0] + s.dv * c.d[1]) * (coedge.reversed ? -1.0 : 1.0);
          if (!(normal.norm() > 0) || !(inward.norm() > 0) || !std::isfinite(s.p.sqrnorm() + inward.sqrnorm()))
            continue;
          all.push_back({s.p, inward / inward.norm(), normal / (face.reversed ? -normal.norm() : normal.norm()),
                         static_cast<std::int32_t>(f)});
        }
      }
    }
  }
  std::vector<Vec3> over;
  for (const Place& place : all) over.push_back(place.point - place.inward * (beyond * model.diagonal));
  QuietContext quiet(context, context.threads);
  const std::vector<Foot> feet = registration.register_points(over, quiet);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (std::abs(feet[i].deviation) > still_surface * beyond * model.diagonal) places_.push_back(all[i]);
  for (const Place& place : places_) points_.push_back(place.point);
  if (!points_.empty()) tree_.emplace(points_);
}

const Rim::Place* Rim::near(const Vec3& p, std::int32_t face, double reach) const {
  if (!tree_) return nullptr;
  std::vector<NearestPoints::Neighbor> found;
  tree_->nearest(p, most_near, found);
  const Place* best = nullptr;
  double least = 0;
  for (const auto& n : found) {
    const Place& place = places_[n.index];
    if (n.squared_distance > reach * reach) break;
    if (face >= 0) {
      if (place.face == face) return &place;
      continue;
    }
    const double off = std::abs((p - place.point) | place.normal);
    if (best && off >= least) continue;
    best = &place;
    least = off;
  }
  return best;
}

}  // namespace tri

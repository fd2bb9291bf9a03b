#pragma once

#include <random>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/model/trim_region.hpp"

namespace tri::test {

inline std::vector<Vec3> random_points(int n, const Vec3& low, const Vec3& high, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Vec3> points(n);
  for (Vec3& p : points)
    for (int c = 0; c < 3; ++c) p[c] = low[c] + share(random) * (high[c] - low[c]);
  return points;
}

// Points inside and around the model's box, the greater part close by.
inline std::vector<Vec3> points_around(const CadModel& model, int n, unsigned seed) {
  const Vec3 grow = (model.box_max - model.box_min) * 0.3 + Vec3(1, 1, 1) * (0.02 * model.diagonal);
  return random_points(n, model.box_min - grow, model.box_max + grow, seed);
}

// Points at a normal distance of up to `reach` from random places of the faces.
inline std::vector<Vec3> points_near(const CadModel& model, int n, double reach, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Vec3> points;
  std::vector<TrimRegion> regions;
  for (const CadFace& face : model.faces) regions.emplace_back(face);
  while (static_cast<int>(points.size()) < n) {
    const std::size_t f = random() % model.faces.size();
    const TrimRegion& r = regions[f];
    const double u = r.u_min() + share(random) * (r.u_max() - r.u_min()),
                 v = r.v_min() + share(random) * (r.v_max() - r.v_min());
    if (!r.contains(u, v) && random() % 50 != 0) continue;
    const SurfacePoint s = model.faces[f].surface->evaluate(u, v);
    const Vec3 normal = s.du % s.dv;
    if (!(normal.norm() > 0)) continue;
    points.push_back(s.p + normal.normalized() * (reach * (2 * share(random) - 1)));
  }
  return points;
}

}  // namespace tri::test

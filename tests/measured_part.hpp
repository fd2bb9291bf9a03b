#pragma once

#include <map>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/registration.hpp"
#include "libtri/sampling/virtual_measurement.hpp"

namespace tri::test {

/// A model and points measured on it; the truth of the measurement stands in for the registration.
struct MeasuredPart {
  CadModel model;
  VirtualMeasurement measurement;
  std::vector<Foot> feet;  ///< of the true places; one per point, in their order
};

inline std::vector<Foot> true_feet(const CadModel& model, const VirtualMeasurement& m) {
  std::map<int, int> position;
  for (std::size_t f = 0; f < model.faces.size(); ++f) position[model.faces[f].index] = static_cast<int>(f);
  std::vector<Foot> feet;
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    const TruePoint& t = m.truth[i];
    Foot foot;
    foot.point = t.point;
    foot.uv = t.uv;
    foot.face = position.at(t.face);
    for (int k = 0; k < 3; ++k) foot.normal[k] = static_cast<float>(t.normal[k]);
    foot.deviation = (m.points[i] - t.point) | t.normal;
    feet.push_back(foot);
  }
  return feet;
}

inline MeasuredPart measured_part(const Shape& shape, const MeasurementOptions& options) {
  Context context;
  MeasuredPart part{make_cad_model(shape), measure(shape, options, context), {}};
  part.feet = true_feet(part.model, part.measurement);
  return part;
}

/// A foot at (u,v) of a face.
inline Foot foot_at(const CadModel& model, int face, const Vec2& uv) {
  Foot foot;
  const SurfacePoint s = model.faces[static_cast<std::size_t>(face)].surface->evaluate(uv[0], uv[1]);
  Vec3 n = s.du % s.dv;
  if (n.norm() > 0) n *= (model.faces[static_cast<std::size_t>(face)].reversed ? -1.0 : 1.0) / n.norm();
  foot.point = s.p;
  foot.uv = uv;
  foot.face = face;
  for (int k = 0; k < 3; ++k) foot.normal[k] = static_cast<float>(n[k]);
  return foot;
}

}  // namespace tri::test

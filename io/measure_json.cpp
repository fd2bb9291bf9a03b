#include "io/measure_json.hpp"

namespace tri {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const OneSidedDistance& d) {
  return {{"vertices", d.vertices.size()},
          {"area", d.area},
          {"samples", d.samples},
          {"mean", d.mean},
          {"mean_error", d.mean_error},
          {"rms", d.rms},
          {"max", d.max},
          {"max_bound", d.max_bound},
          {"place", point_json(d.place)},
          {"foot", point_json(d.foot)}};
}

}  // namespace

Json statistics_json(const ValueStatistics& s, bool tolerance) {
  Json json{{"points", s.count}};
  const auto number = [&](const char* key, double value) { json[key] = s.count > 0 ? Json(value) : Json(nullptr); };
  number("mean", s.mean);
  number("rms", s.rms);
  number("standard_deviation", s.standard_deviation);
  number("min", s.min);
  number("p5", s.p5);
  number("median", s.median);
  number("p95", s.p95);
  number("max", s.max);
  json["min_index"] = s.count > 0 ? Json(s.min_index) : Json(nullptr);
  json["max_index"] = s.count > 0 ? Json(s.max_index) : Json(nullptr);
  if (tolerance) {
    json["in_tolerance"] = s.in_tolerance;
    number("share_in_tolerance", static_cast<double>(s.in_tolerance) / static_cast<double>(s.count));
  }
  return json;
}

Json point_json(const Vec3& p) {
  return {p[0], p[1], p[2]};
}

Json to_json(const MeshDistance& d) {
  return {{"hausdorff", d.hausdorff},      {"hausdorff_bound", d.hausdorff_bound}, {"mean", d.mean}, {"rms", d.rms},
          {"forward", to_json(d.forward)}, {"backward", to_json(d.backward)}};
}

}  // namespace tri

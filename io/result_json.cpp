#include "io/result_json.hpp"

#include <array>

namespace tri {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

Json to_json(const FitQuality& q, double coverage) {
  return {{"rms", q.rms},
          {"sigma", q.sigma},
          {"median", q.median},
          {"inlier_share", q.inlier_share},
          {"near_share", q.near_share},
          {"coherent_share", q.coherent_share},
          {"systematic", q.systematic},
          {"coverage", coverage}};
}

const char* name_of(Freedom::Kind kind) {
  constexpr std::array names{"slide", "turn", "screw", "swivel"};
  return names[static_cast<std::size_t>(kind)];
}

Json to_json(const SurfaceTopology& t) {
  return {{"components", t.components}, {"loops", t.loops}, {"euler", t.euler}};
}

Json unusable_json(const CadModel& model) {
  Json json = Json::array();
  for (const UnusableFace& f : model.unusable_faces)
    json.push_back({{"face", f.index}, {"name", f.name}, {"reason", f.reason}});
  return json;
}

}  // namespace

const char* name_of(Method method) {
  switch (method) {
    case Method::automatic:
      return "auto";
    case Method::patches:
      return "patches";
    case Method::shell:
      return "shell";
  }
  return "";
}

Json to_json(const AlignResult& r) {
  Json json{{"status", name_of(r.status)},
            {"pose", {{"matrix", r.pose.matrix()}, {"meaning", "takes the points to the model"}}},
            {"kept", r.kept},
            {"searched", r.searched},
            {"iterations", r.iterations},
            {"points_used", r.points_used},
            {"fit", to_json(r.quality, r.coverage)},
            {"information", r.information.eigenvalues},
            {"standard_deviation", r.information.standard_deviation},
            {"unit_factor", r.unit_factor}};
  json["not_fixed"] = Json::array();
  for (const Freedom& f : r.information.freedoms)
    json["not_fixed"].push_back({{"kind", name_of(f.kind)},
                                 {"axis", to_json(f.axis)},
                                 {"place", to_json(f.place)},
                                 {"pitch", f.pitch},
                                 {"words", f.in_words()}});
  json["badly_fixed"] = Json::array();
  for (const auto& weak : r.information.weak)
    json["badly_fixed"].push_back({{"words", weak.motion.in_words()}, {"standard_deviation", weak.standard_deviation}});
  json["alternatives"] = Json::array();
  for (const Alternative& a : r.alternatives)
    json["alternatives"].push_back(
        {{"words", a.words}, {"pose", {{"matrix", a.pose.matrix()}}}, {"fit", to_json(a.quality, a.coverage)}});
  json["reasons"] = r.reasons;
  json["notes"] = r.notes;
  json["seconds"] = Json::object();
  for (const auto& [step, seconds] : r.seconds) json["seconds"][step] = json["seconds"].value(step, 0.0) + seconds;
  return json;
}

Json to_json(const TriangulateResult& r, const CadModel& model) {
  Json json{{"vertices", r.mesh.n_vertices()},
            {"triangles", r.mesh.n_faces()},
            {"method", name_of(r.method)},
            {"method_reason", r.method_reason},
            {"sigma", r.sigma},
            {"outliers", r.outliers},
            {"duplicates", r.duplicates}};
  json["faces"] = Json::array();
  for (const FaceCoverage& f : r.faces)
    json["faces"].push_back(
        {{"face", f.face}, {"name", f.name}, {"points", f.points}, {"area", f.area}, {"method", f.method}});
  json["unmeasured_faces"] = r.unmeasured_faces;
  json["holes"] = Json::array();
  for (const UnmeasuredRegion& h : r.holes)
    json["holes"].push_back(
        {{"center", point_json(h.center)}, {"radius", h.radius}, {"spacing", h.spacing}, {"faces", h.faces}});
  json["unusable_faces"] = unusable_json(model);
  json["topology"] = {
      {"model", to_json(r.checks.model)}, {"mesh", to_json(r.checks.mesh)}, {"same", r.checks.model == r.checks.mesh}};
  json["checks"] = {{"self_intersections", r.checks.self_intersections},
                    {"folds", r.checks.folds},
                    {"turned", r.checks.turned},
                    {"bridging", r.checks.bridging},
                    {"bridging_share", r.checks.bridging_share},
                    {"unused_points", r.checks.unused_points}};
  json["seconds"] = Json::object();
  for (const auto& [step, seconds] : r.seconds) json["seconds"][step] = seconds;
  json["steps"] = Json::array();
  for (const Report& report : r.steps) json["steps"].push_back(to_json(report));
  json["notes"] = r.notes;
  return json;
}

Json to_json(const Deviations& d, const CadModel& model, const DeviationOptions& options) {
  const bool tolerance = options.tolerance.has_value();
  Json json{{"overall", statistics_json(d.overall, tolerance)}};
  json["faces"] = Json::array();
  for (const FaceDeviation& f : d.per_face) {
    Json face{{"face", f.face}, {"name", f.name}, {"surface", f.surface_type}, {"area", f.area}};
    face.update(statistics_json(f.statistics, tolerance));
    json["faces"].push_back(face);
  }
  json["far"] = {{"distance", nullptr}, {"points", d.far.size()}, {"indices", d.far}};
  if (options.max_distance) json["far"]["distance"] = *options.max_distance;
  json["worst"] = Json::array();
  for (const DeviationSpot& s : d.spots)
    json["worst"].push_back({{"point", s.point},
                             {"position", point_json(s.position)},
                             {"foot", point_json(s.foot)},
                             {"deviation", s.deviation},
                             {"face", s.face}});
  json["unusable_faces"] = unusable_json(model);
  return json;
}

}  // namespace tri

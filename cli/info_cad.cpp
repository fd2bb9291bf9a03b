#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "cli/info.hpp"
#include "cli/model_input.hpp"
#include "cli/program.hpp"
#include "libtri/model/cad_model.hpp"
#include "libtri/model/cad_topology.hpp"

namespace tri::cli {

Info cad_info(const std::string& path, double sew_tolerance, Context& context) {
  const CadFile file = read_cad_or_end(path, context);
  const CadModel model = make_cad_model(file.shape, sew_tolerance, context);
  const CadTopology topology = cad_topology(model);
  double area = 0, largest_tolerance = 0;
  std::map<std::string, int> types;
  auto faces = nlohmann::ordered_json::array();
  for (const CadFace& face : model.faces) {
    area += face.area;
    ++types[face.surface_type];
    faces.push_back({{"face", face.index},
                     {"name", face.name},
                     {"surface", face.surface_type},
                     {"area", face.area},
                     {"loops", face.loops.size()},
                     {"component", face.shell + 1}});
  }
  for (const CadEdge& edge : model.edges) largest_tolerance = std::max(largest_tolerance, edge.tolerance);

  Info info;
  info.json = {{"kind", "cad"},       {"format", file.format}, {"unit", file.unit},     {"unit_mm", file.unit_mm},
               {"faces", file.faces}, {"shells", file.shells}, {"solids", file.solids}, {"products", file.products}};
  info.line("CAD model", file.format);
  if (!file.unit.empty())
    info.line("unit", file.unit_mm == 1 ? file.unit
                                        : fmt::format("{} ({:.6g} mm); all below is in mm", file.unit, file.unit_mm));
  if (!file.products.empty()) info.line("products", fmt::format("{}", fmt::join(file.products, ", ")));
  info.line("faces",
            fmt::format("{} in {} solids, {} shells{}", file.faces, file.solids, file.shells,
                        file.solids == 0 && file.shells != 1 ? fmt::format(" (sewn at {} mm)", sew_tolerance) : ""));
  for (const auto& [type, count] : types) info.line("  " + type, fmt::format("{}", count));
  info.line("unusable faces", fmt::format("{}", model.unusable_faces.size() + file.failed.size()));
  add_box(info, model.box_min, model.box_max);
  info.line("area", fmt::format("{:.8g} mm2", area));
  info.line("components", fmt::format("{}", topology.components));
  info.line("boundary", fmt::format("{} loops, {} free edges", topology.loops, topology.free_edges));
  info.line("Euler", fmt::format("{}", topology.euler));
  info.line("edges", fmt::format("{} ({} seams, {} poles), largest tolerance {:.3g} mm", model.edges.size(),
                                 topology.seam_edges, topology.degenerate_edges, largest_tolerance));
  const auto defect = [&](const char* label, long count) {
    if (count > 0) info.line(label, fmt::format("{}", count));
  };
  defect("  edges of 3 or more faces", topology.nonmanifold_edges);
  defect("  edges whose faces disagree about the outside", topology.incoherent_edges);
  defect("  vertices of several fans", topology.nonmanifold_vertices);
  auto unusable = nlohmann::ordered_json::array();
  for (const UnusableFace& face : model.unusable_faces) {
    info.notes.push_back(fmt::format("face {}{} is unusable: {}", face.index,
                                     face.name.empty() ? "" : " \"" + face.name + "\"", face.reason));
    unusable.push_back({{"face", face.index}, {"name", face.name}, {"reason", face.reason}});
  }
  for (const FailedEntity& entity : file.failed) {
    info.notes.push_back(fmt::format("{} was not read: {}", entity.entity, entity.reason));
    unusable.push_back({{"face", nullptr}, {"name", entity.entity}, {"reason", entity.reason}});
  }
  for (const auto* warnings : {&file.warnings, &model.warnings})
    info.notes.insert(info.notes.end(), warnings->begin(), warnings->end());

  auto& json = info.json;
  json["surface_types"] = types;
  json["unusable_faces"] = unusable;
  json["area"] = area;
  json["components"] = topology.components;
  json["boundary_loops"] = topology.loops;
  json["euler"] = topology.euler;
  json["edges"] = model.edges.size();
  json["free_edges"] = topology.free_edges;
  json["seam_edges"] = topology.seam_edges;
  json["degenerate_edges"] = topology.degenerate_edges;
  json["nonmanifold_edges"] = topology.nonmanifold_edges;
  json["incoherent_edges"] = topology.incoherent_edges;
  json["nonmanifold_vertices"] = topology.nonmanifold_vertices;
  json["largest_edge_tolerance"] = largest_tolerance;
  json["face_list"] = faces;
  json["notes"] = file.warnings;
  for (const std::string& warning : model.warnings) json["notes"].push_back(warning);
  return info;
}

}  // namespace tri::cli

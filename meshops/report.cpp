#include "meshops/report.hpp"

#include <nlohmann/json.hpp>

namespace tri {

nlohmann::ordered_json to_json(const Report& report) {
  nlohmann::ordered_json json = {{"operation", report.operation}, {"seconds", report.seconds}};
  const auto count = [&](const char* name, std::uint64_t value) {
    if (value) json[name] = value;
  };
  count("vertices_added", report.vertices_added);
  count("vertices_removed", report.vertices_removed);
  count("vertices_moved", report.vertices_moved);
  count("faces_added", report.faces_added);
  count("faces_removed", report.faces_removed);
  count("faces_reversed", report.faces_reversed);
  count("edges_flipped", report.edges_flipped);
  count("touched_vertices", report.touched_vertices.size());
  count("touched_faces", report.touched_faces.size());
  if (!report.skipped.empty()) json["skipped"] = report.skipped;
  if (!report.figures.empty()) json["figures"] = report.figures;
  if (!report.notes.empty()) json["notes"] = report.notes;
  return json;
}

}  // namespace tri

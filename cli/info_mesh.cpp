#include <fmt/format.h>

#include "cli/info.hpp"
#include "cli/program.hpp"
#include "io/mesh_file.hpp"
#include "meshops/checks/mesh_summary.hpp"

namespace tri::cli {
namespace {

std::string names_of_scalars(const std::map<std::string, std::vector<double>>& scalars) {
  std::string text;
  for (const auto& [name, values] : scalars) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string verdict(const MeshSummary& s) {
  return fmt::format("{}, {}, {}", s.manifold ? "manifold" : "not manifold",
                     s.oriented ? "coherently oriented" : "not coherently oriented", s.closed ? "closed" : "open");
}

}  // namespace

Info mesh_info(const std::string& path, Context& context) {
  MeshFileInfo file;
  const Soup soup = read_mesh(path, context, &file);
  const MeshSummary s = summarize(soup);
  Info info;
  info.json = {
      {"kind", "mesh"}, {"format", name_of(file.format)}, {"encoding", name_of(file.encoding)}, {"bytes", file.bytes}};
  info.line("mesh",
            fmt::format("{}, {}, {} bytes", name_of(file.format), name_of(file.encoding), with_commas(file.bytes)));
  info.line("vertices",
            with_commas(s.vertices) +
                (s.unused_vertices > 0 ? fmt::format(" ({} in no triangle)", with_commas(s.unused_vertices)) : ""));
  info.line("triangles",
            with_commas(s.triangles) + (file.polygons_split > 0
                                            ? fmt::format(" (from {} polygons, of which {} had more than 3 corners)",
                                                          with_commas(file.polygons), with_commas(file.polygons_split))
                                            : ""));
  info.line("edges", fmt::format("{}; length {:.6g} to {:.6g}, mean {:.6g}", with_commas(s.edges), s.shortest_edge,
                                 s.longest_edge, s.mean_edge));
  add_box(info, s.box_min, s.box_max);
  info.line("area", fmt::format("{:.8g}", s.area));
  if (s.closed && s.oriented)
    info.line("volume", fmt::format("{:.8g}{}", s.volume, s.volume < 0 ? " (inside out)" : ""));
  info.line("components", with_commas(s.components));
  info.line("boundary",
            fmt::format("{} loops, {} edges", with_commas(s.boundary_loops), with_commas(s.boundary_edges)));
  info.line("Euler", fmt::format("{}", s.euler));
  info.line("surface", verdict(s));
  const auto defect = [&](const char* label, std::uint64_t count) {
    if (count > 0) info.line(label, with_commas(count));
  };
  defect("  edges of 3 or more triangles", s.nonmanifold_edges);
  defect("  edges run twice the same way", s.misoriented_edges);
  defect("  vertices of several fans", s.nonmanifold_vertices);
  defect("  triangles naming a vertex twice", s.repeated_corners);
  defect("  triangles of no area", s.zero_area);
  defect("  duplicate triangles", s.duplicate_triangles);
  const std::string at_vertices = names_of_scalars(soup.vertex_scalars), at_faces = names_of_scalars(soup.face_scalars);
  if (!at_vertices.empty()) info.line("vertex properties", at_vertices);
  if (!at_faces.empty()) info.line("face properties", at_faces);
  const std::string at_corners = names_of_scalars(soup.corner_scalars);
  if (!at_corners.empty()) info.line("corner properties", at_corners);
  if (!soup.vertex_colors.empty()) info.line("vertex colours", "yes");
  if (!soup.vertex_normals.empty()) info.line("vertex normals", "yes");
  info.notes = file.notes;

  auto& json = info.json;
  json["polygons"] = file.polygons;
  json["polygons_split"] = file.polygons_split;
  json["vertices"] = s.vertices;
  json["unused_vertices"] = s.unused_vertices;
  json["triangles"] = s.triangles;
  json["edges"] = s.edges;
  json["edge_length"] = {{"min", s.shortest_edge}, {"mean", s.mean_edge}, {"max", s.longest_edge}};
  json["area"] = s.area;
  json["volume"] = s.closed && s.oriented ? nlohmann::ordered_json(s.volume) : nlohmann::ordered_json();
  json["components"] = s.components;
  json["boundary_loops"] = s.boundary_loops;
  json["boundary_edges"] = s.boundary_edges;
  json["euler"] = s.euler;
  json["manifold"] = s.manifold;
  json["oriented"] = s.oriented;
  json["closed"] = s.closed;
  json["nonmanifold_edges"] = s.nonmanifold_edges;
  json["misoriented_edges"] = s.misoriented_edges;
  json["nonmanifold_vertices"] = s.nonmanifold_vertices;
  json["repeated_corners"] = s.repeated_corners;
  json["zero_area"] = s.zero_area;
  json["duplicate_triangles"] = s.duplicate_triangles;
  json["vertex_properties"] = nlohmann::ordered_json::array();
  for (const auto& [name, values] : soup.vertex_scalars) json["vertex_properties"].push_back(name);
  json["face_properties"] = nlohmann::ordered_json::array();
  for (const auto& [name, values] : soup.face_scalars) json["face_properties"].push_back(name);
  json["corner_properties"] = nlohmann::ordered_json::array();
  for (const auto& [name, values] : soup.corner_scalars) json["corner_properties"].push_back(name);
  json["vertex_colors"] = !soup.vertex_colors.empty();
  json["vertex_normals"] = !soup.vertex_normals.empty();
  json["parts"] = file.parts;
  json["notes"] = file.notes;
  return info;
}

}  // namespace tri::cli

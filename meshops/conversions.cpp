#include "meshops/conversions.hpp"

#include "meshops/build_mesh.hpp"
#include "meshops/to_soup.hpp"

namespace tri {

Report build_mesh_step(Geometry& geometry, Context& context) {
  // Built in its place: OpenMesh's meshes copy where others move.
  Soup soup = std::move(std::get<Soup>(geometry));
  Mesh& mesh = geometry.emplace<Mesh>();
  try {
    return build_mesh_into(mesh, soup, context);
  } catch (...) {
    geometry = std::move(soup);
    throw;
  }
}

Report to_soup_step(Geometry& geometry, Context& context) {
  context.checkpoint();
  context.progress("to-soup", 0);
  Mesh& mesh = std::get<Mesh>(geometry);
  Soup soup = to_soup(view_of(mesh), &context);
  Report report;
  if (const std::size_t dropped = mesh.n_vertices() - soup.points.size())
    report.figures["deleted vertices dropped"] = static_cast<double>(dropped);
  if (const std::size_t dropped = mesh.n_faces() - soup.triangles.size())
    report.figures["deleted faces dropped"] = static_cast<double>(dropped);
  geometry = std::move(soup);
  context.progress("to-soup", 1);
  return report;
}

}  // namespace tri

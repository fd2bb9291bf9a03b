#include "meshops/conversions.hpp"

#include "meshops/build_mesh.hpp"
#include "meshops/to_soup.hpp"

namespace tri {

Report build_mesh_step(Geometry& geometry, Context& context) {
  BuiltMesh built = build_mesh(std::get<Soup>(geometry), context);
  geometry = std::move(built.mesh);
  return std::move(built.report);
}

Report to_soup_step(Geometry& geometry, Context& context) {
  context.checkpoint();
  Mesh& mesh = std::get<Mesh>(geometry);
  Soup soup = to_soup(view_of(mesh));
  Report report;
  if (const std::size_t dropped = mesh.n_vertices() - soup.points.size())
    report.figures["deleted vertices dropped"] = static_cast<double>(dropped);
  if (const std::size_t dropped = mesh.n_faces() - soup.triangles.size())
    report.figures["deleted faces dropped"] = static_cast<double>(dropped);
  geometry = std::move(soup);
  return report;
}

}  // namespace tri

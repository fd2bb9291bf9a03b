#include "meshops/operators/orient.hpp"

#include "meshops/checks/shells.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

/// Vertex normals follow if every triangle at the vertex was turned.
void turn_normals(Soup& soup, const std::vector<char>& reversed) {
  if (soup.vertex_normals.empty()) return;
  std::vector<char> turned(soup.points.size(), 0), kept(soup.points.size(), 0);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (const std::uint32_t v : soup.triangles[i]) (reversed[i] ? turned : kept)[v] = 1;
  for (std::size_t v = 0; v < soup.points.size(); ++v)
    if (turned[v] && !kept[v]) soup.vertex_normals[v] *= -1.0;
}

}  // namespace

const OptionSchema& OrientOptions::schema() {
  using O = OrientOptions;
  static const OptionSchema schema =
      Schema<O>().boolean("outward", &O::outward, {.help = "closed shells face outward, cavities inward"});
  return schema;
}

Report orient(Soup& soup, const OrientOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("orient", 0);
  check_soup(soup, &context);
  Report report;
  report.operation = "orient";
  Shells shells = find_shells(soup, context);
  context.progress("orient", 0.6);
  double turned_outward = 0;
  if (options.outward) {
    find_depths(soup, shells, context);
    for (const Shell& shell : shells.shells) {
      if (!shell.closed || (shell.depth % 2 == 0 ? shell.volume : -shell.volume) >= 0) continue;
      ++turned_outward;
      for (const std::uint32_t t : shell.triangles) shells.reversed[t] ^= 1;
    }
  }
  context.checkpoint();
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    if (!shells.reversed[i]) continue;
    reverse_triangle(soup, i);
    report.touched_faces.push_back(i);
  }
  turn_normals(soup, shells.reversed);
  report.faces_reversed = report.touched_faces.size();
  if (turned_outward > 0) report.figures["closed shells turned outward"] = turned_outward;
  if (!shells.one_sided.empty()) report.skipped["edges of a surface with one side only"] = shells.one_sided.size();
  context.progress("orient", 1);
  return report;
}

}  // namespace tri

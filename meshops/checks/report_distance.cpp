#include "meshops/checks/report_distance.hpp"

#include <vector>

#include "meshops/checks/mesh_distance.hpp"
#include "meshops/limits.hpp"

namespace tri {
namespace {

/// Of points that no triangle uses only the first used one is left, so that they need not be finite. @return false if
/// there is no triangle, or a corner is not finite
bool surface_of(const MeshBefore& mesh, Soup& soup) {
  soup.triangles = mesh.triangles();
  if (soup.triangles.empty()) return false;
  soup.points.assign(mesh.points().size(), mesh.points()[soup.triangles[0][0]]);
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) {
      soup.points[v] = mesh.points()[v];
      if (!is_finite(soup.points[v])) return false;
    }
  return true;
}

}  // namespace

void report_distance(const MeshBefore& before, MeshView now, Report& report, const Context& context) {
  Soup first, second;
  if (!surface_of(before, first) || !surface_of(MeshBefore(now), second)) return;
  Context quiet;
  quiet.threads = context.threads;
  quiet.on_checkpoint = [&] { context.checkpoint(); };
  const MeshDistance distance =
      mesh_distance(first, second, {.samples = 1, .relative_error = 0.05, .max_searches = 500'000}, quiet);
  report.figures["hausdorff"] = distance.hausdorff;
  report.figures["hausdorff at most"] = distance.hausdorff_bound;
}

}  // namespace tri

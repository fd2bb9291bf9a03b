#include "meshops/shape/surface_survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t survey_block = 2048;

}  // namespace

SurfaceSurvey survey_surface(MeshView view, const ClosestTriangle& other, const std::vector<std::uint32_t>& near,
                             const Context& context) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const std::size_t n = mesh.n_faces();
  std::vector<SurfaceSurvey> parts((n + survey_block - 1) / survey_block);
  for_each_block(context, "", n, survey_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    SurfaceSurvey& part = parts[block];
    for (std::size_t i = begin; i < end; ++i) {
      const FaceHandle f(static_cast<int>(i));
      if (mesh.status(f).deleted()) continue;
      ++part.faces;
      const HalfedgeHandle h = mesh.halfedge_handle(f), next = mesh.next_halfedge_handle(h);
      const VertexHandle a = mesh.from_vertex_handle(h);
      const std::array<Vec3, 3> p{view.point(a), view.point(mesh.to_vertex_handle(h)),
                                  view.point(mesh.to_vertex_handle(next))};
      const std::uint32_t hint = near[static_cast<std::size_t>(a.idx())];
      const auto look = [&](const Vec3& x) {
        part.greatest_distance = std::max(part.greatest_distance, other.closest(x, hint).distance);
      };
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 u = p[(k + 1) % 3] - p[k], w = p[(k + 2) % 3] - p[k];
        part.smallest_angle = std::min(part.smallest_angle, std::atan2((u % w).norm(), u | w));
        look(p[k]);
        look(p[k] + 0.5 * u);
      }
      look((p[0] + p[1] + p[2]) / 3.0);
    }
  });
  SurfaceSurvey all;
  for (const SurfaceSurvey& part : parts) {
    all.faces += part.faces;
    all.smallest_angle = std::min(all.smallest_angle, part.smallest_angle);
    all.greatest_distance = std::max(all.greatest_distance, part.greatest_distance);
  }
  return all;
}

}  // namespace tri

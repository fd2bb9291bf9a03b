#include "libtri/triangulation_checks.hpp"

#include <cmath>


namespace tri {

TriangulationChecks check_triangulation(std::span<const Vec3> points, std::span<const Foot> feet, const PointMesh& mesh) {
  constexpr double fold_cosine = -0.8660254037844386, turned_cosine = -0.5;
  TriangulationChecks checks;
  std::vector<Vec3> normals(mesh.triangles.size());
  std::vector<bool> used(points.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& q = mesh.triangles[t];
    const Vec3 n = (points[q[1]] - points[q[0]]) % (points[q[2]] - points[q[0]]);
    const double length = n.norm();
    normals[t] = length > 0 ? Vec3(n / length) : Vec3(0, 0, 0);
    Vec3 model(0, 0, 0);
    for (std::uint32_t v : q) {
      used[v] = true;
      for (int k = 0; k < 3; ++k) model[k] += feet[v].normal[k];
    }
    checks.turned += (normals[t] | model) < turned_cosine * model.norm();
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::int32_t n : mesh.neighbors[t])
      if (n > static_cast<std::int32_t>(t)) checks.folds += (normals[t] | normals[n]) < fold_cosine;
  for (std::size_t p = 0; p < points.size(); ++p) checks.unused_points += feet[p].face >= 0 && !used[p];
  return checks;
}

}  // namespace tri

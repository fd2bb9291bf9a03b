#include "libtri/triangulation/triangulation_checks.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <functional>

#include "meshops/pace.hpp"

namespace tri {

TriangulationChecks check_triangulation(std::span<const Vec3> points, std::span<const Foot> feet, const PointMesh& mesh,
                                        const Context* context) {
  Pace pace(context);
  constexpr double fold_cosine = -0.8660254037844386, turned_cosine = -0.5;
  TriangulationChecks checks;
  const std::size_t n_triangles = mesh.triangles.size();
  std::vector<std::array<float, 3>> normals(n_triangles);
  const auto count = [&](auto&& is_wrong) {  // sums of whole numbers: the same for any number of threads
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, n_triangles, 4096), std::uint64_t{0},
        [&](const auto& range, std::uint64_t sum) {
          if (context) context->checkpoint();
          for (std::size_t t = range.begin(); t < range.end(); ++t) sum += is_wrong(t);
          return sum;
        },
        std::plus<>());
  };
  const auto dot = [](const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  checks.turned = count([&](std::size_t t) -> std::uint64_t {
    const Triangle& q = mesh.triangles[t];
    const Vec3 n = (points[q[1]] - points[q[0]]) % (points[q[2]] - points[q[0]]);
    const double length = n.norm();
    Vec3 model(0, 0, 0);
    for (int k = 0; k < 3; ++k) {
      normals[t][k] = length > 0 ? static_cast<float>(n[k] / length) : 0;
      for (std::uint32_t v : q) model[k] += feet[v].normal[k];
    }
    return (n | model) < turned_cosine * length * model.norm() ? 1 : 0;
  });
  checks.folds = count([&](std::size_t t) {
    std::uint64_t folds = 0;
    for (std::int32_t n : mesh.neighbors[t])
      if (n > static_cast<std::int32_t>(t)) folds += dot(normals[t], normals[n]) < fold_cosine;
    return folds;
  });
  std::vector<bool> used(points.size(), false);
  for (const Triangle& q : mesh.triangles) {
    pace();
    for (std::uint32_t v : q) used[v] = true;
  }
  for (std::size_t p = 0; p < points.size(); ++p) checks.unused_points += feet[p].face >= 0 && !used[p];
  return checks;
}

}  // namespace tri

#include "meshops/search/local_spacing.hpp"

#include <algorithm>

#include "meshops/pace.hpp"

namespace tri {
namespace {

double lower_median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<double> local_spacing(MeshView view, const Context* context) {
  Pace pace(context, 4096);
  const auto& mesh = view.mesh;
  std::vector<double> own(mesh.n_vertices(), 0), smooth(mesh.n_vertices(), 0);
  std::vector<double> values;
  const auto live = [&](VertexHandle v) { return !mesh.status(v).deleted() && !mesh.is_isolated(v); };
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i, pace()) {
    const VertexHandle v(i);
    if (!live(v)) continue;
    values.clear();
    for (auto it = mesh.cvv_iter(v); it.is_valid(); ++it) values.push_back((view.point(*it) - view.point(v)).norm());
    own[i] = lower_median(values);
  }
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i, pace()) {
    const VertexHandle v(i);
    if (!live(v)) continue;
    values.assign(1, own[i]);
    for (auto it = mesh.cvv_iter(v); it.is_valid(); ++it) values.push_back(own[(*it).idx()]);
    smooth[i] = lower_median(values);
  }
  return smooth;
}

}  // namespace tri

#include "meshops/checks/soup_components.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {

std::vector<SoupComponent> measure_components(const Soup& soup, std::span<const std::uint32_t> component_of_triangle,
                                              const Shells& shells, const Context* context) {
  Pace pace(context);
  std::vector<SoupComponent> result;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    pace();
    const std::uint32_t n = component_of_triangle[i];
    if (n == Shells::none) continue;
    result.resize(std::max<std::size_t>(result.size(), n + std::size_t{1}));
    ++result[n].triangles;
    result[n].area += area_vector(soup, soup.triangles[i]).norm() / 2;
  }
  for (const Shell& shell : shells.shells) {
    SoupComponent& c = result[component_of_triangle[shell.triangles[0]]];
    c.volume += shell.volume;
    c.absolute_volume += std::abs(shell.volume);
    c.closed = c.closed && shell.closed;
  }
  return result;
}

}  // namespace tri

#include "meshops/soup_components.hpp"

#include <algorithm>
#include <limits>

#include "meshops/disjoint_sets.hpp"
#include "meshops/side_pairs.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {

SoupComponents find_components(const Soup& soup, const Shells& shells, Context& context) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  // Shells, joined over the edges that tie more than two triangles together or tie exact copies.
  std::vector<Triangle> whole;
  std::vector<std::uint32_t> source;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    if (repeats_vertex(soup.triangles[i])) continue;
    whole.push_back(soup.triangles[i]);
    source.push_back(i);
  }
  const SidePairs pairs = pair_sides(whole, soup.points.size(), context);
  DisjointSets sets(soup.triangles.size());
  const auto join = [&](std::int32_t a, std::int32_t b) {
    sets.join(source[static_cast<std::size_t>(a / 3)], source[static_cast<std::size_t>(b / 3)]);
  };
  for (std::int32_t side = 0; side < static_cast<std::int32_t>(pairs.twin.size()); ++side)
    if (pairs.twin[static_cast<std::size_t>(side)] > side) join(side, pairs.twin[static_cast<std::size_t>(side)]);
  for (const auto& [a, b] : pairs.same_way) join(a, b);
  for (const auto& crowd : pairs.crowded)
    for (std::size_t i = 1; i < crowd.size(); ++i) join(crowd[0], crowd[i]);

  SoupComponents result;
  result.of_triangle.assign(soup.triangles.size(), none);
  std::vector<std::uint32_t> number(soup.triangles.size(), none);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    std::uint32_t& n = number[sets.find(i)];
    if (n == none) {
      n = static_cast<std::uint32_t>(result.components.size());
      result.components.push_back({.closed = true});
    }
    result.of_triangle[i] = n;
    SoupComponent& c = result.components[n];
    ++c.triangles;
    c.area += area_vector(soup, soup.triangles[i]).norm() / 2;
    if (shells.of_triangle[i] == Shells::none || !shells.shells[shells.of_triangle[i]].closed) c.closed = false;
  }
  for (const Shell& shell : shells.shells) result.components[result.of_triangle[shell.triangles[0]]].volume += shell.volume;
  // A vertex counts once for each component that names it.
  std::vector<std::vector<std::uint32_t>> triangles(result.components.size());
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) triangles[result.of_triangle[i]].push_back(i);
  std::vector<std::uint32_t> last(soup.points.size(), none);
  for (std::uint32_t c = 0; c < triangles.size(); ++c)
    for (const std::uint32_t i : triangles[c])
      for (const std::uint32_t v : soup.triangles[i]) {
        result.components[c].vertices += last[v] != c;
        last[v] = c;
      }
  return result;
}

}  // namespace tri

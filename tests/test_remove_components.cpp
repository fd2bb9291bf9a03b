#include <doctest/doctest.h>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/operators/remove_components.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Areas 6, 24, 9 (open) and 1.5; volumes 1, 8, none, 0.125.
Soup parts() {
  return with_attributes(joined(joined(joined(cube(), cube({5, 0, 0}, 2)), sheet(3, 3)), cube({20, 0, 0}, 0.5)));
}

std::vector<double> kept(const RemoveComponentsOptions& options) {
  Soup soup = parts();
  soup.points.emplace_back(9, 9, 9);
  soup.vertex_scalars["x"].push_back(9);
  soup.vertex_colors.push_back({1, 2, 3});
  soup.vertex_normals.emplace_back(0, 0, 1);
  Context context;
  remove_components(soup, options, context);
  CHECK(soup.points.back() == Vec3(9, 9, 9));  // a vertex that no triangle used is no part of a component
  CHECK(summarize(soup).unused_vertices == 1);
  return {static_cast<double>(soup.triangles.size()), soup_area(soup)};
}

}  // namespace

TEST_CASE("remove_components: nothing goes unless it is asked for") {
  Soup soup = parts();
  Context context;
  CHECK(remove_components(soup, {}, context).unchanged());
  CHECK(same_soup(soup, parts()));
}

TEST_CASE("remove_components: by area, volume, triangles and rank") {
  CHECK(kept({.min_area = 6.5}) == std::vector<double>{30, 33});
  CHECK(kept({.min_volume = 0.5}) == std::vector<double>{24, 30});
  CHECK(kept({.min_triangles = 13}) == std::vector<double>{18, 9});
  CHECK(kept({.keep = 2}) == std::vector<double>{30, 33});
  CHECK(kept({.min_volume = 0.1, .keep = 1}) == std::vector<double>{12, 24});
}

TEST_CASE("remove_components: solids with an edge in common are one component") {
  Soup soup = joined(cube(), cube({1, 1, 0}));
  for (Triangle& t : soup.triangles)
    for (std::uint32_t& v : t) v = v == 8 ? 3 : v == 12 ? 7 : v;
  Context context;
  CHECK(remove_components(soup, {.keep = 1}, context).unchanged());
  CHECK(remove_components(soup, {.min_volume = 1.5}, context).unchanged());
  CHECK(remove_components(soup, {.min_volume = 2.5}, context).faces_removed == 24);
}

#include "meshops/crossings/solid_check.hpp"

#include <algorithm>

#include "meshops/checks/shells.hpp"
#include "meshops/crossings/predicates.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/joining/joined_points.hpp"
#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

std::vector<Triangle> by_place(std::span<const Vec3> points, std::span<const Triangle> triangles,
                               const Context& context) {
  Pace pace(context);
  const std::vector<std::uint32_t> same = points_at_same_place(points, &context);
  std::vector<Triangle> welded(triangles.begin(), triangles.end());
  for (Triangle& t : welded) {
    pace();
    t = {same[t[0]], same[t[1]], same[t[2]]};
  }
  return welded;
}

bool is_closed_manifold(std::span<const Triangle> triangles, std::size_t points, Context& context) {
  const SidePairs pairs = pair_sides(triangles, points, context);
  return pairs.crowded.empty() && pairs.same_way.empty() &&
         std::ranges::find(pairs.twin, SidePairs::none) == pairs.twin.end() &&
         vertices_with_several_fans(triangles, points, pairs.twin, context).empty();
}

bool faces_outward(const Soup& soup, Context& context) {
  Shells shells = find_shells(soup, context);
  if (std::ranges::all_of(shells.shells, [](const Shell& s) { return s.volume >= 0; })) return true;
  find_depths(soup, shells, context);
  return std::ranges::none_of(shells.shells, is_inside_out);
}

}  // namespace

SurfaceContacts surface_contacts(std::span<const Vec3> points, std::span<const Triangle> triangles, Context& context) {
  Pace pace(context);
  SurfaceContacts contacts;
  const std::vector<Triangle> welded = by_place(points, triangles, context);
  for (std::uint32_t t = 0; t < welded.size(); ++t) {
    pace();
    const Triangle& v = welded[t];
    const Vec3 &a = points[v[0]], &b = points[v[1]], &c = points[v[2]];
    // The exact test only where rounding could hide an area.
    const double longest = std::max({(b - a).sqrnorm(), (c - b).sqrnorm(), (a - c).sqrnorm()});
    if (repeats_vertex(v) || (((b - a) % (c - a)).norm() <= 1e-12 * longest && collinear_exact(a, b, c)))
      contacts.flat.push_back(t);
  }
  contacts.crossing = self_intersections(points, welded, context, Neighbors::judge);
  return contacts;
}

std::vector<std::uint32_t> touching_vertices(const Soup& soup, const Context* context) {
  Pace pace(context);
  std::vector<char> used(soup.points.size(), 0), taken(soup.points.size(), 0);
  for (const Triangle& t : soup.triangles) {
    pace();
    for (const std::uint32_t v : t) used[v] = 1;
  }
  const std::vector<std::uint32_t> same = points_at_same_place(soup.points, context);
  std::vector<std::uint32_t> touching;
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    pace();
    if (!used[v]) continue;
    if (taken[same[v]]) touching.push_back(v);
    taken[same[v]] = 1;
  }
  return touching;
}

bool is_clean_solid(const Soup& soup, bool apart, Context& context) {
  if (soup.triangles.empty() || std::ranges::any_of(soup.triangles, repeats_vertex)) return false;
  if (!is_closed_manifold(soup.triangles, soup.points.size(), context)) return false;
  if (apart) {
    const std::vector<Triangle> welded = by_place(soup.points, soup.triangles, context);
    if (std::ranges::any_of(welded, repeats_vertex) || !is_closed_manifold(welded, soup.points.size(), context))
      return false;
  }
  return faces_outward(soup, context) && surface_contacts(soup.points, soup.triangles, context).none();
}

}  // namespace tri

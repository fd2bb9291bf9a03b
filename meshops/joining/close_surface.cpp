#include "meshops/joining/close_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshops/holes/ring_filling.hpp"
#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

constexpr int dynamic_edges = 128;

/// A loop of sides without a twin, against their direction.
struct Loop {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3> edge_normals;  ///< of the triangle beyond edge (i, i + 1)
  std::uint32_t triangle;          ///< one at the loop
};

std::vector<Loop> find_loops(std::span<const Vec3> points, std::span<const Triangle> triangles,
                             std::span<const std::int32_t> twin, std::size_t vertices, const auto& place, Pace& pace) {
  constexpr std::int32_t none = SidePairs::none;
  std::vector<std::int32_t> into(vertices, none);  // the open side that ends at a vertex: there is one at most
  for (std::size_t s = 0; s < twin.size(); ++s, pace())
    if (twin[s] == none) into[triangles[s / 3][(s % 3 + 1) % 3]] = static_cast<std::int32_t>(s);
  std::vector<Loop> loops;
  std::vector<char> seen(twin.size());
  for (std::size_t start = 0; start < twin.size(); ++start) {
    pace();
    if (twin[start] != none || seen[start]) continue;
    Loop loop;
    loop.triangle = static_cast<std::uint32_t>(start / 3);
    for (auto s = static_cast<std::int32_t>(start); s != none && !seen[static_cast<std::size_t>(s)];
         s = into[triangles[s / 3][s % 3]]) {
      pace();
      seen[static_cast<std::size_t>(s)] = 1;
      loop.vertices.push_back(triangles[s / 3][(s % 3 + 1) % 3]);
      const Triangle& t = triangles[s / 3];
      loop.edge_normals.push_back(triangle_normal(points[place(t[0])], points[place(t[1])], points[place(t[2])]));
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// How often a closed surface winds round a point, by the solid angles of its triangles [van Oosterom & Strackee 1983].
double winding(std::span<const Vec3> points, std::span<const Triangle> triangles, const Vec3& p, Pace& pace) {
  double sum = 0;
  for (const Triangle& t : triangles) {
    pace();
    const Vec3 a = points[t[0]] - p, b = points[t[1]] - p, c = points[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a | (b % c), la * lb * lc + (a | b) * lc + (b | c) * la + (c | a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

void turn_outward(std::span<const Vec3> points, std::vector<std::uint32_t>& component, std::size_t components,
                  ClosedSurface& surface, Context& context) {
  Pace pace(context);
  std::vector<std::vector<std::uint32_t>> members(components);
  for (std::uint32_t t = 0; t < component.size(); ++t) pace(), members[component[t]].push_back(t);
  std::vector<double> volume(components, 0);
  std::vector<Vec3> low(components, Vec3(1, 1, 1) * 1e300), high(components, Vec3(-1, -1, -1) * 1e300);
  for (std::size_t i = 0; i < components; ++i) {
    const Vec3& o = points[surface.triangles[members[i][0]][0]];
    for (const std::uint32_t m : members[i]) {
      pace();
      const Triangle& t = surface.triangles[m];
      volume[i] += (points[t[0]] - o) | ((points[t[1]] - o) % (points[t[2]] - o));
      for (const std::uint32_t v : t) low[i].minimize(points[v]), high[i].maximize(points[v]);
    }
  }
  std::vector<char> turn(components);
  for (std::size_t i = 0; i < components; ++i) {
    if (!(volume[i] < 0)) continue;
    context.checkpoint();
    // A cavity lies within another component; which of them wind round one of its vertices?
    const Vec3& p = points[surface.triangles[members[i][0]][0]];
    bool cavity = false;
    for (std::size_t j = 0; j < components && !cavity; ++j) {
      if (j == i || std::abs(volume[j]) <= std::abs(volume[i])) continue;
      bool around = true;
      for (int k = 0; k < 3; ++k) around &= low[j][k] < low[i][k] && high[j][k] > high[i][k];
      if (!around) continue;
      std::vector<Triangle> other;
      for (const std::uint32_t m : members[j]) pace(), other.push_back(surface.triangles[m]);
      cavity = std::abs(winding(points, other, p, pace)) > 0.5;
    }
    turn[i] = !cavity;
    surface.inside_out += !cavity;
  }
  for (std::size_t t = 0; t < component.size(); ++t) {
    pace();
    if (turn[component[t]]) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    surface.cavity.push_back(static_cast<char>(volume[component[t]] < 0 && !turn[component[t]]));
  }
}

}  // namespace

ClosedSurface close_surface(std::span<const Vec3> points, std::span<const Triangle> triangles, Context& context) {
  Pace pace(context);
  ClosedSurface surface;
  surface.given = triangles.size();
  for (std::uint32_t t = 0; t < triangles.size(); ++t) pace(), surface.source.push_back(t);
  std::vector<Triangle> work(triangles.begin(), triangles.end());
  SidePairs pairs = pair_sides(work, points.size(), context);
  const ManifoldRepairs repairs = make_manifold(work, points, pairs, context);
  surface.reversed = repairs.reversed_triangles.size();
  const auto place = [&](std::uint32_t v) { return v < points.size() ? v : repairs.copied_points[v - points.size()]; };

  std::vector<std::uint32_t> component(work.size(), 0xffffffffu);
  std::uint32_t components = 0;
  std::vector<std::uint32_t> queue;
  for (std::uint32_t seed = 0; seed < work.size(); ++seed) {
    if (component[seed] != 0xffffffffu) continue;
    queue.assign(1, seed);
    component[seed] = components;
    for (std::size_t i = 0; i < queue.size(); ++i, pace())
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t other = pairs.twin[3 * queue[i] + k];
        if (other == SidePairs::none || component[other / 3] != 0xffffffffu) continue;
        component[other / 3] = components;
        queue.push_back(static_cast<std::uint32_t>(other / 3));
      }
    ++components;
  }

  std::vector<Loop> loops =
      find_loops(points, work, pairs.twin, points.size() + repairs.copied_points.size(), place, pace);
  for (Triangle& t : work) {
    pace();
    for (std::uint32_t& v : t) v = place(v);
  }
  surface.triangles = std::move(work);
  for (Loop& loop : loops) {
    context.checkpoint();
    Ring ring{{}, std::move(loop.edge_normals), {}, {}};
    for (const std::uint32_t v : loop.vertices) ring.points.push_back(points[place(v)]);
    for (std::size_t i = 0; i < ring.points.size(); ++i)
      surface.boundary_length += (ring.points[i] - ring.points[(i + 1) % ring.points.size()]).norm();
    const RingFilling filling = fill_ring(ring, HoleStrategy::minimum_area_dihedral, dynamic_edges, context);
    for (const RingTriangle& t : filling.triangles) {
      const Triangle named{place(loop.vertices[t[0]]), place(loop.vertices[t[1]]), place(loop.vertices[t[2]])};
      if (named[0] == named[1] || named[1] == named[2] || named[2] == named[0]) continue;
      surface.triangles.push_back(named);
      component.push_back(component[loop.triangle]);
      surface.source.push_back(loop.triangle);
    }
    ++surface.holes;
  }
  turn_outward(points, component, components, surface, context);
  return surface;
}

}  // namespace tri

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "meshops/side_pairs.hpp"

namespace tri {
namespace {

using Side = std::int32_t;
using Group = std::vector<Side>;
constexpr Side none = SidePairs::none;

std::uint32_t from_of(std::span<const Triangle> triangles, Side side) {
  return triangles[side / 3][side % 3];
}
std::uint32_t to_of(std::span<const Triangle> triangles, Side side) {
  return from_of(triangles, SidePairs::next(side));
}
std::uint32_t opposite_of(std::span<const Triangle> triangles, Side side) {
  return from_of(triangles, SidePairs::previous(side));
}
std::array<std::uint32_t, 2> edge_of(std::span<const Triangle> triangles, Side side) {
  const std::uint32_t a = from_of(triangles, side), b = to_of(triangles, side);
  return {std::min(a, b), std::max(a, b)};
}

/// Triangles to reverse so that as many pairs of `same_way` as can be run against each other. A triangle and its exact
/// copy are not taken for neighbours: reversing one would close them to a pillow.
std::vector<std::uint32_t> triangles_to_reverse(std::span<const Triangle> triangles, const SidePairs& pairs,
                                                Context& context) {
  std::vector<Side> partner(pairs.twin.size(), none);
  std::vector<char> same(pairs.twin.size());
  for (const auto& [a, b] : pairs.same_way) {
    if (opposite_of(triangles, a) == opposite_of(triangles, b)) continue;
    partner[a] = b;
    partner[b] = a;
    same[a] = same[b] = 1;
  }
  constexpr char unseen = 2;
  std::vector<char> reverse(triangles.size(), unseen);
  std::vector<std::uint32_t> component, result;
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (reverse[seed] != unseen) continue;
    context.checkpoint();
    component.assign(1, seed);
    reverse[seed] = 0;
    std::size_t reversed = 0;
    for (std::size_t i = 0; i < component.size(); ++i) {
      const std::uint32_t t = component[i];
      reversed += static_cast<std::size_t>(reverse[t]);
      for (Side side = static_cast<Side>(3 * t); side < static_cast<Side>(3 * t + 3); ++side) {
        const Side other = same[side] ? partner[side] : pairs.twin[side];
        if (other == none || reverse[other / 3] != unseen) continue;
        reverse[other / 3] = static_cast<char>(reverse[t] ^ same[side]);
        component.push_back(static_cast<std::uint32_t>(other / 3));
      }
    }
    const char wanted = 2 * reversed > component.size() ? 0 : 1;
    for (const std::uint32_t t : component)
      if (reverse[t] == wanted) result.push_back(t);
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Pairs the sides of one edge so that each pair encloses material: in angular order about the edge, a side that runs
/// against its direction opens a wedge of material and one that runs along it closes the wedge.
void pair_by_angle(std::span<const Triangle> triangles, std::span<const Vec3> points, Group sides, SidePairs& pairs) {
  const auto [u, v] = edge_of(triangles, sides.front());
  const Vec3 axis = points[v] - points[u];
  std::vector<Vec3> arms;
  for (const Side side : sides) {
    const Vec3 arm = points[opposite_of(triangles, side)] - points[u];
    arms.push_back(arm * axis.sqrnorm() - axis * (arm | axis));
  }
  const auto longest = std::max_element(arms.begin(), arms.end(),
                                        [](const Vec3& a, const Vec3& b) { return a.sqrnorm() < b.sqrnorm(); });
  const Vec3 x = *longest, y = axis % x;
  const double y_scale = x.norm() / std::max(y.norm(), std::numeric_limits<double>::min());
  std::vector<std::pair<double, Side>> order;
  for (std::size_t i = 0; i < sides.size(); ++i)
    order.emplace_back(std::atan2((arms[i] | y) * y_scale, arms[i] | x), sides[i]);
  // A coordinate that is not finite gives no angle; the order of the list then stands in.
  for (auto& [angle, side] : order)
    if (!std::isfinite(angle)) angle = 0;
  std::sort(order.begin(), order.end());

  std::vector<Side> open;
  for (int round = 0; round < 2; ++round) {
    for (const auto& [angle, side] : order) {
      if (pairs.twin[side] != none) continue;
      if (from_of(triangles, side) != u) {
        if (round == 0) open.push_back(side);
      } else if (!open.empty()) {
        pairs.twin[side] = open.back();
        pairs.twin[open.back()] = side;
        open.pop_back();
      }
    }
  }
}

void cut(SidePairs& pairs, Side side) {
  if (pairs.twin[side] == none) return;
  pairs.twin[pairs.twin[side]] = none;
  pairs.twin[side] = none;
}

/// Gives every fan but the first of each vertex in `vertices` a copy of the vertex. Copies are numbered from
/// `points + copies.size()` on, in the order of vertices and of the first corner of each fan.
void split_vertices(std::vector<Triangle>& triangles, std::size_t points, const std::vector<std::uint32_t>& vertices,
                    const SidePairs& pairs, std::vector<std::uint32_t>& copies) {
  if (vertices.empty()) return;
  std::map<std::uint32_t, std::vector<Side>> corners;
  std::vector<char> wanted(points);
  for (const std::uint32_t v : vertices) wanted[v] = 1;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (wanted[triangles[i][k]]) corners[triangles[i][k]].push_back(static_cast<Side>(3 * i + k));
  std::vector<char> seen(pairs.twin.size());
  for (const auto& [v, sides] : corners) {
    bool first = true;
    for (const Side corner : sides) {
      if (seen[corner]) continue;
      Side start = corner;  // clockwise to the first triangle of an open fan, or once around
      while (pairs.twin[start] != none) {
        const Side before = SidePairs::next(pairs.twin[start]);
        if (before == corner) break;
        start = before;
      }
      std::uint32_t name = v;
      if (!first) {
        name = static_cast<std::uint32_t>(points + copies.size());
        copies.push_back(v);
      }
      first = false;
      for (Side side = start; side != none && !seen[side]; side = pairs.twin[SidePairs::previous(side)]) {
        seen[side] = 1;
        triangles[side / 3][side % 3] = name;
      }
    }
  }
}

class Splitter {
 public:
  Splitter(std::vector<Triangle>& triangles, std::span<const Vec3> points, SidePairs& pairs, ManifoldRepairs& repairs)
      : triangles_(triangles), points_(points), pairs_(pairs), repairs_(repairs) {}

  /// @param groups the sides of every edge that might be there twice
  void run(const std::vector<Group>& groups, Context& context) {
    const std::vector<Triangle> unsplit = groups.empty() ? std::vector<Triangle>() : triangles_;
    split();
    std::vector<Group> twice = edges_there_twice(groups);
    if (twice.empty()) return;

    // Cutting the edge open often parts the two sheets; what still shares both ends then belongs together.
    context.checkpoint();
    for (const Group& group : twice)
      for (const Side side : group) cut(pairs_, side);
    triangles_ = unsplit;
    split();
    for (const Group& group : twice) join_sides_between_same_vertices(group);
    triangles_ = unsplit;
    split();
    twice = edges_there_twice(groups);
    if (twice.empty()) return;

    context.checkpoint();
    for (const Group& group : twice) {
      for (const Side side : group) {
        const Side first = side - side % 3;
        for (Side s = first; s < first + 3; ++s) cut(pairs_, s);
        repairs_.detached_triangles.push_back(static_cast<std::uint32_t>(side / 3));
      }
    }
    std::vector<std::uint32_t>& detached = repairs_.detached_triangles;
    std::sort(detached.begin(), detached.end());
    detached.erase(std::unique(detached.begin(), detached.end()), detached.end());
    triangles_ = unsplit;
    split();
  }

 private:
  using Ends = std::array<std::uint32_t, 2>;

  void split() {
    repairs_.copied_points.clear();
    split_vertices(triangles_, points_.size(), vertices_with_several_fans(triangles_, points_.size(), pairs_.twin),
                   pairs_, repairs_.copied_points);
  }

  std::map<Ends, Group> by_ends(const Group& group) const {
    std::map<Ends, Group> result;
    for (const Side side : group) result[edge_of(triangles_, side)].push_back(side);
    return result;
  }

  std::vector<Group> edges_there_twice(const std::vector<Group>& groups) const {
    std::vector<Group> twice;
    for (const Group& group : groups) {
      for (const auto& [ends, sides] : by_ends(group)) {
        if (sides.size() > 2 || (sides.size() == 2 && pairs_.twin[sides[0]] != sides[1])) {
          twice.push_back(group);
          break;
        }
      }
    }
    return twice;
  }

  void join_sides_between_same_vertices(const Group& group) {
    for (const auto& [ends, sides] : by_ends(group)) {
      if (sides.size() != 2 || from_of(triangles_, sides[0]) == from_of(triangles_, sides[1])) continue;
      pairs_.twin[sides[0]] = sides[1];
      pairs_.twin[sides[1]] = sides[0];
    }
  }

  std::vector<Triangle>& triangles_;
  std::span<const Vec3> points_;
  SidePairs& pairs_;
  ManifoldRepairs& repairs_;
};

}  // namespace

ManifoldRepairs make_manifold(std::vector<Triangle>& triangles, std::span<const Vec3> points, SidePairs& pairs,
                              Context& context) {
  ManifoldRepairs repairs;
  if (!pairs.same_way.empty()) {
    repairs.reversed_triangles = triangles_to_reverse(triangles, pairs, context);
    for (const std::uint32_t t : repairs.reversed_triangles) std::swap(triangles[t][1], triangles[t][2]);
    if (!repairs.reversed_triangles.empty()) pairs = pair_sides(triangles, points.size(), context);
  }
  std::vector<Group> groups;
  for (const auto& [a, b] : pairs.same_way) {
    repairs.cut.push_back(edge_of(triangles, a));
    groups.push_back({a, b});
  }
  for (const Group& group : pairs.crowded) {
    repairs.crowded.push_back(edge_of(triangles, group.front()));
    pair_by_angle(triangles, points, group, pairs);
    groups.push_back(group);
  }
  pairs.same_way.clear();
  pairs.crowded.clear();
  Splitter(triangles, points, pairs, repairs).run(groups, context);
  return repairs;
}

}  // namespace tri

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "meshops/joining/crowded_edges.hpp"
#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

using Side = std::int32_t;
using Group = std::vector<Side>;
constexpr Side no_twin = SidePairs::none;

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
  Pace pace(context);
  std::vector<Side> partner(pairs.twin.size(), no_twin);
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
      pace();
      const std::uint32_t t = component[i];
      reversed += static_cast<std::size_t>(reverse[t]);
      for (Side side = static_cast<Side>(3 * t); side < static_cast<Side>(3 * t + 3); ++side) {
        const Side other = same[side] ? partner[side] : pairs.twin[side];
        if (other == no_twin || reverse[other / 3] != unseen) continue;
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

void turn_around(std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& which) {
  for (const std::uint32_t t : which) std::swap(triangles[t][1], triangles[t][2]);
}

void cut(SidePairs& pairs, Side side) {
  if (pairs.twin[side] == no_twin) return;
  pairs.twin[pairs.twin[side]] = no_twin;
  pairs.twin[side] = no_twin;
}

/// Gives every fan but the first of each vertex in `vertices` a copy of the vertex. Copies are numbered from
/// `points + copies.size()` on, in the order of vertices and of the first corner of each fan.
void split_vertices(std::vector<Triangle>& triangles, std::size_t points, const std::vector<std::uint32_t>& vertices,
                    const SidePairs& pairs, std::vector<std::uint32_t>& copies, const Context& context) {
  Pace pace(context);
  if (vertices.empty()) return;
  std::map<std::uint32_t, std::vector<Side>> corners;
  std::vector<char> wanted(points);
  for (const std::uint32_t v : vertices) wanted[v] = 1;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    pace();
    for (std::size_t k = 0; k < 3; ++k)
      if (wanted[triangles[i][k]]) corners[triangles[i][k]].push_back(static_cast<Side>(3 * i + k));
  }
  std::vector<char> seen(pairs.twin.size());
  for (const auto& [v, sides] : corners) {
    bool first = true;
    for (const Side corner : sides) {
      pace();
      if (seen[corner]) continue;
      Side start = corner;  // clockwise to the first triangle of an open fan, or once around
      while (pairs.twin[start] != no_twin) {
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
      for (Side side = start; side != no_twin && !seen[side]; side = pairs.twin[SidePairs::previous(side)]) {
        seen[side] = 1;
        triangles[side / 3][side % 3] = name;
      }
    }
  }
}

class Splitter {
 public:
  Splitter(std::vector<Triangle>& triangles, std::span<const Vec3> points, SidePairs& pairs, ManifoldRepairs& repairs,
           const Context& context)
      : triangles_(triangles), points_(points), pairs_(pairs), repairs_(repairs), context_(context) {}

  /// @param groups the sides of every edge that might be there twice
  void run(const std::vector<Group>& groups) {
    const std::vector<Triangle> unsplit = groups.empty() ? std::vector<Triangle>() : triangles_;
    split();
    std::vector<Group> twice = edges_there_twice(groups);
    if (twice.empty()) return;

    // Cutting the edge open often parts the two sheets; what still shares both ends then belongs together.
    context_.checkpoint();
    for (const Group& group : twice)
      for (const Side side : group) cut(pairs_, side);
    triangles_ = unsplit;
    split();
    for (const Group& group : twice) join_sides_between_same_vertices(group);
    triangles_ = unsplit;
    split();
    twice = edges_there_twice(groups);
    if (twice.empty()) return;

    context_.checkpoint();
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
    split_vertices(triangles_, points_.size(),
                   vertices_with_several_fans(triangles_, points_.size(), pairs_.twin, context_), pairs_,
                   repairs_.copied_points, context_);
  }

  std::map<Ends, Group> by_ends(const Group& group) const {
    std::map<Ends, Group> result;
    for (const Side side : group) result[edge_of(triangles_, side)].push_back(side);
    return result;
  }

  std::vector<Group> edges_there_twice(const std::vector<Group>& groups) const {
    Pace pace(context_, 1024);
    std::vector<Group> twice;
    for (const Group& group : groups) {
      pace();
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
  const Context& context_;
};

}  // namespace

ManifoldRepairs make_manifold(std::vector<Triangle>& triangles, std::span<const Vec3> points, SidePairs& pairs,
                              Context& context) {
  ManifoldRepairs repairs;
  if (!pairs.same_way.empty()) {
    repairs.reversed_triangles = triangles_to_reverse(triangles, pairs, context);
    turn_around(triangles, repairs.reversed_triangles);
    if (!repairs.reversed_triangles.empty()) pairs = pair_sides(triangles, points.size(), context);
  }
  std::vector<Group> groups;
  for (const auto& [a, b] : pairs.same_way) {
    repairs.cut.push_back(edge_of(triangles, a));
    groups.push_back({a, b});
  }
  if (!pairs.crowded.empty()) {
    const std::vector<std::uint32_t> turned = pair_crowded_sides(triangles, points, pairs, true, context);
    if (!turned.empty()) {
      turn_around(triangles, turned);
      std::vector<std::uint32_t> once;
      std::ranges::set_symmetric_difference(repairs.reversed_triangles, turned, std::back_inserter(once));
      repairs.reversed_triangles = std::move(once);
      pairs = pair_sides(triangles, points.size(), context);
      groups.clear();
      for (const auto& [a, b] : pairs.same_way) groups.push_back({a, b});
      pair_crowded_sides(triangles, points, pairs, false, context);
    }
  }
  for (const Group& group : pairs.crowded) {
    repairs.crowded.push_back(edge_of(triangles, group.front()));
    groups.push_back(group);
  }
  pairs.same_way.clear();
  pairs.crowded.clear();
  Splitter(triangles, points, pairs, repairs, context).run(groups);
  return repairs;
}

}  // namespace tri

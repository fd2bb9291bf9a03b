#include "meshops/joining/joined_points.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

using Side = std::int32_t;

/// The two points of a side, the lower one first, before the join.
struct Ends {
  std::uint32_t low = 0, high = 0;
  bool operator==(const Ends&) const = default;
};

class Joiner {
 public:
  Joiner(const Soup& soup, std::span<const std::uint32_t> cluster, const JoinRules& rules)
      : soup_(soup), cluster_(cluster), rules_(rules), sets_(soup.points.size()) {}

  JoinedPoints run(Context& context) {
    Pace pace(context);
    std::vector<Triangle> merged;
    for (std::uint32_t i = 0; i < soup_.triangles.size(); ++i) {
      pace();
      const Triangle& t = soup_.triangles[i];
      const Triangle m{cluster_[t[0]], cluster_[t[1]], cluster_[t[2]]};
      if (repeats_vertex(m)) {
        without_extent_.push_back(i);
        continue;
      }
      merged.push_back(m);
      source_.push_back(i);
    }
    const SidePairs pairs = pair_sides(merged, soup_.points.size(), context);
    for (Side side = 0; side < static_cast<Side>(pairs.twin.size()); ++side) {
      pace();
      if (pairs.twin[side] > side) join_two(side, pairs.twin[side]);
    }
    for (const auto& [a, b] : pairs.same_way) {
      pace();
      if (!rules_.opposite_only)
        join_two(a, b);
      else if (ends(a) != ends(b))
        ++result_.edges_refused;
    }
    for (const auto& crowd : pairs.crowded) {
      pace();
      join_crowd(crowd);
    }
    join_unused(pace);
    return finish(pace);
  }

 private:
  std::uint32_t corner(Side side) const {
    return soup_.triangles[source_[static_cast<std::size_t>(side / 3)]][side % 3];
  }
  Ends ends(Side side) const {
    const std::uint32_t a = corner(side), b = corner(SidePairs::next(side));
    return {std::min(a, b), std::max(a, b)};
  }

  /// Points of one cluster become one.
  void join_ends(Side a, Side b) {
    const std::uint32_t a0 = corner(a), a1 = corner(SidePairs::next(a));
    const std::uint32_t b0 = corner(b), b1 = corner(SidePairs::next(b));
    const bool same = cluster_[a0] == cluster_[b0];
    sets_.join(a0, same ? b0 : b1);
    sets_.join(a1, same ? b1 : b0);
  }

  void join_two(Side a, Side b) {
    if (ends(a) == ends(b)) return;
    join_ends(a, b);
    ++result_.edges_joined;
  }

  void join_crowd(const std::vector<Side>& crowd) {
    std::vector<Side> loose;
    std::size_t edges = 0;
    for (std::size_t i = 0; i < crowd.size(); ++i) {
      std::size_t same = 0, earlier = 0;
      for (std::size_t k = 0; k < crowd.size(); ++k) {
        same += ends(crowd[k]) == ends(crowd[i]);
        earlier += k < i && ends(crowd[k]) == ends(crowd[i]);
      }
      edges += earlier == 0;
      if (same == 1) loose.push_back(crowd[i]);
    }
    if (edges == 1) return;
    if (loose.size() == 2 && (!rules_.opposite_only || cluster_[corner(loose[0])] != cluster_[corner(loose[1])])) {
      join_ends(loose[0], loose[1]);
      ++result_.edges_joined;
    } else if (loose.size() > 2 && rules_.join_crowds) {
      for (std::size_t i = 1; i < loose.size(); ++i) join_ends(loose[0], loose[i]);
      ++result_.edges_crowded;
      edges -= loose.size() - 1;
    }
    if (edges > 1) ++result_.edges_refused;
  }

  void join_unused(Pace& pace) {
    std::vector<std::uint8_t> uses(soup_.points.size(), 0);
    for (const Triangle& t : soup_.triangles) {
      pace();
      for (const std::uint32_t v : t) uses[v] = static_cast<std::uint8_t>(std::min(uses[v] + 1, 2));
    }
    for (const std::uint32_t i : without_extent_) {
      const Triangle& t = soup_.triangles[i];
      if (repeats_vertex(t) || uses[t[0]] != 1 || uses[t[1]] != 1 || uses[t[2]] != 1) continue;
      for (const std::uint32_t v : t) sets_.join(v, cluster_[v]);
    }
    for (std::size_t i = 0; i < uses.size(); ++i)
      if (uses[i] == 0) sets_.join(i, cluster_[i]);
  }

  JoinedPoints finish(Pace& pace) {
    result_.first.resize(soup_.points.size());
    for (std::size_t i = 0; i < result_.first.size(); ++i) {
      pace();
      result_.first[i] = static_cast<std::uint32_t>(sets_.find(i));
      result_.points_apart += result_.first[i] == i && cluster_[i] != i;
    }
    return std::move(result_);
  }

  const Soup& soup_;
  std::span<const std::uint32_t> cluster_;
  JoinRules rules_;
  DisjointSets sets_;
  std::vector<std::uint32_t> source_;
  std::vector<std::uint32_t> without_extent_;  // two corners in one cluster
  JoinedPoints result_;
};

}  // namespace

JoinedPoints join_points(const Soup& soup, std::span<const std::uint32_t> cluster, const JoinRules& rules,
                         Context& context) {
  return Joiner(soup, cluster, rules).run(context);
}

std::uint64_t apply_join(Soup& soup, std::span<const std::uint32_t> first, const Context* context) {
  Pace pace(context);
  std::vector<std::uint32_t> number(first.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < first.size(); ++i) number[i] = first[i] == i ? next++ : number[first[i]];
  std::vector<char> repeated_before;
  for (const Triangle& t : soup.triangles) {
    pace();
    repeated_before.push_back(repeats_vertex(t));
  }
  renumber_points(soup, number, next, context);
  std::vector<char> keep;
  std::uint64_t dropped = 0;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    pace();
    keep.push_back(repeated_before[i] || !repeats_vertex(soup.triangles[i]));
    dropped += !keep.back();
  }
  if (dropped > 0) keep_triangles(soup, keep, context);
  return dropped;
}

std::vector<std::uint32_t> points_at_same_place(std::span<const Vec3> points, const Context* context) {
  Pace pace(context);
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> slots(std::bit_ceil(std::max<std::size_t>(2 * points.size(), 64)), none);
  std::vector<std::uint32_t> first(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    pace();
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      // Adding 0 turns -0 into 0, which compares equal and so must hash equal.
      hash = (hash ^ std::bit_cast<std::uint64_t>(points[i][k] + 0.0)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 32;
    }
    std::size_t at = hash & (slots.size() - 1);
    while (slots[at] != none && points[slots[at]] != points[i]) at = (at + 1) & (slots.size() - 1);
    if (slots[at] == none) slots[at] = i;
    first[i] = slots[at];
  }
  return first;
}

std::vector<char> points_on_loose_edges(const Soup& soup, Context& context) {
  Pace pace(context);
  std::vector<Triangle> whole;
  for (const Triangle& t : soup.triangles) {
    pace();
    if (!repeats_vertex(t)) whole.push_back(t);
  }
  const SidePairs pairs = pair_sides(whole, soup.points.size(), context);
  std::vector<char> paired(pairs.twin.size(), 0), result(soup.points.size(), 0);
  for (std::size_t side = 0; side < paired.size(); ++side) {
    pace();
    paired[side] = pairs.twin[side] != SidePairs::none;
  }
  for (const auto& [a, b] : pairs.same_way) paired[a] = paired[b] = 1;
  for (const auto& crowd : pairs.crowded)
    for (const Side side : crowd) paired[side] = 1;
  for (Side side = 0; side < static_cast<Side>(paired.size()); ++side) {
    pace();
    if (paired[side]) continue;
    const Side after = SidePairs::next(side);
    result[whole[side / 3][side % 3]] = result[whole[after / 3][after % 3]] = 1;
  }
  return result;
}

}  // namespace tri

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// How `join_points` treats edges that would come to lie on one another.
struct JoinRules {
  /// Of three or more loose edges (edges of one triangle) that fall together, all are joined; else none of them is.
  bool join_crowds = false;
  /// Loose edges are joined only if their triangles run along them in opposite directions.
  bool opposite_only = false;
};

/// Which points become one, and why others do not.
struct JoinedPoints {
  std::vector<std::uint32_t> first;  ///< for each point the lowest point that it becomes one with (itself if none)
  std::uint64_t edges_joined = 0;    ///< places where loose edges became one edge of two triangles
  std::uint64_t edges_crowded = 0;   ///< places where three or more loose edges became one
  std::uint64_t edges_refused = 0;   ///< places where edges that fall together stayed apart
  std::uint64_t points_apart = 0;    ///< points that stay apart from the lowest point of their cluster
};

/// Decides which points of each cluster become one: those whose loose edges fall together with other loose edges.
///
/// An edge that has two triangles already never gets more, so no edge becomes non-manifold that was manifold (but see
/// `JoinRules::join_crowds`), and points that would only touch, without an edge in common, stay apart, so no vertex
/// becomes non-manifold. Points that no triangle uses join the lowest point of their cluster; so do the points of a
/// triangle without extent that nothing else uses. O(points + triangles).
/// @param cluster for each point the lowest point of its cluster
JoinedPoints join_points(const Soup& soup, std::span<const std::uint32_t> cluster, const JoinRules& rules,
                         Context& context);

/// Makes points one as `first` says: each set takes position and attributes of its lowest point, triangles that come to
/// name a point twice are dropped, the rest keeps its order.
/// @return number of triangles dropped
/// @param context  null: cannot be cancelled
/// @throws Cancelled; the soup is then half done
std::uint64_t apply_join(Soup& soup, std::span<const std::uint32_t> first, const Context* context = nullptr);

/// For each point the lowest point at the same place (0 and -0 are the same). O(points).
/// @param context  null: cannot be cancelled
/// @throws Cancelled
std::vector<std::uint32_t> points_at_same_place(std::span<const Vec3> points, const Context* context = nullptr);

/// For each point whether it is the end of an edge of one triangle.
std::vector<char> points_on_loose_edges(const Soup& soup, Context& context);

/// Takes points of clusters out (each becomes its own) until joining the rest turns no triangle over: a triangle with
/// an area whose normal would turn by 90 degrees or more keeps its moved corners apart.
/// @param cluster changed in place
/// @param position where a set of points goes, by its lowest point; as long as `soup.points`
/// @param joined of `cluster`; on return of the clusters that are left
/// @return number of points taken out
template <class Position>
std::uint64_t keep_from_turning_over(const Soup& soup, std::vector<std::uint32_t>& cluster, const JoinRules& rules,
                                     Context& context, JoinedPoints& joined, const Position& position) {
  std::uint64_t taken_out = 0;
  while (true) {
    const std::vector<Vec3> moved = position(joined);
    std::vector<char> out(soup.points.size(), 0);
    std::uint64_t found = 0;
    for (const Triangle& t : soup.triangles) {
      if (moved[t[0]] == soup.points[t[0]] && moved[t[1]] == soup.points[t[1]] && moved[t[2]] == soup.points[t[2]])
        continue;
      const Vec3 before = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
      const Vec3 after = (moved[t[1]] - moved[t[0]]) % (moved[t[2]] - moved[t[0]]);
      if ((before | before) == 0 || (before | after) > 0) continue;
      for (const std::uint32_t v : t)
        if (moved[v] != soup.points[v]) out[joined.first[v]] = 1;
    }
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      if (!out[joined.first[i]]) continue;
      ++found;
      cluster[i] = static_cast<std::uint32_t>(i);
    }
    if (found == 0) return taken_out;
    taken_out += found;
    // A cluster whose lowest point was taken out goes by the lowest of the rest.
    std::vector<std::uint32_t> lowest(cluster.size(), 0xffffffff);
    for (std::uint32_t i = 0; i < cluster.size(); ++i)
      if (!out[joined.first[i]]) lowest[cluster[i]] = std::min(lowest[cluster[i]], i);
    for (std::uint32_t i = 0; i < cluster.size(); ++i)
      if (!out[joined.first[i]]) cluster[i] = lowest[cluster[i]];
    joined = join_points(soup, cluster, rules, context);
  }
}

}  // namespace tri

#include "meshops/holes/ring_untangling.hpp"

#include <algorithm>
#include <numeric>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/holes/ring_triangulation.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

constexpr int sizes[] = {12, 24, 48};
/// Of triangles that are weighed in one filling, by which the time is bounded: these and so many more for each edge.
constexpr std::size_t most_weighed = 50'000, most_weighed_at_edge = 10;

/// Fewest crossings first.
struct CrossingWeight {
  int crossings = 0;
  double area = 0;

  friend CrossingWeight operator+(const CrossingWeight& a, const CrossingWeight& b) {
    return {a.crossings + b.crossings, a.area + b.area};
  }
  friend bool operator<(const CrossingWeight& a, const CrossingWeight& b) {
    return a.crossings != b.crossings ? a.crossings < b.crossings : a.area < b.area;
  }
};

class Untangler {
 public:
  Untangler(std::span<const Vec3> ring, const RingSurroundings& surroundings, const Context& context)
      : ring_(ring), surroundings_(surroundings), context_(context) {}

  FillingCrossings find(std::span<const RingTriangle> triangles) const {
    FillingCrossings found;
    std::vector<char> in_doubt(triangles.size(), 1);
    if (surroundings_.in_doubt) in_doubt = surroundings_.in_doubt(triangles);
    std::vector<Triangle> named;
    std::vector<std::int32_t> number;  // in the filling, of each in `named`
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (t % 256 == 0) context_.checkpoint();
      if (!in_doubt[t] || !look_around(static_cast<std::int32_t>(t), triangles[t], found)) continue;
      named.push_back(names(triangles[t]));
      number.push_back(static_cast<std::int32_t>(t));
    }
    if (named.size() > 1)
      for (const auto& [t, u] : self_intersections(ring_, named, context_, Neighbors::judge))
        found.inside.push_back({number[t], number[u]});
    found.count += found.inside.size();
    return found;
  }

  void run(const ChordTest& chord_allowed, FillingCrossings found, std::vector<RingTriangle>& triangles,
           std::size_t& crossings) {
    std::vector<std::int32_t> all(ring_.size());
    std::iota(all.begin(), all.end(), 0);
    RingTriangulation surface(ring_, {}, chord_allowed, RingObjective::area, all, triangles);
    const std::size_t most = most_weighed + most_weighed_at_edge * ring_.size();
    for (const int size : sizes) {
      const std::vector<std::int32_t> tangled = taking_part(found, surface.triangles());
      if (tangled.empty()) break;
      const std::vector<RingTriangle> before = surface.triangles();
      const OverlapTree tree = tree_of(before);
      std::vector<char> seen(before.size(), 0);
      for (const std::int32_t t : tangled) {
        if (seen[t]) continue;
        if (weighed_ >= most) break;
        context_.checkpoint();
        surface.solve_piece(t, size, [&](auto piece, auto corners, std::vector<RingTriangle>& result) {
          for (const std::int32_t p : piece) seen[p] = 1;
          return solve(chord_allowed, surface.triangles(), tree, piece, corners, result);
        });
      }
      const std::size_t last = found.count;
      found = after_change(found, before, surface.triangles());
      if (found.count < crossings) {
        crossings = found.count;
        triangles = surface.triangles();
      }
      if (weighed_ >= most || (size > sizes[0] && found.count >= last)) break;
    }
  }

 private:
  /// What a triangle of the filling meets around the ring. @return whether it has an area
  bool look_around(std::int32_t t, const RingTriangle& triangle, FillingCrossings& found) const {
    const auto at = places(triangle);
    const bool has_area = triangle_has_area(at[0], at[1], at[2]);
    const int count = has_area ? surroundings_.crossings(triangle) : surroundings_.areas_wanted;
    if (count > 0) found.around.push_back({t, count});
    found.count += static_cast<std::size_t>(count);
    return has_area;
  }

  /// Those that take part in more than what is unavoidable, ascending.
  std::vector<std::int32_t> taking_part(const FillingCrossings& found, std::span<const RingTriangle> triangles) const {
    std::vector<std::int32_t> result;
    for (const auto& [t, count] : found.around)
      if (count > unavoidable(triangles[t])) result.push_back(t);
    for (const auto& pair : found.inside) result.insert(result.end(), pair.begin(), pair.end());
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  /// The crossings after some triangles were replaced by others in their places.
  FillingCrossings after_change(const FillingCrossings& before, std::span<const RingTriangle> was,
                                const std::vector<RingTriangle>& now) const {
    const auto changed = [&](std::int32_t t) { return was[t] != now[t]; };
    FillingCrossings found;
    std::size_t next = 0;  // of those that were
    const OverlapTree tree = tree_of(now);
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(now.size()); ++t) {
      const bool had = next < before.around.size() && before.around[next].triangle == t;
      if (!changed(t)) {
        if (had)
          found.around.push_back(before.around[next]),
              found.count += static_cast<std::size_t>(before.around[next].count);
        next += had;
        continue;
      }
      next += had;
      context_.checkpoint();
      if (!look_around(t, now[t], found)) continue;
      const auto at = places(now[t]);
      const TriangleBox triangle(at);
      tree.meeting(triangle, [&](std::uint32_t item) {
        const auto other = static_cast<std::int32_t>(item);
        if (other == t || (other < t && changed(other))) return;  // once for each pair
        const auto at_other = places(now[item]);
        if (!triangle.beside(at_other) && triangle_has_area(at_other[0], at_other[1], at_other[2]) &&
            triangles_meet(names(now[t]), at, names(now[item]), at_other))
          found.inside.push_back({std::min(t, other), std::max(t, other)});
      });
    }
    for (const auto& pair : before.inside)
      if (!changed(pair[0]) && !changed(pair[1])) found.inside.push_back(pair);
    found.count += found.inside.size();
    return found;
  }

  Triangle names(const RingTriangle& t) const {
    Triangle result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = static_cast<std::uint32_t>(surroundings_.same_as[t[k]]);
    return result;
  }
  int unavoidable(const RingTriangle& t) const {
    int least = 0;
    if (!surroundings_.unavoidable.empty())
      for (std::size_t k = 0; k < 3; ++k)
        if (t[(k + 1) % 3] == (t[k] + 1) % static_cast<std::int32_t>(ring_.size()))
          least = std::max(least, surroundings_.unavoidable[static_cast<std::size_t>(t[k])]);
    return least;
  }
  std::array<Vec3, 3> places(const RingTriangle& t) const { return {ring_[t[0]], ring_[t[1]], ring_[t[2]]}; }

  OverlapTree tree_of(const std::vector<RingTriangle>& triangles) const {
    std::vector<OverlapTree::Box> boxes(triangles.size());
    std::vector<std::uint32_t> items(triangles.size());
    std::iota(items.begin(), items.end(), 0u);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (const std::int32_t v : triangles[t]) boxes[t].grow(ring_[v]);
    return OverlapTree(std::move(boxes), std::move(items));
  }

  /// @param now  the filling; `tree` holds it as it was a few pieces ago, so a few crossings may be missed here
  bool solve(const ChordTest& chord_allowed, const std::vector<RingTriangle>& now, const OverlapTree& tree,
             std::span<const std::int32_t> piece, std::span<const std::int32_t> corners,
             std::vector<RingTriangle>& result) {
    std::vector<std::int32_t> own(piece.begin(), piece.end());
    std::sort(own.begin(), own.end());
    const auto weigh = [&](const RingTriangle& t, const auto& useful) -> std::optional<CrossingWeight> {
      const auto at = places(t);
      CrossingWeight weight{0, triangle_area(at[0], at[1], at[2])};
      if (!useful(weight)) return std::nullopt;
      ++weighed_;
      if (!triangle_has_area(at[0], at[1], at[2])) {
        weight.crossings = surroundings_.areas_wanted;
        return weight;
      }
      weight.crossings = surroundings_.crossings(t);
      if (weight.crossings > 0 && !useful(weight)) return std::nullopt;
      const TriangleBox triangle(at);
      tree.meeting(triangle, [&](std::uint32_t other) {
        if (std::binary_search(own.begin(), own.end(), static_cast<std::int32_t>(other))) return;
        const auto at_other = places(now[other]);
        if (triangle.beside(at_other)) return;
        if (triangle_has_area(at_other[0], at_other[1], at_other[2]) &&
            triangles_meet(names(t), at, names(now[other]), at_other))
          ++weight.crossings;
      });
      return weight;
    };
    CrossingWeight before;
    for (const std::int32_t t : piece) before = before + *weigh(now[t], [](const CrossingWeight&) { return true; });
    // Crossings within the piece: as if each took part in one.
    if (before.crossings == 0) before.crossings = 1;
    const auto least = triangulate_polygon<CrossingWeight>(
        static_cast<int>(corners.size()),
        [&](int i, int j) { return !chord_allowed || chord_allowed(corners[i], corners[j]); },
        [&](int i, int k, int j, int, int, const auto& useful) {
          return weigh({corners[i], corners[k], corners[j]}, useful);
        },
        result);
    return least && least->crossings < before.crossings;
  }

  std::span<const Vec3> ring_;
  const RingSurroundings& surroundings_;
  const Context& context_;
  std::size_t weighed_ = 0;
};

}  // namespace

FillingCrossings find_crossings(std::span<const Vec3> ring, const RingSurroundings& surroundings,
                                std::span<const RingTriangle> triangles, const Context& context) {
  return Untangler(ring, surroundings, context).find(triangles);
}

std::size_t untangle_filling(const Ring& ring, const RingSurroundings& surroundings, const FillingCrossings& crossings,
                             std::vector<RingTriangle>& triangles, const Context& context) {
  std::vector<RingTriangle> best = triangles;
  std::size_t least = crossings.count;
  Untangler(ring.points, surroundings, context).run(ring.chord_allowed, crossings, best, least);
  triangles = best;
  return least;
}

}  // namespace tri

#include "meshops/crossings/refill_crossings.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "meshops/checks/surface_reach.hpp"
#include "meshops/crossings/patched_triangles.hpp"
#include "meshops/holes/ring_untangling.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/closest_triangle.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/shape/triangle_normal.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr int most_rings = 3;
constexpr std::size_t most_patches_alone = 6;  ///< of a place: with more of them only all together are tried
constexpr std::size_t most_triangles = 2000;   ///< of what is cut out at one place
constexpr std::size_t most_to_untangle = 10;   ///< half of it, and one for every second edge
constexpr int dynamic_edges = 64;
constexpr std::size_t reach_pieces = 20'000;  ///< flat ones, much larger than what is allowed, take many

using Patch = std::vector<std::uint32_t>;  ///< triangles, ascending
using Pair = std::array<std::uint32_t, 2>;

/// A patch of one piece: its sides at the rim, in order.
struct Rim {
  std::vector<std::uint32_t> vertices, triangles;
  std::vector<std::size_t> sides;  ///< of those triangles
};

bool holds(const Patch& patch, std::uint32_t t) {
  return std::ranges::binary_search(patch, t);
}

class Refiller {
 public:
  Refiller(Soup& soup, double farthest, Context& context)
      : soup_(soup), farthest_(farthest), context_(context), mesh_(soup, &context) {}

  RefillReport run(std::span<const Pair> crossing) {
    RefillReport result;
    Pace pace(context_);
    for (const auto& [t, u] : crossing) pace(), partners_[t].push_back(u), partners_[u].push_back(t);
    const std::vector<std::vector<Pair>> places = places_of(crossing);
    for (std::size_t i = 0; i < places.size(); ++i) {
      context_.checkpoint();
      std::vector<Pair> pairs = places[i];
      std::erase_if(pairs, [&](const Pair& p) { return !mesh_.there(p[0]) || !mesh_.there(p[1]); });
      PlaceLeft left{{0, 0, 0}, pairs.size(), PlaceLeft::Reason::shape};
      if (pairs.empty() || refill(pairs, left.reason)) {
        ++result.refilled;
        continue;
      }
      for (const Vec3& p : mesh_.places(pairs[0][0])) left.at += p / 3.0;
      result.left.push_back(left);
    }
    return result;
  }

  /// Puts the fillings into the soup.
  void write(Report& report) {
    Pace pace(context_);
    std::vector<char> keep(mesh_.given());
    for (std::uint32_t t = 0; t < keep.size(); ++t) pace(), keep[t] = mesh_.there(t);
    for (const NewTriangle& t : added_) pace(), add_triangle_from(soup_, t.corners, t.source, t.corner_sources);
    report.faces_added = added_.size();
    report.faces_removed = static_cast<std::uint64_t>(std::ranges::count(keep, 0));
    std::vector<char> used(soup_.points.size(), 1);
    for (std::size_t t = 0; t < keep.size(); ++t, pace())
      if (!keep[t])
        for (const std::uint32_t v : soup_.triangles[t]) used[v] = 0;
    keep.resize(soup_.triangles.size(), 1);
    keep_triangles(soup_, keep, &context_);
    for (const Triangle& t : soup_.triangles) {
      pace();
      for (const std::uint32_t v : t) used[v] = 1;
    }
    std::vector<std::uint32_t> number(soup_.points.size());
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < number.size(); ++v) number[v] = used[v] ? count++ : dropped_point;
    report.vertices_removed = number.size() - count;
    renumber_points(soup_, number, count, &context_);
    for (std::size_t i = added_.size(); i > 0; --i)
      report.touched_faces.push_back(static_cast<std::uint32_t>(soup_.triangles.size() - i));
  }

 private:
  struct NewTriangle {
    Triangle corners;  ///< of the soup
    std::uint32_t source;
    std::array<std::size_t, 3> corner_sources;  ///< 3 triangle + corner, of the soup
  };

  std::vector<std::vector<Pair>> places_of(std::span<const Pair> crossing) {
    std::vector<std::uint32_t> triangles;
    for (const Pair& p : crossing) triangles.insert(triangles.end(), p.begin(), p.end());
    std::ranges::sort(triangles);
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    const auto number = [&](std::uint32_t t) {
      return static_cast<std::size_t>(std::ranges::lower_bound(triangles, t) - triangles.begin());
    };
    DisjointSets sets(triangles.size());
    Pace pace(context_);
    for (const Pair& p : crossing) pace(), sets.join(number(p[0]), number(p[1]));
    for (std::size_t i = 0; i < triangles.size(); ++i, pace())
      for (std::size_t k = 0; k < 3; ++k)
        if (const std::uint32_t other = mesh_.beyond(triangles[i], k);
            other != PatchedTriangles::none && holds(triangles, other))
          sets.join(i, number(other));
    std::map<std::size_t, std::vector<Pair>> places;
    for (const Pair& p : crossing) places[sets.find(number(p[0]))].push_back(p);
    std::vector<std::vector<Pair>> result;
    for (auto& [root, pairs] : places) result.push_back(std::move(pairs));
    return result;
  }

  /// The pieces of a set of triangles that hang together over sides.
  std::vector<Patch> pieces_of(const Patch& all) const {
    std::vector<Patch> pieces;
    std::set<std::uint32_t> seen;
    for (const std::uint32_t seed : all) {
      if (!seen.insert(seed).second) continue;
      Patch piece{seed};
      for (std::size_t i = 0; i < piece.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t other = mesh_.beyond(piece[i], k);
          if (other != PatchedTriangles::none && holds(all, other) && seen.insert(other).second) piece.push_back(other);
        }
      std::ranges::sort(piece);
      pieces.push_back(std::move(piece));
    }
    return pieces;
  }

  /// With the triangles at its corners that are reached over sides at them.
  Patch grown(const Patch& patch) const {
    Patch result = patch;
    std::set<std::uint32_t> seen(patch.begin(), patch.end());
    for (const std::uint32_t t : patch)
      for (const std::uint32_t corner : mesh_.corners(t)) {
        Patch fan{t};
        for (std::size_t i = 0; i < fan.size(); ++i)
          for (std::size_t k = 0; k < 3; ++k) {
            const Triangle& v = mesh_.corners(fan[i]);
            if (v[k] != corner && v[(k + 1) % 3] != corner) continue;
            const std::uint32_t other = mesh_.beyond(fan[i], k);
            if (other != PatchedTriangles::none && seen.insert(other).second) fan.push_back(other);
          }
        result.insert(result.end(), fan.begin() + 1, fan.end());
      }
    std::ranges::sort(result);
    return result;
  }

  bool refill(const std::vector<Pair>& pairs, PlaceLeft::Reason& reason) {
    Patch all;
    for (const Pair& p : pairs) all.insert(all.end(), p.begin(), p.end());
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::vector<Patch> patches = pieces_of(all);
    const auto settles = [&](const Patch& patch) {
      return std::ranges::all_of(pairs, [&](const Pair& p) { return holds(patch, p[0]) || holds(patch, p[1]); });
    };
    for (int ring = 0; ring <= most_rings; ++ring) {
      if (ring > 0)
        for (Patch& patch : patches) patch = grown(patch);
      std::ranges::stable_sort(patches, {}, [](const Patch& p) { return p.size(); });
      if (patches.size() > 1 && patches.size() <= most_patches_alone)
        for (const Patch& patch : patches)
          if (settles(patch) && replace(patch, all, reason)) return true;
      Patch together;
      for (const Patch& patch : patches) together.insert(together.end(), patch.begin(), patch.end());
      std::ranges::sort(together);
      together.erase(std::unique(together.begin(), together.end()), together.end());
      if (replace(together, all, reason)) return true;
    }
    return false;
  }

  /// Whether one of the triangles crosses another outside of them and of the place: what is put there would, too.
  bool crosses_elsewhere(const Patch& all, const Patch& place) const {
    return std::ranges::any_of(all, [&](std::uint32_t t) {
      const auto partners = partners_.find(t);
      return partners != partners_.end() && std::ranges::any_of(partners->second, [&](std::uint32_t u) {
               return mesh_.there(u) && !holds(all, u) && !holds(place, u);
             });
    });
  }

  /// Replaces each piece of a set of triangles, or nothing.
  bool replace(const Patch& all, const Patch& place, PlaceLeft::Reason& reason) {
    context_.checkpoint();
    if (all.back() >= mesh_.given() || all.size() > most_triangles) return false;
    if (crosses_elsewhere(all, place)) {
      reason = std::max(reason, PlaceLeft::Reason::crosses);
      return false;
    }
    const std::vector<Patch> pieces = pieces_of(all);
    std::vector<Rim> rims;
    for (const Patch& piece : pieces) {
      rims.push_back(rim_of(piece));
      if (rims.back().vertices.empty()) return false;
    }
    const std::uint32_t first = mesh_.size();
    const std::size_t added = added_.size();
    for (const std::uint32_t t : all) mesh_.take_out(t);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (fill(pieces[i], rims[i], reason)) continue;
      mesh_.forget_from(first);
      added_.resize(added);
      for (const std::uint32_t t : all) mesh_.put_back(t);
      return false;
    }
    return true;
  }

  /// Empty unless the patch is a disk that meets itself nowhere.
  Rim rim_of(const Patch& patch) const {
    std::map<std::uint32_t, std::pair<std::uint32_t, std::size_t>> from;  // the side at the rim that starts at a vertex
    std::set<std::uint32_t> vertices;
    std::size_t inner = 0;
    for (const std::uint32_t t : patch)
      for (std::size_t k = 0; k < 3; ++k) {
        vertices.insert(mesh_.corners(t)[k]);
        const std::uint32_t other = mesh_.beyond(t, k);
        if (other != PatchedTriangles::none && holds(patch, other))
          ++inner;
        else if (!from.emplace(mesh_.corners(t)[k], std::pair(t, k)).second)
          return {};
      }
    if (from.size() < 3 || vertices.size() + patch.size() != inner / 2 + from.size() + 1) return {};
    Rim rim;
    const std::uint32_t start = from.begin()->first;
    for (std::uint32_t v = start; rim.vertices.size() < from.size();) {
      const auto side = from.find(v);
      if (side == from.end()) return {};
      const auto [t, k] = side->second;
      rim.vertices.push_back(v);
      rim.triangles.push_back(t);
      rim.sides.push_back(k);
      v = mesh_.corners(t)[(k + 1) % 3];
      if (v == start) break;
    }
    return rim.vertices.size() == from.size() ? rim : Rim{};
  }

  /// Of a patch that was taken out.
  Ring ring_of(const Rim& rim) const {
    Ring ring;
    std::map<std::uint32_t, int> position;
    for (std::size_t i = 0; i < rim.vertices.size(); ++i) {
      position[rim.vertices[i]] = static_cast<int>(i);
      ring.points.push_back(mesh_.point(rim.vertices[i]));
      const std::uint32_t other = mesh_.beyond(rim.triangles[i], rim.sides[i]);
      Vec3 normal(0, 0, 0);
      if (other != PatchedTriangles::none) {
        const std::array<Vec3, 3> at = mesh_.places(other);
        normal = triangle_normal(at[0], at[1], at[2]);
      }
      ring.edge_normals.push_back(normal);
    }
    std::vector<std::pair<int, int>> forbidden;
    for (const auto& [vertex, i] : position)
      mesh_.at_vertex(vertex, [&, i = i](std::uint32_t t) {
        for (const std::uint32_t v : mesh_.corners(t))
          if (const auto other = position.find(v); other != position.end() && other->second > i)
            forbidden.emplace_back(i, other->second);
      });
    std::ranges::sort(forbidden);
    const int n = static_cast<int>(rim.vertices.size());
    ring.chord_allowed = [forbidden = std::move(forbidden), n](int i, int j) {
      return j == i + 1 || (i == 0 && j == n - 1) || !std::ranges::binary_search(forbidden, std::pair(i, j));
    };
    return ring;
  }

  bool fill(const Patch& patch, const Rim& rim, PlaceLeft::Reason& reason) {
    const Ring ring = ring_of(rim);
    // A filling lies within the rim's box.
    OverlapTree::Box box;
    for (const Vec3& p : ring.points) box.grow(p);
    for (const std::uint32_t t : patch)
      for (const Vec3& p : mesh_.places(t))
        for (int k = 0; k < 3; ++k)
          if (p[k] < box.lo[k] - farthest_ || p[k] > box.hi[k] + farthest_) return too_far(reason);
    RingSurroundings surroundings;
    for (std::size_t i = 0; i < rim.vertices.size(); ++i) surroundings.same_as.push_back(static_cast<std::int32_t>(i));
    const auto named = [&](const RingTriangle& t) {
      return Triangle{rim.vertices[t[0]], rim.vertices[t[1]], rim.vertices[t[2]]};
    };
    surroundings.areas_wanted = true;
    surroundings.crossings = [&](const RingTriangle& t) { return mesh_.crossings(named(t)); };
    for (const HoleStrategy strategy :
         {HoleStrategy::least_bending, HoleStrategy::nearest_diagonal, HoleStrategy::minimum_area}) {
      RingFilling filling = fill_ring(ring, strategy, dynamic_edges, context_);
      if (filling.triangles.empty()) return false;
      const FillingCrossings found = find_crossings(ring.points, surroundings, filling.triangles, context_);
      std::size_t crossings = found.count;
      // Where more crosses, the rim does, which no filling helps.
      if (strategy == HoleStrategy::least_bending && crossings > 0 &&
          2 * crossings <= most_to_untangle + ring.points.size())
        crossings = untangle_filling(ring, surroundings, found, filling.triangles, context_);
      if (crossings > 0) {
        reason = std::max(reason, PlaceLeft::Reason::crosses);
        continue;
      }
      if (!near(patch, ring, filling.triangles)) return too_far(reason);
      for (const RingTriangle& t : filling.triangles) take(rim, t, named(t));
      return true;
    }
    return false;
  }

  static bool too_far(PlaceLeft::Reason& reason) {
    reason = PlaceLeft::Reason::too_far;
    return false;
  }

  bool near(const Patch& patch, const Ring& ring, const std::vector<RingTriangle>& filling) const {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles, filled;
    for (const std::uint32_t t : patch) {
      const auto n = static_cast<std::uint32_t>(points.size());
      for (const Vec3& p : mesh_.places(t)) points.push_back(p);
      triangles.push_back({n, n + 1, n + 2});
    }
    for (const RingTriangle& t : filling)
      filled.push_back(
          {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])});
    const auto within = [&](const std::vector<Vec3>& from, const std::vector<Triangle>& these,
                            const ClosestTriangle& to) {
      std::uint32_t hint = 0;
      return std::ranges::all_of(these, [&](const Triangle& t) {
        context_.checkpoint();
        return reach_of({from[t[0]], from[t[1]], from[t[2]]}, to, farthest_, reach_pieces, hint).verdict ==
               ReachOfTriangle::Verdict::within;
      });
    };
    return within(points, triangles, ClosestTriangle(ring.points, filled)) &&
           within(ring.points, filled, ClosestTriangle(points, triangles));
  }

  /// Adds a triangle. Its values come from the triangle of the patch at the rim with which it has most corners in
  /// common.
  void take(const Rim& rim, const RingTriangle& t, const Triangle& named) {
    NewTriangle fresh{};
    std::ptrdiff_t most = 0;
    for (const std::int32_t at : t)
      for (const std::int32_t side : {at, (at > 0 ? at : static_cast<std::int32_t>(rim.triangles.size())) - 1}) {
        const std::uint32_t candidate = rim.triangles[side];
        const std::ptrdiff_t common = std::ranges::count_if(
            mesh_.corners(candidate), [&](std::uint32_t v) { return std::ranges::find(named, v) != named.end(); });
        if (common > most) most = common, fresh.source = candidate;
      }
    const Triangle& source = mesh_.corners(fresh.source);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto same = std::ranges::find(source, named[k]);
      // Else from the side at the rim that starts there.
      const std::size_t corner = same != source.end()
                                     ? 3 * std::size_t{fresh.source} + static_cast<std::size_t>(same - source.begin())
                                     : 3 * std::size_t{rim.triangles[t[k]]} + rim.sides[t[k]];
      fresh.corner_sources[k] = corner;
      fresh.corners[k] = soup_.triangles[corner / 3][corner % 3];
    }
    added_.push_back(fresh);
    mesh_.add(named);
  }

  Soup& soup_;
  const double farthest_;
  Context& context_;
  PatchedTriangles mesh_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> partners_;  ///< which triangles each crosses
  std::vector<NewTriangle> added_;
};

}  // namespace

RefillReport refill_crossings(Soup& soup, std::span<const std::array<std::uint32_t, 2>> crossing, double farthest,
                              Report& report, Context& context) {
  if (crossing.empty()) return {};
  Refiller refiller(soup, farthest, context);
  RefillReport result = refiller.run(crossing);
  if (result.refilled > 0) refiller.write(report);
  return result;
}

}  // namespace tri

#include "meshops/crossings/arrangement/cut_tips.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "meshops/crossings/arrangement/settle_moves.hpp"
#include "meshops/crossings/arrangement/triangle_meeting.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/overlap_tree.hpp"

namespace tri {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr double tip_share = 0.25;  ///< of the shortest edge of a fan: as far from the tip as it is cut
/// How the cuts lean off the edges, which others may lie on, to the side that goes or is filled, as a share of how far
/// from the tip they are. Below 0 they lean away from it, which widens a slit. Ends of slits apart.
struct Lean {
  double edges, ends;
};
constexpr std::array leans{Lean{0.25, 0.25}, Lean{-0.25, 0.25}, Lean{-0.25, -0.25},
                           Lean{0.03, 0.03}, Lean{-0.03, 0.03}, Lean{-0.03, -0.03}};
constexpr double slit = 0.3;     ///< length of the sum of two unit normals at an edge below which they face each other
constexpr double least_cut = 6;  ///< grid steps
constexpr double tip_lowering = 0.25;
constexpr double most_heights = 25;  ///< where nothing nearer fits

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? v / length : Vec3(0, 0, 0);
}

double angle_turned(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a | (b % c);
}

/// A polygon on the sphere, the region to its left cut into triangles by ears with short third sides.
/// @return triples of places in `around`; none if no ear can be cut, as where the region is more than half of the
/// sphere
std::optional<std::vector<std::array<std::size_t, 3>>> ears_of(const std::vector<Vec3>& around) {
  std::vector<std::size_t> left(around.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<std::array<std::size_t, 3>> ears;
  while (left.size() >= 3) {
    const std::size_t n = left.size();
    std::size_t best = n;
    double nearest = -2;
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t ia = left[(j + n - 1) % n], ib = left[j], ic = left[(j + 1) % n];
      const Vec3 &a = around[ia], &b = around[ib], &c = around[ic];
      if (!(angle_turned(a, b, c) > 0) || !((a | c) > nearest)) continue;
      const bool clear = std::ranges::all_of(left, [&](std::size_t i) {
        const Vec3& p = around[i];
        return i == ia || i == ib || i == ic || angle_turned(a, b, p) < 0 || angle_turned(b, c, p) < 0 ||
               angle_turned(c, a, p) < 0;
      });
      if (clear) best = j, nearest = a | c;
    }
    if (best == n) return std::nullopt;
    ears.push_back({left[(best + n - 1) % n], left[best], left[(best + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return ears;
}

class Cutter {
 public:
  Cutter(PlacedBoundary& boundary, double height) : out_(boundary), height_(height) {}

  std::size_t run(Context& context) {
    std::map<GridPoint, std::vector<std::uint32_t>> crowds = find_crowds(context);
    if (crowds.empty()) return 0;
    prepare(crowds, context);
    // A fan that is cut makes room for others, also for those that touched it at the other end of an edge.
    for (bool any = true; any;) {
      any = false;
      for (auto& [place, fans] : crowds) {
        context.checkpoint();
        for (std::size_t i = 0; i < fans.size() && fans.size() > 1;) {
          if (!cut(fans[i])) {
            ++i;
            continue;
          }
          fans.erase(fans.begin() + static_cast<std::ptrdiff_t>(i));
          any = true;
        }
      }
    }
    std::size_t left = 0;
    for (const auto& [place, fans] : crowds) left += fans.size() - 1;
    return left;
  }

 private:
  std::map<GridPoint, std::vector<std::uint32_t>> find_crowds(const Context& context) const {
    Pace pace(context);
    std::vector<char> used(out_.points.size(), 0);
    for (const Triangle& t : out_.triangles) {
      pace();
      for (const std::uint32_t v : t) used[v] = 1;
    }
    const std::vector<char> shared = share_places(out_.points, used, context);
    std::map<GridPoint, std::vector<std::uint32_t>> crowds;
    for (std::uint32_t v = 0; v < used.size(); ++v)
      if (shared[v]) crowds[out_.points[v]].push_back(v);
    return crowds;
  }

  void prepare(const std::map<GridPoint, std::vector<std::uint32_t>>& crowds, const Context& context) {
    Pace pace(context);
    for (const auto& [place, fans] : crowds)
      for (const std::uint32_t v : fans) at_.emplace(v, std::vector<std::uint32_t>{});
    std::vector<OverlapTree::Box> boxes;
    for (std::uint32_t t = 0; t < out_.triangles.size(); ++t) {
      pace();
      boxes.push_back(box_of(corners(out_.triangles[t])));
      for (const std::uint32_t v : out_.triangles[t])
        if (const auto found = at_.find(v); found != at_.end()) found->second.push_back(t);
    }
    std::vector<std::uint32_t> items(boxes.size());
    std::iota(items.begin(), items.end(), 0u);
    pieces_.resize(boxes.size());
    whole_.resize(boxes.size());
    std::iota(whole_.begin(), whole_.end(), 0u);
    tree_.emplace(std::move(boxes), std::move(items), &context);
  }

  GridTriangle corners(const Triangle& t) const { return {out_.points[t[0]], out_.points[t[1]], out_.points[t[2]]}; }

  static OverlapTree::Box box_of(const GridTriangle& corners) {
    OverlapTree::Box box;
    for (const GridPoint& p : corners) box.grow(vector_of(p));
    return box;
  }

  /// The triangles of a fan in turn: triangle i runs from the vertex to `ring[i]` and `ring[i + 1]`.
  struct Fan {
    std::vector<std::uint32_t> ring, triangles;
  };

  std::optional<Fan> fan_of(std::uint32_t v) const {
    std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> next;  // from -> to, triangle
    for (const std::uint32_t t : at_.at(v)) {
      const Triangle& c = out_.triangles[t];
      const std::size_t k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
      if (!next.emplace(c[(k + 1) % 3], std::pair{c[(k + 2) % 3], t}).second) return std::nullopt;
    }
    if (next.size() < 3) return std::nullopt;
    Fan fan;
    std::uint32_t at = next.begin()->first;
    do {
      const auto found = next.find(at);
      if (found == next.end() || fan.ring.size() == next.size()) return std::nullopt;
      fan.ring.push_back(at);
      fan.triangles.push_back(found->second.second);
      at = found->second.first;
    } while (at != fan.ring[0]);
    if (fan.ring.size() != next.size()) return std::nullopt;
    return fan;
  }

  bool cut(std::uint32_t v) {
    const std::optional<Fan> fan = fan_of(v);
    if (!fan) return false;
    double most = most_heights * height_;
    for (const std::uint32_t r : fan->ring)
      most = std::min(most, tip_share * (vector_of(out_.points[r]) - vector_of(out_.points[v])).norm());
    std::vector<double> distances;
    for (double far = std::min(height_, most); far >= least_cut; far *= tip_lowering) distances.push_back(far);
    for (double far = height_ / tip_lowering; far < most / tip_lowering; far /= tip_lowering)
      distances.push_back(std::min(far, most));
    for (const double far : distances)
      for (const Lean& lean : leans)
        for (const bool within : {true, false})
          if (cut(v, *fan, far, lean, within)) return true;
    return false;
  }

  /// @param within  whether the tip goes, else what lies before it is filled
  bool cut(std::uint32_t v, const Fan& fan, double far, const Lean& lean, bool within) {
    const std::size_t n = fan.ring.size();
    const Vec3 tip = vector_of(out_.points[v]);
    std::vector<Vec3> towards, side;
    for (const std::uint32_t r : fan.ring) towards.push_back(unit(vector_of(out_.points[r]) - tip));
    for (std::size_t i = 0; i < n; ++i) side.push_back(unit(towards[i] % towards[(i + 1) % n]) * (within ? -1 : 1));
    const std::size_t first_point = out_.points.size();
    std::vector<Vec3> around;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 &before = towards[(i + n - 1) % n], &after = towards[(i + 1) % n],
                 sum = side[i] + side[(i + n - 1) % n];
      const Vec3 off = sum.norm() > slit
                           ? unit(sum) * lean.edges
                           : unit(before + after - towards[i] * (towards[i] | (before + after))) * lean.ends;
      const Vec3 p = tip + (towards[i] + off) * far;
      GridPoint g;
      for (int k = 0; k < 3; ++k) g[k] = static_cast<std::int64_t>(std::floor(p[k] + 0.5));
      out_.points.push_back(g);
      around.push_back(unit(vector_of(g) - tip));
    }
    if (within) std::ranges::reverse(around);
    std::optional<std::vector<std::array<std::size_t, 3>>> ears = ears_of(around);
    std::vector<Triangle> fresh;
    if (ears) {
      const auto cut_at = [&](std::size_t i) { return static_cast<std::uint32_t>(first_point + i % n); };
      for (std::size_t i = 0; i < n; ++i) fresh.push_back({cut_at(i), fan.ring[i], fan.ring[(i + 1) % n]});
      for (std::size_t i = 0; i < n; ++i) fresh.push_back({cut_at(i), fan.ring[(i + 1) % n], cut_at(i + 1)});
      for (const auto& [a, b, c] : *ears)
        fresh.push_back(within ? Triangle{cut_at(n - 1 - c), cut_at(n - 1 - b), cut_at(n - 1 - a)}
                               : Triangle{cut_at(a), cut_at(b), cut_at(c)});
    }
    if (!ears || !fits(fresh, fan, first_point)) {
      out_.points.resize(first_point);
      return false;
    }
    take(v, fan, fresh);
    return true;
  }

  void take(std::uint32_t v, const Fan& fan, const std::vector<Triangle>& fresh) {
    const std::size_t n = fan.ring.size();
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      // The outer part of each triangle keeps its number; of the cap, each triangle counts to the fan's first.
      const std::uint32_t of = fan.triangles[i < 2 * n ? i % n : 0];
      std::uint32_t t = of;
      if (i < n) {
        out_.triangles[t] = fresh[i];
      } else {
        t = static_cast<std::uint32_t>(out_.triangles.size());
        out_.triangles.push_back(fresh[i]);
        out_.face.push_back(out_.face[of]);
        whole_.push_back(whole_[of]);
        pieces_[whole_[of]].push_back(t);
      }
      for (const std::uint32_t c : fresh[i])
        if (const auto found = at_.find(c); found != at_.end() && i >= n) found->second.push_back(t);
    }
    at_[v].clear();
    out_.point.resize(out_.points.size(), none);
    out_.moved.resize(out_.points.size(), 0);
    ++out_.parted;
  }

  /// Whether triangles that are to take the place of a fan meet nothing but in corners and sides.
  /// @param first_point  from it on, points are new: each needs a place of its own
  bool fits(const std::vector<Triangle>& fresh, const Fan& fan, std::size_t first_point) {
    const auto lies_on_corner = [&](const Triangle& t) {
      return std::any_of(
          out_.points.begin() + static_cast<std::ptrdiff_t>(first_point), out_.points.end(), [&](const GridPoint& p) {
            return std::ranges::any_of(t, [&](std::uint32_t v) { return v < first_point && out_.points[v] == p; });
          });
    };
    std::vector<GridPoint> places(out_.points.begin() + static_cast<std::ptrdiff_t>(first_point), out_.points.end());
    std::ranges::sort(places);
    if (std::ranges::adjacent_find(places) != places.end()) return false;
    for (const Triangle& t : fresh) {
      const GridTriangle c = corners(t);
      if (normal_of(c[0], c[1], c[2]) == GridPoint{}) return false;
    }
    for (std::size_t i = 0; i < fresh.size(); ++i)
      for (std::size_t j = i + 1; j < fresh.size(); ++j)
        if (meets(fresh[i], fresh[j])) return false;
    const double margin = 2 * most_heights * height_ + 2;  // pieces may have left the box of what they were cut from
    for (const Triangle& t : fresh) {
      const OverlapTree::Box mine = box_of(corners(t));
      OverlapTree::Box box = mine;
      box.lo -= Vec3(1, 1, 1) * margin, box.hi += Vec3(1, 1, 1) * margin;
      bool clear = true;
      const auto look = [&](std::uint32_t u) {
        if (!clear || std::ranges::find(fan.triangles, u) != fan.triangles.end()) return;
        const Triangle& other = out_.triangles[u];
        if (mine.overlaps(box_of(corners(other))) && (lies_on_corner(other) || meets(t, other))) clear = false;
      };
      tree_->overlapping(box, 0, [&](std::uint32_t u) {
        look(u);
        for (const std::uint32_t piece : pieces_[u]) look(piece);
      });
      if (!clear) return false;
    }
    return true;
  }

  bool meets(const Triangle& a, const Triangle& b) {
    const GridTriangle p = corners(a), q = corners(b);
    // The same number for corners in the same place.
    Triangle ids{0, 1, 2}, other{3, 4, 5};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (q[i] == p[k]) other[i] = static_cast<std::uint32_t>(k);
    if (std::ranges::all_of(other, [](std::uint32_t i) { return i < 3; })) return true;
    meet(p, ids, q, other, meeting_);
    return meeting_.cuts();
  }

  PlacedBoundary& out_;
  const double height_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> at_;  ///< of vertices that touch others: their
                                                                      ///< triangles
  std::vector<std::vector<std::uint32_t>> pieces_;  ///< of the triangles that there were: those added for them
  std::vector<std::uint32_t> whole_;                ///< of every triangle: the one that there was
  std::optional<OverlapTree> tree_;                 ///< of the triangles that there were
  TriangleMeeting meeting_;
};

}  // namespace

std::size_t cut_tips(PlacedBoundary& boundary, double height, Context& context) {
  return Cutter(boundary, height).run(context);
}

}  // namespace tri

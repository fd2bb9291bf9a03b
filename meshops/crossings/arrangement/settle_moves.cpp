#include "meshops/crossings/arrangement/settle_moves.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/crossings/arrangement/triangle_meeting.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/overlap_tree.hpp"

namespace tri {
namespace {

constexpr double lowering = 0.25;  ///< of the way of what makes something cross
constexpr int most_rounds = 200;
constexpr int last_sweeps = 2;

class Settler {
 public:
  Settler(std::vector<GridPoint>& points, const std::vector<Triangle>& triangles, std::vector<VertexMove>& moves,
          double least, const Context& context)
      : context_(context), points_(points), triangles_(triangles), moves_(moves), least_(least),
        owner_(points.size(), no_index), around_(moves.size()), places_((place_all(), points), &context),
        tree_(boxes(), all_items(), &context) {}

  void run(std::vector<char> changed) {
    std::vector<double> wanted;
    for (const VertexMove& m : moves_) wanted.push_back(m.height);
    std::vector<char> active(triangles_.size());
    for (int round = 0; round < most_rounds; ++round) {
      context_.checkpoint();
      std::fill(active.begin(), active.end(), 0);
      for (std::uint32_t i = 0; i < moves_.size(); ++i)
        if (changed[i])
          for (const std::uint32_t t : around_[i]) active[t] = 1;
      const std::vector<char> bad = rejected(active);
      std::fill(changed.begin(), changed.end(), 0);
      bool any = false;
      for (std::uint32_t i = 0; i < moves_.size(); ++i) {
        if (!bad[i] || moves_[i].height < 1) continue;
        move(i, lower(moves_[i]));
        changed[i] = any = true;
      }
      if (!any) break;
    }
    // Some rest only because they were beside one that cannot move.
    for (int sweep = 0; sweep < last_sweeps; ++sweep) {
      bool any = false;
      for (std::uint32_t i = 0; i < moves_.size(); ++i) {
        if (i % 256 == 0) context_.checkpoint();
        if (moves_[i].height > 0 || !(wanted[i] > 0) || !moves_[i].may_rest) continue;
        move(i, wanted[i]);
        while (moves_[i].height > 0 && !fits(i)) move(i, lower(moves_[i]));
        any |= moves_[i].height > 0;
      }
      if (!any) return;
    }
  }

 private:
  double lower(const VertexMove& m) const {
    const double height = m.height * lowering;
    return height < (m.may_rest ? least_ : 1) ? 0 : height;
  }

  void place(const VertexMove& m) {
    const Vec3 p = m.base + m.direction * m.height;
    for (int k = 0; k < 3; ++k) points_[m.vertex][k] = static_cast<std::int64_t>(std::floor(p[k] + 0.5));
  }

  void place_all() {
    Pace pace(context_);
    for (std::uint32_t i = 0; i < moves_.size(); ++i) {
      pace();
      owner_[moves_[i].vertex] = i;
      place(moves_[i]);
      reach_ = std::max(reach_, 2 * moves_[i].height + 2);
    }
    for (std::uint32_t t = 0; t < triangles_.size(); ++t, pace())
      for (const std::uint32_t v : triangles_[t])
        if (owner_[v] != no_index) around_[owner_[v]].push_back(t);
  }

  void move(std::uint32_t i, double height) {
    moves_[i].height = height;
    place(moves_[i]);
    places_.update(moves_[i].vertex);
  }

  GridTriangle corners(std::uint32_t t) const {
    const Triangle& v = triangles_[t];
    return {points_[v[0]], points_[v[1]], points_[v[2]]};
  }

  OverlapTree::Box box_of(std::uint32_t t) const {
    OverlapTree::Box box;
    for (const GridPoint& p : corners(t)) box.grow(vector_of(p));
    return box;
  }

  std::vector<OverlapTree::Box> boxes() const {
    Pace pace(context_);
    std::vector<OverlapTree::Box> all;
    all.reserve(triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t, pace()) all.push_back(box_of(t));
    return all;
  }

  std::vector<std::uint32_t> all_items() const {
    std::vector<std::uint32_t> items(triangles_.size());
    for (std::uint32_t t = 0; t < items.size(); ++t) items[t] = t;
    return items;
  }

  Triangle named(std::uint32_t t) const {
    const Triangle& v = triangles_[t];
    return {places_.number(v[0]), places_.number(v[1]), places_.number(v[2])};
  }

  static bool repeats(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

  static bool same_corners(Triangle a, Triangle b) {
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    return a == b;
  }

  bool is_flat(std::uint32_t t) const {
    const GridTriangle c = corners(t);
    return normal_of(c[0], c[1], c[2]) == GridPoint{};
  }

  /// Calls `found(u)` for each triangle that meets triangle `t` in more than corners and sides, until it returns false.
  /// @param skip whether a triangle is not looked at
  void crossing(std::uint32_t t, const auto& skip, const auto& found) {
    const GridTriangle mine = corners(t);
    const Triangle my = named(t);
    if (repeats(my)) return;
    const OverlapTree::Box now = box_of(t);
    OverlapTree::Box box = now;
    box.lo -= Vec3(1, 1, 1) * reach_, box.hi += Vec3(1, 1, 1) * reach_;
    bool more = true;
    tree_.overlapping(box, 0, [&](std::uint32_t u) {
      if (!more || u == t || skip(u) || !now.overlaps(box_of(u)) || is_flat(u)) return;
      const Triangle their = named(u);
      if (repeats(their) || same_corners(my, their)) return;
      meet(mine, my, corners(u), their, meeting_);
      if (meeting_.cuts()) more = found(u);
    });
  }

  /// Of each move: whether it takes part in a crossing of an active triangle.
  std::vector<char> rejected(const std::vector<char>& active) {
    std::vector<char> bad(moves_.size(), 0);
    const auto reject = [&](std::uint32_t t) {
      for (const std::uint32_t v : triangles_[t])
        if (owner_[v] != no_index) bad[owner_[v]] = 1;
    };
    for (std::uint32_t i = 0; i < moves_.size(); ++i)
      if (moves_[i].height >= 1 && places_.crowded(moves_[i].vertex)) bad[i] = 1;
    Pace pace(context_, 256);
    for (std::uint32_t t = 0; t < active.size(); ++t) {
      if (!active[t]) continue;
      pace();
      if (is_flat(t)) {
        reject(t);
        continue;
      }
      crossing(
          t, [&](std::uint32_t u) { return active[u] && u < t; },
          [&](std::uint32_t u) {
            reject(t), reject(u);
            return true;
          });
    }
    return bad;
  }

  bool fits(std::uint32_t i) {
    if (places_.crowded(moves_[i].vertex)) return false;
    bool clear = true;
    for (const std::uint32_t t : around_[i]) {
      if (!clear || is_flat(t)) return false;
      crossing(
          t, [](std::uint32_t) { return false; }, [&](std::uint32_t) { return clear = false; });
    }
    return clear;
  }

  const Context& context_;
  std::vector<GridPoint>& points_;
  const std::vector<Triangle>& triangles_;
  std::vector<VertexMove>& moves_;
  const double least_;
  std::vector<std::uint32_t> owner_;                ///< of vertices: the move
  std::vector<std::vector<std::uint32_t>> around_;  ///< of moves: the triangles
  double reach_ = 4;                                ///< how far a box may have left its place in the tree
  GridPlaces places_;
  const OverlapTree tree_;
  TriangleMeeting meeting_;
};

}  // namespace

std::vector<char> share_places(const std::vector<GridPoint>& points, const std::vector<char>& used,
                               const Context& context) {
  Pace pace(context);
  NumberMap<GridPoint, GridHash> first(points.size());
  std::vector<char> shared(points.size(), 0);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    pace();
    if (!used[v]) continue;
    if (const auto [same, added] = first.insert(points[v], v); !added) shared[same] = shared[v] = 1;
  }
  return shared;
}

void settle_moves(std::vector<GridPoint>& points, const std::vector<Triangle>& triangles,
                  std::vector<VertexMove>& moves, std::vector<char> changed, double least, Context& context) {
  Settler(points, triangles, moves, least, context).run(std::move(changed));
}

}  // namespace tri

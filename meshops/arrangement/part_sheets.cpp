#include "meshops/arrangement/part_sheets.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "meshops/arrangement/grid_hash.hpp"
#include "meshops/arrangement/triangle_meeting.hpp"
#include "meshops/overlap_tree.hpp"

namespace tri {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr double edge_share = 0.25;      ///< of the shortest edge at a vertex: as far as it moves
constexpr double inradius_share = 0.1;   ///< of a triangle: as high as its middle is raised
constexpr double least_slope = 0.2;      ///< of a vertex's direction towards the side of each sheet
constexpr int slope_steps = 40;
constexpr double lowering = 0.25;        ///< of the way of what makes something cross
constexpr double least_share = 1.0 / 64; ///< of the way of a vertex that may stay: what is less is not worth it
constexpr int most_rounds = 200;

Vec3 vector_of(const GridPoint& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? v / length : Vec3(0, 0, 0);
}

/// A vertex that leaves its place.
struct Move {
  std::uint32_t vertex;
  Vec3 base, direction;  ///< unit
  double height;         ///< grid steps
  bool may_rest;         ///< else it has to move by a step at least
};

/// Numbers for places, and how many vertices are in each.
class Places {
 public:
  explicit Places(const std::vector<GridPoint>& points) : points_(points), number_(points.size()) {
    seen_.reserve(points.size());
    for (std::uint32_t v = 0; v < points.size(); ++v) enter(v);
  }
  std::uint32_t number(std::uint32_t v) const { return number_[v]; }
  bool crowded(std::uint32_t v) const { return count_[number_[v]] > 1; }
  /// After a point was changed.
  void update(std::uint32_t v) {
    --count_[number_[v]];
    enter(v);
  }

 private:
  void enter(std::uint32_t v) {
    number_[v] = seen_.emplace(points_[v], static_cast<std::uint32_t>(count_.size())).first->second;
    if (number_[v] == count_.size()) count_.push_back(0);
    ++count_[number_[v]];
  }

  const std::vector<GridPoint>& points_;
  std::unordered_map<GridPoint, std::uint32_t, GridHash> seen_;
  std::vector<std::uint32_t> number_, count_;
};

class Parter {
 public:
  Parter(const CrossingComplex& complex, const SolidBoundary& boundary, double height, SheetMemory& memory)
      : c_(complex), b_(boundary), height_(height), memory_(memory) {}

  PlacedBoundary run(Context& context) {
    for (const auto& [point, place] : b_.vertices) {
      out_.points.push_back(place);
      out_.point.push_back(point);
    }
    out_.triangles = b_.triangles;
    out_.face = b_.face;
    move_copies(context);
    raise_middles(context);
    out_.moved.resize(out_.points.size(), 0);
    return std::move(out_);
  }

 private:
  /// Vertices in one place move apart, each to its own side of the sheets at it, or into its own solid.
  void move_copies(Context& context) {
    std::vector<char> used(out_.points.size(), 0);
    for (const Triangle& t : out_.triangles)
      for (const std::uint32_t v : t) used[v] = 1;
    std::unordered_map<GridPoint, std::uint32_t, GridHash> count;
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v]) ++count[out_.points[v]];
    std::vector<std::uint32_t> number(out_.points.size(), none);
    std::vector<std::vector<std::uint32_t>> around;
    for (std::uint32_t t = 0; t < out_.triangles.size(); ++t)
      for (const std::uint32_t v : out_.triangles[t]) {
        if (count[out_.points[v]] < 2) continue;
        if (number[v] == none) number[v] = static_cast<std::uint32_t>(around.size()), around.emplace_back();
        around[number[v]].push_back(t);
      }
    std::vector<Move> moves;
    for (std::uint32_t v = 0; v < number.size(); ++v)
      if (number[v] != none) moves.push_back(move_of(v, around[number[v]]));
    std::erase_if(moves, [](const Move& m) { return m.height < 1; });
    settle(moves, context);
    out_.moved.assign(out_.points.size(), 0);
    for (const Move& m : moves) out_.moved[m.vertex] = m.height > 0;
    out_.parted = moves.size();
  }

  Move move_of(std::uint32_t v, const std::vector<std::uint32_t>& triangles) const {
    Move move{v, vector_of(out_.points[v]), {0, 0, 0}, height_, true};
    std::vector<Vec3> sheets, solids;
    for (const std::uint32_t t : triangles) {
      const Triangle& c = out_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        const double length = (vector_of(out_.points[c[k]]) - vector_of(out_.points[c[(k + 1) % 3]])).norm();
        move.height = std::min(move.height, edge_share * length);
      }
      const Vec3 n = unit((vector_of(out_.points[c[1]]) - vector_of(out_.points[c[0]])) %
                          (vector_of(out_.points[c[2]]) - vector_of(out_.points[c[0]])));
      if (b_.sheet[t] == 0) solids.push_back(-n);
      else sheets.push_back(n * b_.sheet[t]);
    }
    std::vector<Vec3> all = sheets;
    all.insert(all.end(), solids.begin(), solids.end());
    const double slope = direction_towards(all, move.direction);
    if (slope <= 0 && !sheets.empty() && direction_towards(sheets, move.direction) <= 0) move.height = 0;
    return move;
  }

  /// A direction that leans towards all `sides`, if there is one: whatever it leans away from is added to it.
  /// @return how far it leans towards the one that it leans to least, as a cosine
  static double direction_towards(const std::vector<Vec3>& sides, Vec3& direction) {
    Vec3 at(0, 0, 0);
    for (const Vec3& s : sides) at += s;
    at = unit(at);
    double best = -2;
    for (int step = 0; step < slope_steps; ++step) {
      double least = 2;
      std::size_t worst = 0;
      for (std::size_t i = 0; i < sides.size(); ++i)
        if (const double slope = at | sides[i]; slope < least) least = slope, worst = i;
      if (least > best) best = least, direction = at;
      if (least >= least_slope) break;
      at = unit(at + sides[worst] * 0.5);
    }
    return best;
  }

  /// Sheets that still lie upon each other, because no corner could move, get a vertex in their middle.
  void raise_middles(Context& context) {
    const std::vector<std::uint32_t> place = numbers_by_place();
    std::vector<std::pair<Triangle, std::uint32_t>> keys;
    for (std::uint32_t t = 0; t < out_.triangles.size(); ++t) {
      if (b_.sheet[t] == 0) continue;
      Triangle key;
      for (std::size_t k = 0; k < 3; ++k) key[k] = place[out_.triangles[t][k]];
      std::sort(key.begin(), key.end());
      keys.emplace_back(key, t);
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::uint32_t> lying;
    for (std::size_t i = 0; i < keys.size(); ++i)
      if ((i > 0 && keys[i - 1].first == keys[i].first) || (i + 1 < keys.size() && keys[i + 1].first == keys[i].first))
        lying.push_back(keys[i].second);
    std::sort(lying.begin(), lying.end());
    std::vector<Move> moves;
    for (const std::uint32_t t : lying) moves.push_back(raise(t));
    out_.parted += moves.size();
    settle(moves, context);
    for (const Move& m : moves)
      if (m.height < 1) out_.touching.push_back(raised_from_[m.vertex - b_.vertices.size()]);
    std::sort(out_.touching.begin(), out_.touching.end());
    out_.touching.erase(std::unique(out_.touching.begin(), out_.touching.end()), out_.touching.end());
  }

  Move raise(std::uint32_t t) {
    const Triangle v = out_.triangles[t];
    const Vec3 a = vector_of(out_.points[v[0]]), b = vector_of(out_.points[v[1]]), c = vector_of(out_.points[v[2]]);
    const Vec3 n = (b - a) % (c - a);
    const double la = (b - c).norm(), lb = (c - a).norm(), lc = (a - b).norm();
    const double twice_area = n.norm();
    const double inradius = twice_area / (la + lb + lc);
    Move m{static_cast<std::uint32_t>(out_.points.size()), (a * la + b * lb + c * lc) / (la + lb + lc),
           n * (b_.sheet[t] / twice_area), std::max(1.0, std::min(height_, inradius_share * inradius)), false};
    out_.points.push_back(out_.points[v[0]]);
    out_.point.push_back(none);
    raised_from_.push_back(b_.face[t]);
    out_.triangles[t] = {v[0], v[1], m.vertex};
    for (int k = 1; k < 3; ++k) {
      out_.triangles.push_back({v[k], v[(k + 1) % 3], m.vertex});
      out_.face.push_back(b_.face[t]);
    }
    return m;
  }

  void place(const Move& m) {
    const Vec3 p = m.base + m.direction * m.height;
    for (int k = 0; k < 3; ++k) out_.points[m.vertex][k] = static_cast<std::int64_t>(std::floor(p[k] + 0.5));
  }

  GridTriangle corners(std::uint32_t t) const {
    const Triangle& v = out_.triangles[t];
    return {out_.points[v[0]], out_.points[v[1]], out_.points[v[2]]};
  }

  OverlapTree::Box box_of(std::uint32_t t) const {
    OverlapTree::Box box;
    for (const GridPoint& p : corners(t)) box.grow(vector_of(p));
    return box;
  }

  /// The same number for vertices in the same place: they touch, which is no crossing.
  std::vector<std::uint32_t> numbers_by_place() const {
    Places places(out_.points);
    std::vector<std::uint32_t> number(out_.points.size());
    for (std::uint32_t v = 0; v < number.size(); ++v) number[v] = places.number(v);
    return number;
  }

  /// Moves the vertices as far as they want, and shortens the way of those that make something cross or meet until nothing does.
  /// What may rest rests where less than a step is left; of what may not, `height` is then less than 1.
  void settle(std::vector<Move>& moves, Context& context) {
    if (moves.empty()) return;
    // What has moved before, and as far as then, needs to be looked at only beside what has not.
    std::vector<char> changed(moves.size(), 1);
    const auto key = [](const Move& m) {
      return std::array{m.base[0], m.base[1], m.base[2], m.direction[0], m.direction[1], m.direction[2]};
    };
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (const auto known = memory_.find(key(moves[i])); known != memory_.end())
        moves[i].height = known->second, changed[i] = 0;
    settle_from(moves, changed, context);
    for (const Move& m : moves) memory_[key(m)] = m.height;
  }

  void settle_from(std::vector<Move>& moves, std::vector<char>& changed, Context& context) {
    std::vector<std::uint32_t> owner(out_.points.size(), none);
    double reach = 2;
    for (std::uint32_t i = 0; i < moves.size(); ++i) {
      owner[moves[i].vertex] = i;
      place(moves[i]);
      reach = std::max(reach, moves[i].height + 2);
    }
    std::vector<std::vector<std::uint32_t>> around(moves.size());
    std::vector<OverlapTree::Box> boxes(out_.triangles.size());
    std::vector<std::uint32_t> items(out_.triangles.size());
    for (std::uint32_t t = 0; t < items.size(); ++t) {
      items[t] = t, boxes[t] = box_of(t);
      for (const std::uint32_t v : out_.triangles[t])
        if (owner[v] != none) around[owner[v]].push_back(t);
    }
    const OverlapTree tree(boxes, items);
    Places places(out_.points);
    const double least_height = std::max(1.0, height_ * least_share);
    std::vector<char> active(out_.triangles.size());
    TriangleMeeting meeting;
    for (int round = 0; round < most_rounds; ++round) {
      context.checkpoint();
      std::vector<char> bad(moves.size(), 0);
      const auto reject = [&](std::uint32_t t) {
        for (const std::uint32_t v : out_.triangles[t])
          if (owner[v] != none) bad[owner[v]] = 1;
      };
      for (std::uint32_t i = 0; i < moves.size(); ++i)
        if (moves[i].height >= 1 && places.crowded(moves[i].vertex)) bad[i] = 1;
      std::fill(active.begin(), active.end(), 0);
      for (std::uint32_t i = 0; i < moves.size(); ++i)
        if (changed[i])
          for (const std::uint32_t t : around[i]) active[t] = 1;
      for (std::uint32_t t = 0; t < active.size(); ++t) {
        if (!active[t]) continue;
        const GridTriangle mine = corners(t);
        if (normal_of(mine[0], mine[1], mine[2]) == GridPoint{}) reject(t);
        const Triangle my = named(t, places);
        if (my[0] == my[1] || my[1] == my[2] || my[2] == my[0]) continue;
        OverlapTree::Box box = box_of(t);
        box.lo -= Vec3(1, 1, 1) * reach, box.hi += Vec3(1, 1, 1) * reach;
        const OverlapTree::Box now = box_of(t);
        tree.overlapping(box, 0, [&](std::uint32_t u) {
          if (u == t || (active[u] && u < t) || !now.overlaps(box_of(u))) return;
          const GridTriangle theirs = corners(u);
          if (normal_of(theirs[0], theirs[1], theirs[2]) == GridPoint{}) return;
          const Triangle their = named(u, places);
          if (their[0] == their[1] || their[1] == their[2] || their[2] == their[0] || same_corners(my, their)) return;
          meet(mine, my, theirs, their, meeting);
          if (meeting.cuts()) reject(t), reject(u);
        });
      }
      std::fill(changed.begin(), changed.end(), 0);
      bool any = false;
      for (std::uint32_t i = 0; i < moves.size(); ++i) {
        Move& m = moves[i];
        if (!bad[i] || m.height < 1) continue;
        m.height *= lowering;
        if (m.height < (m.may_rest ? least_height : 1)) m.height = 0;
        changed[i] = any = true;
        place(m);
        places.update(m.vertex);
      }
      if (!any) return;
    }
  }

  static bool same_corners(Triangle a, Triangle b) {
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    return a == b;
  }

  Triangle named(std::uint32_t t, const Places& places) const {
    const Triangle& v = out_.triangles[t];
    return {places.number(v[0]), places.number(v[1]), places.number(v[2])};
  }

  const CrossingComplex& c_;
  const SolidBoundary& b_;
  const double height_;
  SheetMemory& memory_;
  PlacedBoundary out_;
  std::vector<std::uint32_t> raised_from_;  ///< of each raised middle: the face of the complex
};

}  // namespace

PlacedBoundary part_sheets(const CrossingComplex& complex, const SolidBoundary& boundary, double height, SheetMemory& memory,
                           Context& context) {
  return Parter(complex, boundary, height, memory).run(context);
}

}  // namespace tri

#include "meshops/crossings/arrangement/part_sheets.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/crossings/arrangement/grid_hash.hpp"
#include "meshops/crossings/arrangement/settle_moves.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

constexpr double edge_share = 0.25;     ///< of the shortest edge at a vertex: as far as it moves
constexpr double inradius_share = 0.1;  ///< of a triangle: as high as its middle is raised
constexpr double least_slope = 0.2;     ///< of a vertex's direction towards the side of each sheet
constexpr double along_slope = 1e-3;    ///< of it away from a side that counts as along
constexpr int slope_steps = 40;
constexpr double least_share = 1.0 / 64;  ///< of the way of a vertex that may stay: what is less is not worth it

class Parter {
 public:
  Parter(const CrossingComplex& complex, const SolidBoundary& boundary, double height, SheetMemory& memory)
      : c_(complex), b_(boundary), height_(height), memory_(memory) {}

  PlacedBoundary run(Context& context) {
    Pace pace(context);
    for (const auto& [point, place] : b_.vertices) {
      pace();
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
    Pace pace(context);
    for (const Triangle& t : out_.triangles) {
      pace();
      for (const std::uint32_t v : t) used[v] = 1;
    }
    const std::vector<char> shared = share_places(out_.points, used, context);
    std::vector<std::uint32_t> number(out_.points.size(), no_index);
    std::vector<std::vector<std::uint32_t>> around;
    for (std::uint32_t t = 0; t < out_.triangles.size(); ++t, pace())
      for (const std::uint32_t v : out_.triangles[t]) {
        if (!shared[v]) continue;
        if (number[v] == no_index) number[v] = static_cast<std::uint32_t>(around.size()), around.emplace_back();
        around[number[v]].push_back(t);
      }
    std::vector<VertexMove> moves;
    for (std::uint32_t v = 0; v < number.size(); ++v)
      if (number[v] != no_index) moves.push_back(move_of(v, around[number[v]]));
    std::erase_if(moves, [](const VertexMove& m) { return m.height < 1; });
    settle(moves, context);
    out_.moved.assign(out_.points.size(), 0);
    for (const VertexMove& m : moves) out_.moved[m.vertex] = m.height > 0;
    out_.parted = moves.size();
  }

  VertexMove move_of(std::uint32_t v, const std::vector<std::uint32_t>& triangles) const {
    VertexMove move{v, vector_of(out_.points[v]), {0, 0, 0}, height_, true};
    std::vector<Vec3> sheets, solids;
    for (const std::uint32_t t : triangles) {
      const Triangle& c = out_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        const double length = (vector_of(out_.points[c[k]]) - vector_of(out_.points[c[(k + 1) % 3]])).norm();
        move.height = std::min(move.height, edge_share * length);
      }
      const Vec3 n = unit_or_zero((vector_of(out_.points[c[1]]) - vector_of(out_.points[c[0]])) %
                                  (vector_of(out_.points[c[2]]) - vector_of(out_.points[c[0]])));
      if (b_.sheet[t] == 0)
        solids.push_back(-n);
      else
        sheets.push_back(n * b_.sheet[t]);
    }
    std::vector<Vec3> all = sheets;
    all.insert(all.end(), solids.begin(), solids.end());
    if (direction_towards(all, move.direction) > 0 || direction_along(all, move.direction) || sheets.empty())
      return move;
    if (direction_towards(sheets, move.direction) > 0 || direction_along(sheets, move.direction)) return move;
    move.height = 0;
    return move;
  }

  /// A direction that leans towards all `sides`, if there is one: whatever it leans away from is added to it.
  /// @return how far it leans towards the one that it leans to least, as a cosine
  static double direction_towards(const std::vector<Vec3>& sides, Vec3& direction) {
    Vec3 at(0, 0, 0);
    for (const Vec3& s : sides) at += s;
    at = unit_or_zero(at);
    double best = -2;
    for (int step = 0; step < slope_steps; ++step) {
      double least = 2;
      std::size_t worst = 0;
      for (std::size_t i = 0; i < sides.size(); ++i)
        if (const double slope = at | sides[i]; slope < least) least = slope, worst = i;
      if (least > best) best = least, direction = at;
      if (least >= least_slope) break;
      at = unit_or_zero(at + sides[worst] * 0.5);
    }
    return best;
  }

  /// A direction that leans away from no side, if there is one, as where a fan has both sides of a sheet: the sum of
  /// the sides, taken to the half-space of each in turn.
  static bool direction_along(const std::vector<Vec3>& sides, Vec3& direction) {
    Vec3 at(0, 0, 0);
    for (const Vec3& s : sides) at += s;
    at = unit_or_zero(at);
    for (int step = 0; step < slope_steps; ++step)
      for (const Vec3& s : sides) at -= s * std::min(0.0, at | s);
    if (at.norm() < least_slope) return false;
    at = unit_or_zero(at);
    for (const Vec3& s : sides)
      if ((at | s) < -along_slope) return false;
    direction = at;
    return true;
  }

  /// Sheets that still lie upon each other, because no corner could move, get a vertex in their middle.
  void raise_middles(Context& context) {
    if (std::ranges::all_of(b_.sheet, [](signed char s) { return s == 0; })) return;
    const std::vector<std::uint32_t> place = numbers_by_place(context);
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
    std::vector<VertexMove> moves;
    for (const std::uint32_t t : lying) {
      const Triangle& v = out_.triangles[t];
      if (normal_of(out_.points[v[0]], out_.points[v[1]], out_.points[v[2]]) == GridPoint{})
        out_.touching.push_back(b_.face[t]);
      else
        moves.push_back(raise(t));
    }
    out_.parted += moves.size();
    settle(moves, context);
    for (const VertexMove& m : moves)
      if (m.height < 1) out_.touching.push_back(raised_from_[m.vertex - b_.vertices.size()]);
    std::sort(out_.touching.begin(), out_.touching.end());
    out_.touching.erase(std::unique(out_.touching.begin(), out_.touching.end()), out_.touching.end());
  }

  VertexMove raise(std::uint32_t t) {
    const Triangle v = out_.triangles[t];
    const Vec3 a = vector_of(out_.points[v[0]]), b = vector_of(out_.points[v[1]]), c = vector_of(out_.points[v[2]]);
    const Vec3 n = (b - a) % (c - a);
    const double la = (b - c).norm(), lb = (c - a).norm(), lc = (a - b).norm();
    const double twice_area = n.norm();
    const double inradius = twice_area / (la + lb + lc);
    VertexMove m{static_cast<std::uint32_t>(out_.points.size()), (a * la + b * lb + c * lc) / (la + lb + lc),
                 n * (b_.sheet[t] / twice_area), std::max(1.0, std::min(height_, inradius_share * inradius)), false};
    out_.points.push_back(out_.points[v[0]]);
    out_.point.push_back(no_index);
    raised_from_.push_back(b_.face[t]);
    out_.triangles[t] = {v[0], v[1], m.vertex};
    for (int k = 1; k < 3; ++k) {
      out_.triangles.push_back({v[k], v[(k + 1) % 3], m.vertex});
      out_.face.push_back(b_.face[t]);
    }
    return m;
  }

  /// The same number for vertices in the same place: they touch, which is no crossing.
  std::vector<std::uint32_t> numbers_by_place(const Context& context) const {
    const GridPlaces places(out_.points, &context);
    std::vector<std::uint32_t> number(out_.points.size());
    for (std::uint32_t v = 0; v < number.size(); ++v) number[v] = places.number(v);
    return number;
  }

  void settle(std::vector<VertexMove>& moves, Context& context) {
    if (moves.empty()) return;
    // What has moved before, and as far as then, needs to be looked at only beside what has not.
    std::vector<char> changed(moves.size(), 1);
    const auto key = [](const VertexMove& m) {
      return std::array{m.base[0], m.base[1], m.base[2], m.direction[0], m.direction[1], m.direction[2]};
    };
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (const auto known = memory_.find(key(moves[i])); known != memory_.end())
        moves[i].height = known->second, changed[i] = 0;
    settle_moves(out_.points, out_.triangles, moves, changed, std::max(1.0, height_ * least_share), context);
    for (const VertexMove& m : moves) memory_[key(m)] = m.height;
  }

  const CrossingComplex& c_;
  const SolidBoundary& b_;
  const double height_;
  SheetMemory& memory_;
  PlacedBoundary out_;
  std::vector<std::uint32_t> raised_from_;  ///< of each raised middle: the face of the complex
};

}  // namespace

PlacedBoundary part_sheets(const CrossingComplex& complex, const SolidBoundary& boundary, double height,
                           SheetMemory& memory, Context& context) {
  return Parter(complex, boundary, height, memory).run(context);
}

}  // namespace tri

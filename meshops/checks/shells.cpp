#include "meshops/checks/shells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "meshops/crossings/predicates.hpp"
#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

using SoupBox = OverlapTree::Box;

SoupBox triangle_box(const Soup& soup, const Triangle& t) {
  SoupBox box;
  for (const std::uint32_t v : t) box.grow(soup.points[v]);
  return box;
}

OverlapTree shell_tree(const Soup& soup, std::span<const std::uint32_t> listed, const Context* context) {
  Pace pace(context);
  std::vector<SoupBox> boxes;
  for (const std::uint32_t t : listed) pace(), boxes.push_back(triangle_box(soup, soup.triangles[t]));
  std::vector<std::uint32_t> items(listed.size());
  std::iota(items.begin(), items.end(), 0u);
  return {std::move(boxes), std::move(items), context};
}

/// Side of q from p to r in the plane of coordinates `x` and `y`; q counts as moved by (e, e^2) for an infinitely small
/// e.
int moved_orientation(const Vec3& p, const Vec3& r, const Vec3& q, int x, int y) {
  const int sign = orientation_exact(Vec2(p[x], p[y]), Vec2(r[x], r[y]), Vec2(q[x], q[y]));
  if (sign != 0) return sign;
  if (r[y] != p[y]) return r[y] > p[y] ? -1 : 1;
  return r[x] > p[x] ? 1 : r[x] < p[x] ? -1 : 0;
}

/// Whether a place in the plane of a triangle lies in it.
bool in_flat(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  for (int k = 0; k < 3; ++k) {
    const auto side = [&](const Vec3& p, const Vec3& r, const Vec3& s) {
      return orientation_exact(Vec2(p[k], p[(k + 1) % 3]), Vec2(r[k], r[(k + 1) % 3]), Vec2(s[k], s[(k + 1) % 3]));
    };
    const int turn = side(a, b, c);
    if (turn == 0) continue;  // seen edge on
    return side(a, b, q) * turn >= 0 && side(b, c, q) * turn >= 0 && side(c, a, q) * turn >= 0;
  }
  return false;
}

class ShellFinder {
 public:
  ShellFinder(const Soup& soup, Context& context) : soup_(soup), pace_(context) {}

  Shells run(Context& context) {
    for (std::uint32_t i = 0; i < soup_.triangles.size(); ++i) {
      pace_();
      if (repeats_vertex(soup_.triangles[i])) continue;
      whole_.push_back(soup_.triangles[i]);
      source_.push_back(i);
    }
    pairs_ = pair_sides(whole_, soup_.points.size(), context);
    result_.of_triangle.assign(soup_.triangles.size(), Shells::none);
    result_.reversed.assign(soup_.triangles.size(), 0);
    collect(context);
    close();
    measure();
    return std::move(result_);
  }

 private:
  using Side = std::int32_t;

  std::uint32_t from(Side side) const { return whole_[static_cast<std::size_t>(side / 3)][side % 3]; }
  std::uint32_t apex(Side side) const { return from(SidePairs::previous(side)); }
  std::uint32_t shell(Side side) const { return result_.of_triangle[source_[static_cast<std::size_t>(side / 3)]]; }
  bool reversed(Side side) const { return result_.reversed[source_[static_cast<std::size_t>(side / 3)]] != 0; }

  void collect(Context& context) {
    SidePairs::Sides partner = pairs_.twin;
    std::vector<char> same(partner.size(), 0);
    for (const auto& [a, b] : pairs_.same_way) {
      if (apex(a) == apex(b)) continue;
      partner[a] = b;
      partner[b] = a;
      same[a] = same[b] = 1;
    }
    std::vector<std::uint32_t> queue;
    for (std::uint32_t seed = 0; seed < whole_.size(); ++seed) {
      if (result_.of_triangle[source_[seed]] != Shells::none) continue;
      context.checkpoint();
      const auto id = static_cast<std::uint32_t>(result_.shells.size());
      Shell& s = result_.shells.emplace_back();
      queue.assign(1, seed);
      result_.of_triangle[source_[seed]] = id;
      for (std::size_t i = 0; i < queue.size(); ++i) {
        pace_();
        const std::uint32_t t = source_[queue[i]];
        s.triangles.push_back(t);
        s.reversed += result_.reversed[t] != 0;
        for (Side side = static_cast<Side>(3 * queue[i]); side < static_cast<Side>(3 * queue[i] + 3); ++side) {
          const Side other = partner[side];
          if (other == SidePairs::none) continue;
          const std::uint32_t next = source_[static_cast<std::size_t>(other / 3)];
          if (result_.of_triangle[next] != Shells::none) continue;
          result_.of_triangle[next] = id;
          result_.reversed[next] = static_cast<char>(result_.reversed[t] ^ same[side]);
          queue.push_back(static_cast<std::uint32_t>(other / 3));
        }
      }
      if (2 * s.reversed > s.triangles.size()) {
        s.reversed = s.triangles.size() - s.reversed;
        for (const std::uint32_t t : s.triangles) result_.reversed[t] ^= 1;
      }
    }
    // Each list in increasing order, which costs no sorting.
    for (Shell& s : result_.shells) s.triangles.clear();
    for (const std::uint32_t t : source_) {
      pace_();
      result_.shells[result_.of_triangle[t]].triangles.push_back(t);
    }
    for (Side side = 0; side < static_cast<Side>(partner.size()); ++side) {
      pace_();
      if (partner[side] <= side || (reversed(side) != reversed(partner[side])) == (same[side] != 0)) continue;
      const std::uint32_t a = from(side), b = from(SidePairs::next(side));
      result_.one_sided.push_back({std::min(a, b), std::max(a, b)});
    }
  }

  void close() {
    std::vector<Shell>& shells = result_.shells;
    for (Shell& s : shells) s.closed = true;
    std::vector<char> settled(pairs_.twin.size(), 0);
    for (Side side = 0; side < static_cast<Side>(settled.size()); ++side) {
      pace_();
      if (pairs_.twin[side] == SidePairs::none) continue;
      settled[side] = 1;
      if (reversed(side) != reversed(pairs_.twin[side])) shells[shell(side)].closed = false;
    }
    for (const auto& [a, b] : pairs_.same_way) {
      pace_();
      settled[a] = settled[b] = 1;
      if (shell(a) == shell(b) && reversed(a) != reversed(b)) continue;
      shells[shell(a)].closed = shells[shell(b)].closed = false;
    }
    std::map<std::uint32_t, int> balance;
    for (const auto& crowd : pairs_.crowded) {
      pace_();
      balance.clear();
      const std::uint32_t a = from(crowd[0]);
      for (const Side side : crowd) {
        settled[side] = 1;
        balance[shell(side)] += (from(side) == a) != reversed(side) ? 1 : -1;
      }
      for (const auto& [id, sum] : balance)
        if (sum != 0) shells[id].closed = false;
    }
    for (Side side = 0; side < static_cast<Side>(settled.size()); ++side) {
      pace_();
      if (!settled[side]) shells[shell(side)].closed = false;
    }
  }

  void measure() {
    for (Shell& s : result_.shells) {
      const Vec3 origin = soup_.points[soup_.triangles[s.triangles[0]][0]];  // keeps the volume's terms small
      double volume = 0;
      for (const std::uint32_t i : s.triangles) {
        pace_();
        const Triangle& t = soup_.triangles[i];
        s.area += area_vector(soup_, t).norm() / 2;
        const double part =
            ((soup_.points[t[0]] - origin) | ((soup_.points[t[1]] - origin) % (soup_.points[t[2]] - origin))) / 6;
        volume += result_.reversed[i] ? -part : part;
      }
      if (s.closed) s.volume = volume;
    }
  }

  const Soup& soup_;
  Pace pace_;
  std::vector<Triangle> whole_;
  std::vector<std::uint32_t> source_;
  SidePairs pairs_;
  Shells result_;
};

bool contains(const SoupBox& outer, const SoupBox& inner) {
  for (int k = 0; k < 3; ++k)
    if (inner.lo[k] < outer.lo[k] || inner.hi[k] > outer.hi[k]) return false;
  return true;
}

}  // namespace

InsideTest::InsideTest(const Soup& soup, std::span<const std::uint32_t> listed, const Context* context)
    : soup_(soup), listed_(listed.begin(), listed.end()), tree_(shell_tree(soup, listed, context)) {}

InsideTest::Where InsideTest::locate(const Vec3& place) const {
  constexpr int x = 1, y = 2;  // the line runs along the first axis
  SoupBox line;
  line.grow(place);
  line.hi[0] = std::numeric_limits<double>::infinity();
  bool inside = false, on = false;
  tree_.overlapping(line, 0, [&](std::uint32_t item) {
    const Triangle& t = soup_.triangles[listed_[item]];
    const Vec3 &a = soup_.points[t[0]], &b = soup_.points[t[1]], &c = soup_.points[t[2]];
    if (tree_.box(item).lo[0] <= place[0] && orientation_exact(a, b, c, place) == 0 && in_flat(a, b, c, place))
      on = true;
    const int turn = moved_orientation(a, b, place, x, y);
    if (turn == 0 || moved_orientation(b, c, place, x, y) != turn || moved_orientation(c, a, place, x, y) != turn)
      return;
    if (orientation_exact(a, b, c, place) == turn) inside = !inside;
  });
  return on ? Where::on : inside ? Where::inside : Where::outside;
}

Shells find_shells(const Soup& soup, Context& context) {
  return ShellFinder(soup, context).run(context);
}

void find_depths(const Soup& soup, Shells& shells, Context& context) {
  Pace pace(context);
  std::vector<SoupBox> boxes(shells.shells.size());
  std::vector<std::uint32_t> closed;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!shells.shells[i].closed) continue;
    closed.push_back(i);
    for (const std::uint32_t t : shells.shells[i].triangles) {
      pace();
      boxes[i].grow(triangle_box(soup, soup.triangles[t]));
    }
  }
  if (closed.size() < 2) return;
  std::vector<std::vector<std::uint32_t>> held(boxes.size());  // by the box of each shell
  const OverlapTree tree(boxes, closed, &context);
  for (const std::uint32_t inner : closed)
    tree.overlapping(boxes[inner], 0, [&](std::uint32_t outer) {
      if (outer != inner && contains(boxes[outer], boxes[inner])) held[outer].push_back(inner);
    });
  for (const std::uint32_t outer : closed) {
    if (held[outer].empty()) continue;
    context.checkpoint();
    const InsideTest test(soup, shells.shells[outer].triangles, &context);
    for (const std::uint32_t inner : held[outer]) {
      bool is_inside = false, is_outside = false;
      for (const std::uint32_t t : shells.shells[inner].triangles) {
        pace();
        for (const std::uint32_t v : soup.triangles[t]) {
          const InsideTest::Where where = test.locate(soup.points[v]);
          is_inside |= where == InsideTest::Where::inside;
          is_outside |= where == InsideTest::Where::outside;
        }
        if (is_outside) break;
      }
      if (!is_inside || is_outside) continue;
      ++shells.shells[inner].depth;
      shells.shells[inner].winding += shells.shells[outer].volume > 0 ? 1 : -1;
    }
  }
}

}  // namespace tri

#include "libtri/triangulation/patches/constrained_delaunay.hpp"

#include <deque>
#include <utility>

namespace tri {

ConstrainedDelaunay::ConstrainedDelaunay(std::span<const Vec2> points, Delaunay delaunay)
    : points_(points), test_(bit_range(points)), triangles_(std::move(delaunay.triangles)),
      neighbors_(std::move(delaunay.neighbors)), fixed_(triangles_.size(), 0), at_vertex_(points.size(), -1) {
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t v : triangles_[t]) at_vertex_[v] = static_cast<std::int32_t>(t);
}

int ConstrainedDelaunay::corner(std::int32_t t, std::uint32_t v) const {
  const Triangle& q = triangles_[static_cast<std::size_t>(t)];
  return q[0] == v ? 0 : q[1] == v ? 1 : 2;
}

ConstrainedDelaunay::Side ConstrainedDelaunay::left_of(std::uint32_t from, std::uint32_t to) const {
  const std::int32_t start = at_vertex_[from];
  if (start < 0) return {};
  // Counter-clockwise until the boundary, then clockwise from the start.
  for (std::int32_t t = start; t >= 0;) {
    const int c = corner(t, from);
    if (triangles_[static_cast<std::size_t>(t)][(c + 1) % 3] == to) return {t, (c + 2) % 3};
    t = neighbors_[static_cast<std::size_t>(t)][(c + 1) % 3];
    if (t == start) return {};
  }
  for (std::int32_t t = start; t >= 0;) {
    const int c = corner(t, from);
    if (triangles_[static_cast<std::size_t>(t)][(c + 1) % 3] == to) return {t, (c + 2) % 3};
    t = neighbors_[static_cast<std::size_t>(t)][(c + 2) % 3];
  }
  return {};
}

void ConstrainedDelaunay::fix(const Side& side) {
  if (side.triangle < 0) return;
  fixed_[static_cast<std::size_t>(side.triangle)] |= static_cast<std::uint8_t>(1 << side.corner);
}

void ConstrainedDelaunay::flip(std::int32_t t, int k) {
  const std::int32_t n = neighbors_[static_cast<std::size_t>(t)][k];
  const auto ti = static_cast<std::size_t>(t), ni = static_cast<std::size_t>(n);
  const std::uint32_t a = triangles_[ti][k], b = triangles_[ti][(k + 1) % 3], c = triangles_[ti][(k + 2) % 3];
  const int kb = corner(n, b);  // n = (d, c, b) in this order
  const int kd = (kb + 1) % 3, kc = (kb + 2) % 3;
  const std::uint32_t d = triangles_[ni][kd];
  const std::int32_t across_b = neighbors_[ti][(k + 1) % 3], across_c = neighbors_[ti][(k + 2) % 3];  // edges ca and ab
  const std::int32_t beyond_b = neighbors_[ni][kb], beyond_c = neighbors_[ni][kc];                    // edges dc and bd
  const auto bit = [&](std::size_t x, int i, int to) { return static_cast<std::uint8_t>((fixed_[x] >> i & 1) << to); };
  const auto flags_t = static_cast<std::uint8_t>(bit(ni, kc, 0) | bit(ti, (k + 2) % 3, 2));
  const auto flags_n = static_cast<std::uint8_t>(bit(ni, kb, 0) | bit(ti, (k + 1) % 3, 1));
  const auto redirect = [&](std::int32_t who, std::int32_t old_neighbor, std::int32_t new_neighbor) {
    if (who < 0) return;
    for (auto& x : neighbors_[static_cast<std::size_t>(who)])
      if (x == old_neighbor) {
        x = new_neighbor;
        return;
      }
  };
  triangles_[ti] = {a, b, d};
  neighbors_[ti] = {beyond_c, n, across_c};
  triangles_[ni] = {a, d, c};
  neighbors_[ni] = {beyond_b, across_b, t};
  fixed_[ti] = flags_t;
  fixed_[ni] = flags_n;
  redirect(beyond_c, n, t);
  redirect(across_b, t, n);
  at_vertex_[a] = at_vertex_[b] = at_vertex_[d] = t;
  at_vertex_[c] = n;
}

ConstrainedDelaunay::Outcome ConstrainedDelaunay::insert(std::uint32_t from, std::uint32_t to) {
  if (at_vertex_[from] < 0 || at_vertex_[to] < 0) return Outcome::missing_vertex;
  const Side left = left_of(from, to), right = left_of(to, from);
  if (left.triangle >= 0 || right.triangle >= 0) {
    fix(left);
    fix(right);
    return Outcome::inserted;
  }
  // The triangle at `from` through whose far edge the segment leaves: right corner p, left corner q.
  std::int32_t t = -1;
  std::uint32_t p = 0, q = 0;
  const auto look = [&](std::int32_t s) {
    const int c = corner(s, from);
    const std::uint32_t b = triangles_[static_cast<std::size_t>(s)][(c + 1) % 3];
    const std::uint32_t e = triangles_[static_cast<std::size_t>(s)][(c + 2) % 3];
    const int side_b = turn(from, to, b), side_e = turn(from, to, e);
    const auto ahead = [&](std::uint32_t v) {
      return ((points_[v] - points_[from]) | (points_[to] - points_[from])) > 0;
    };
    for (const auto& [v, side] : {std::pair(b, side_b), std::pair(e, side_e)})
      if (side == 0 && ahead(v)) {
        blocking_ = v;
        return Outcome::meets_vertex;
      }
    if (side_b < 0 && side_e > 0) {
      t = s;
      p = b;
      q = e;
    }
    return Outcome::inserted;
  };
  const std::int32_t start = at_vertex_[from];
  std::int32_t s = start;
  do {
    if (const Outcome o = look(s); o != Outcome::inserted) return o;
    if (t >= 0) break;
    s = neighbors_[static_cast<std::size_t>(s)][(corner(s, from) + 1) % 3];
  } while (s >= 0 && s != start);
  if (t < 0 && s < 0) {
    s = start;
    while (t < 0 && (s = neighbors_[static_cast<std::size_t>(s)][(corner(s, from) + 2) % 3]) >= 0)
      if (const Outcome o = look(s); o != Outcome::inserted) return o;
  }
  if (t < 0) return Outcome::crosses_segment;

  std::deque<std::pair<std::uint32_t, std::uint32_t>> crossed;
  for (;;) {
    const int k = 3 - corner(t, p) - corner(t, q);
    if (fixed(t, k)) return Outcome::crosses_segment;
    crossed.emplace_back(p, q);
    const std::int32_t n = neighbors_[static_cast<std::size_t>(t)][k];
    if (n < 0) return Outcome::crosses_segment;
    const std::uint32_t w = triangles_[static_cast<std::size_t>(n)][3 - corner(n, p) - corner(n, q)];
    if (w == to) break;
    const int side = turn(from, to, w);
    if (side == 0) {
      blocking_ = w;
      return Outcome::meets_vertex;
    }
    (side > 0 ? q : p) = w;
    t = n;
  }
  while (!crossed.empty()) {
    const auto [a, b] = crossed.front();
    crossed.pop_front();
    const Side edge = left_of(a, b);
    const std::int32_t n = neighbors_[static_cast<std::size_t>(edge.triangle)][edge.corner];
    const std::uint32_t r = triangles_[static_cast<std::size_t>(edge.triangle)][edge.corner];
    const std::uint32_t o = triangles_[static_cast<std::size_t>(n)][3 - corner(n, a) - corner(n, b)];
    if (turn(r, o, a) * turn(r, o, b) >= 0) {  // not convex: some other flip will make it so
      crossed.emplace_back(a, b);
      continue;
    }
    flip(edge.triangle, edge.corner);
    if (r != from && r != to && o != from && o != to && turn(from, to, r) * turn(from, to, o) < 0)
      crossed.emplace_back(r, o);
  }
  fix(left_of(from, to));
  fix(left_of(to, from));
  return Outcome::inserted;
}

}  // namespace tri

#include "meshops/joining/t_junctions.hpp"

#include <algorithm>
#include <tuple>

#include "meshops/crossings/predicates.hpp"
#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

using PointBox = OverlapTree::Box;

struct LooseSide {
  std::uint32_t triangle = 0, side = 0;
};

std::vector<LooseSide> loose_sides(const Soup& soup, Context& context) {
  Pace pace(context);
  std::vector<Triangle> whole;
  std::vector<std::uint32_t> source;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i, pace()) {
    if (repeats_vertex(soup.triangles[i])) continue;
    whole.push_back(soup.triangles[i]);
    source.push_back(i);
  }
  const SidePairs pairs = pair_sides(whole, soup.points.size(), context);
  std::vector<char> paired(pairs.twin.size());
  for (std::size_t i = 0; i < paired.size(); ++i, pace()) paired[i] = pairs.twin[i] != SidePairs::none;
  for (const auto& [a, b] : pairs.same_way) paired[a] = paired[b] = 1;
  for (const auto& crowd : pairs.crowded)
    for (const std::int32_t side : crowd) paired[side] = 1;
  std::vector<LooseSide> result;
  for (std::uint32_t i = 0; i < paired.size(); ++i, pace())
    if (!paired[i]) result.push_back({source[i / 3], i % 3});
  return result;
}

bool is_on(const Vec3& a, const Vec3& b, const Vec3& p, double tolerance, double& share) {
  const Vec3 ab = b - a;
  share = ((p - a) | ab) / ab.sqrnorm();
  if (!(share > 0 && share < 1)) return false;
  if (tolerance == 0) return p != a && p != b && collinear_exact(a, b, p);
  const double squared = tolerance * tolerance;
  return (p - a).sqrnorm() > squared && (p - b).sqrnorm() > squared && (p - (a + ab * share)).sqrnorm() <= squared;
}

}  // namespace

double length_tolerance(const Soup& soup, double absolute, double relative) {
  PointBox all;
  for (const Vec3& p : soup.points) all.grow(p);
  return soup.points.empty() ? absolute : std::max(absolute, relative * (all.hi - all.lo).norm());
}

std::vector<TJunction> find_t_junctions(const Soup& soup, double tolerance, Context& context) {
  const std::vector<LooseSide> sides = loose_sides(soup, context);
  Pace pace(context);
  std::vector<char> loose(soup.points.size(), 0);
  std::vector<PointBox> boxes;
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < sides.size(); ++i, pace()) {
    const Triangle& t = soup.triangles[sides[i].triangle];
    const std::uint32_t a = t[sides[i].side], b = t[(sides[i].side + 1) % 3];
    loose[a] = loose[b] = 1;
    boxes.emplace_back();
    boxes.back().grow(soup.points[a]);
    boxes.back().grow(soup.points[b]);
    if (!collinear_exact(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]])) items.push_back(i);
  }
  const OverlapTree tree(std::move(boxes), std::move(items));
  std::vector<TJunction> found;
  for (std::uint32_t v = 0; v < loose.size(); ++v) {
    if (v % 4096 == 0) context.checkpoint();
    if (!loose[v]) continue;
    const Vec3& p = soup.points[v];
    PointBox around;
    around.grow(p - Vec3(tolerance, tolerance, tolerance));
    around.grow(p + Vec3(tolerance, tolerance, tolerance));
    tree.overlapping(around, 0, [&](std::uint32_t i) {
      const Triangle& t = soup.triangles[sides[i].triangle];
      if (std::ranges::find(t, v) != t.end()) return;
      double share = 0;
      if (is_on(soup.points[t[sides[i].side]], soup.points[t[(sides[i].side + 1) % 3]], p, tolerance, share))
        found.push_back({sides[i].triangle, sides[i].side, v, share});
    });
  }
  std::ranges::sort(found, {}, [](const TJunction& j) { return std::tuple(j.triangle, j.side, j.share, j.vertex); });
  std::vector<TJunction> result;
  for (const TJunction& j : found) {
    const bool same_side = !result.empty() && result.back().triangle == j.triangle && result.back().side == j.side;
    if (same_side && (soup.points[result.back().vertex] - soup.points[j.vertex]).norm() <= tolerance) continue;
    result.push_back(j);
  }
  return result;
}

}  // namespace tri

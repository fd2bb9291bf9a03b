#include "libtri/untangle.hpp"

#include <algorithm>
#include <optional>

#include "libtri/shell/edit_mesh.hpp"
#include "meshops/box_tree.hpp"
#include "meshops/self_intersections.hpp"

namespace tri {
namespace {

constexpr int most_rounds = 12;
/// Crossings are looked for again after this many flips at the latest, since flipped triangles are searched one by one.
constexpr std::size_t most_flips_a_round = 2000;

class Untangler {
 public:
  Untangler(std::span<const Vec3> points, std::span<const Foot> feet, PointMesh& mesh) : points_(points), feet_(feet) {
    edit_.triangles = std::move(mesh.triangles);
    edit_.neighbors = std::move(mesh.neighbors);
    edit_.creases.assign(edit_.triangles.size(), 0);
    edit_.vertices.resize(points.size());
    edit_.index_vertices();
  }

  std::size_t round(const std::vector<std::array<std::uint32_t, 2>>& pairs, const Context& context) {
    build_tree();
    std::vector<std::uint32_t> tangled;
    for (const auto& pair : pairs) tangled.insert(tangled.end(), pair.begin(), pair.end());
    std::sort(tangled.begin(), tangled.end());
    tangled.erase(std::unique(tangled.begin(), tangled.end()), tangled.end());
    std::size_t flips = 0;
    for (std::uint32_t t : tangled) {
      if (flips >= most_flips_a_round) break;
      context.checkpoint();
      int best_side = -1;
      long best_gain = 0;
      for (int k = 0; k < 3; ++k) {
        const long gain = gain_of(static_cast<std::int32_t>(t), k);
        if (gain > best_gain) best_gain = gain, best_side = k;
      }
      if (best_side < 0) continue;
      const std::int32_t n = edit_.neighbors[t][best_side];
      edit_.flip(static_cast<std::int32_t>(t), best_side);
      for (std::uint32_t x : {t, static_cast<std::uint32_t>(n)})
        if (!changed_[x]) changed_[x] = true, changed_list_.push_back(x);
      ++flips;
    }
    return flips;
  }

  std::span<const Triangle> triangles() const { return edit_.triangles; }

  void give_back(PointMesh& mesh) {
    mesh.triangles = std::move(edit_.triangles);
    mesh.neighbors = std::move(edit_.neighbors);
  }

 private:
  void build_tree() {
    std::vector<Box> boxes(edit_.triangles.size());
    std::vector<std::uint32_t> items(edit_.triangles.size());
    for (std::uint32_t t = 0; t < items.size(); ++t) {
      items[t] = t;
      boxes[t] = box_of(edit_.triangles[t]);
    }
    tree_.emplace(std::move(boxes), std::move(items));
    changed_.assign(edit_.triangles.size(), false);
    changed_list_.clear();
  }

  Box box_of(const Triangle& t) const {
    Box box;
    for (std::uint32_t v : t) box.grow(points_[v]);
    return box;
  }

  long crossings(const Triangle& q, std::int32_t skip_a, std::int32_t skip_b) const {
    const std::array<Vec3, 3> a{points_[q[0]], points_[q[1]], points_[q[2]]};
    const Box box = box_of(q);
    long count = 0;
    const auto test = [&](std::uint32_t u) {
      if (static_cast<std::int32_t>(u) == skip_a || static_cast<std::int32_t>(u) == skip_b) return;
      const Triangle& r = edit_.triangles[u];
      for (std::uint32_t v : q)
        if (v == r[0] || v == r[1] || v == r[2]) return;
      count += triangles_intersect(a, {points_[r[0]], points_[r[1]], points_[r[2]]});
    };
    tree_->overlapping(box, 0, [&](std::uint32_t u) {
      if (!changed_[u]) test(u);
    });
    for (std::uint32_t u : changed_list_)
      if (box_of(edit_.triangles[u]).overlaps(box)) test(u);
    return count;
  }

  bool turned(const Triangle& t) const {
    const Vec3 n = (points_[t[1]] - points_[t[0]]) % (points_[t[2]] - points_[t[0]]);
    Vec3 model(0, 0, 0);
    for (std::uint32_t v : t)
      for (int k = 0; k < 3; ++k) model[k] += feet_[v].normal[k];
    return (n | model) < -0.3 * n.norm() * model.norm();
  }

  /// How many crossing pairs the flip of one edge saves; 0 or less if it must not be flipped.
  long gain_of(std::int32_t t, int k) const {
    const std::int32_t n = edit_.neighbors[t][k];
    if (n < 0) return 0;
    const Triangle& q = edit_.triangles[t];
    const std::uint32_t a = q[k], b = q[(k + 1) % 3], c = q[(k + 2) % 3], d = edit_.triangles[n][edit_.side(n, t)];
    if (a == d || edit_.has_edge(a, d)) return 0;
    const Triangle first{a, b, d}, second{a, d, c};
    if (turned(first) + turned(second) > turned(q) + turned(edit_.triangles[n])) return 0;
    const long before = crossings(q, t, n) + crossings(edit_.triangles[n], t, n);
    if (before == 0) return 0;
    return before - crossings(first, t, n) - crossings(second, t, n);
  }

  std::span<const Vec3> points_;
  std::span<const Foot> feet_;
  EditMesh edit_;
  std::optional<BoxTree> tree_;
  std::vector<bool> changed_;
  std::vector<std::uint32_t> changed_list_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 2>> untangle(std::span<const Vec3> points, std::span<const Foot> feet, PointMesh& mesh,
                                                   const Context& context) {
  auto pairs = self_intersections(points, mesh.triangles, context);
  if (pairs.empty()) return pairs;
  Untangler untangler(points, feet, mesh);
  try {
    for (int round = 0; round < most_rounds && !pairs.empty(); ++round) {
      if (untangler.round(pairs, context) == 0) break;
      pairs = self_intersections(points, untangler.triangles(), context);
    }
  } catch (...) {
    untangler.give_back(mesh);
    throw;
  }
  untangler.give_back(mesh);
  return pairs;
}

}  // namespace tri

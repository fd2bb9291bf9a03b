#include "libtri/triangulation/untangle.hpp"

#include <algorithm>
#include <optional>

#include "libtri/surfaces/crossing_search.hpp"
#include "libtri/triangulation/shell/edit_mesh.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/search/overlap_tree.hpp"

namespace tri {
namespace {

constexpr int most_untangling_rounds = 12;
/// Crossings are looked for again after this many flips at the latest, since flipped triangles are searched one by one.
constexpr std::size_t most_flips_a_round = 2000;

using TriangleBounds = OverlapTree::Box;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

/// Works on the triangles around the crossings only: a mesh of millions with a few crossings costs little more than
/// finding them.
class Untangler {
 public:
  /// @param mesh  its triangles are here for as long as this lives
  Untangler(std::span<const Vec3> points, std::span<const Foot> feet, PointMesh& mesh, const Context& context)
      : points_(points), feet_(feet), mesh_(mesh), context_(context), parts_(points.size()) {
    edit_.creases.assign(mesh.triangles.size(), 0);
    edit_.vertices.resize(points.size());
    edit_.triangles = std::move(mesh.triangles);
    edit_.neighbors = std::move(mesh.neighbors);
  }
  Untangler(const Untangler&) = delete;
  Untangler& operator=(const Untangler&) = delete;
  ~Untangler() {
    mesh_.triangles = std::move(edit_.triangles);
    mesh_.neighbors = std::move(edit_.neighbors);
  }

  void prepare(const Pairs& pairs) {
    Pace pace(context_);
    for (const Triangle& t : edit_.triangles) pace(), parts_.join(t[0], t[1]), parts_.join(t[0], t[2]);
    context_.checkpoint();
    edit_.index_vertices();
    collect_zone(pairs);
    search_.emplace(points_, edit_.triangles, zone_, &context_);
  }

  /// Crossing pairs among the triangles of the zone.
  Pairs crossings() const {
    std::vector<Triangle> local;
    for (std::uint32_t t : zone_) local.push_back(edit_.triangles[t]);
    Pairs pairs = self_intersections(points_, local, context_);
    for (auto& pair : pairs)
      for (std::uint32_t& t : pair) t = zone_[t];
    return pairs;
  }

  std::size_t round(const Pairs& pairs) {
    search_->refresh();
    std::vector<std::uint32_t> tangled;
    for (const auto& pair : pairs)
      if (within_part(pair)) tangled.insert(tangled.end(), pair.begin(), pair.end());
    std::sort(tangled.begin(), tangled.end());
    tangled.erase(std::unique(tangled.begin(), tangled.end()), tangled.end());
    std::size_t flips = 0;
    for (std::uint32_t t : tangled) {
      if (flips >= most_flips_a_round) break;
      context_.checkpoint();
      int best_side = -1;
      long best_gain = 0;
      for (int k = 0; k < 3; ++k) {
        const long gain = gain_of(static_cast<std::int32_t>(t), k);
        if (gain > best_gain) best_gain = gain, best_side = k;
      }
      if (best_side < 0) continue;
      const std::int32_t n = edit_.neighbors[t][best_side];
      edit_.flip(static_cast<std::int32_t>(t), best_side);
      search_->note_change(t);
      search_->note_change(static_cast<std::uint32_t>(n));
      ++flips;
    }
    return flips;
  }

 private:
  /// Every triangle that one of a crossing pair, or a flip of its edges, can meet.
  void collect_zone(const Pairs& pairs) {
    std::vector<TriangleBounds> boxes;
    std::vector<std::uint32_t> ids;
    for (const auto& pair : pairs) {
      if (!within_part(pair)) continue;
      for (std::uint32_t t : pair) {
        TriangleBounds box = box_of(edit_.triangles[t]);
        for (std::int32_t n : edit_.neighbors[t])
          if (n >= 0) box.grow(box_of(edit_.triangles[n]));
        ids.push_back(static_cast<std::uint32_t>(boxes.size()));
        boxes.push_back(box);
      }
    }
    const OverlapTree around(std::move(boxes), std::move(ids), &context_);
    Pace pace(context_);
    for (std::uint32_t t = 0; t < edit_.triangles.size(); ++t, pace()) {
      bool near = false;
      around.overlapping(box_of(edit_.triangles[t]), 0, [&](std::uint32_t) { near = true; });
      if (near) zone_.push_back(t);
    }
  }

  /// Solids that touch cross each other wherever there is noise, in as many places as they have triangles there: no
  /// flip cures that.
  bool within_part(const std::array<std::uint32_t, 2>& pair) {
    return parts_.find(edit_.triangles[pair[0]][0]) == parts_.find(edit_.triangles[pair[1]][0]);
  }

  TriangleBounds box_of(const Triangle& t) const {
    TriangleBounds box;
    for (std::uint32_t v : t) box.grow(points_[v]);
    return box;
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
    const std::uint32_t a = q[k], b = q[(k + 1) % 3], c = q[(k + 2) % 3], d = edit_.opposite(t, k);
    if (a == d || edit_.has_edge(a, d)) return 0;
    const Triangle first{a, b, d}, second{a, d, c};
    if (turned(first) + turned(second) > turned(q) + turned(edit_.triangles[n])) return 0;
    const std::array<std::int32_t, 2> both{t, n};
    const long before = search_->count(q, both) + search_->count(edit_.triangles[n], both);
    if (before == 0) return 0;
    return before - search_->count(first, both) - search_->count(second, both);
  }

  std::span<const Vec3> points_;
  std::span<const Foot> feet_;
  PointMesh& mesh_;
  const Context& context_;
  EditMesh edit_;
  DisjointSets parts_;               // of vertices that triangles connect
  std::vector<std::uint32_t> zone_;  // ascending
  std::optional<CrossingSearch> search_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 2>> untangle(std::span<const Vec3> points, std::span<const Foot> feet,
                                                   PointMesh& mesh, const Context& context) {
  Pairs pairs = self_intersections(points, mesh.triangles, context);
  if (pairs.empty()) return pairs;
  context.checkpoint();
  std::size_t flips = 0;
  {
    Untangler untangler(points, feet, mesh, context);
    untangler.prepare(pairs);
    for (int round = 0; round < most_untangling_rounds && !pairs.empty(); ++round) {
      const std::size_t now = untangler.round(pairs);
      if (now == 0) break;
      flips += now;
      pairs = untangler.crossings();
    }
  }
  return flips > 0 ? self_intersections(points, mesh.triangles, context) : pairs;
}

}  // namespace tri

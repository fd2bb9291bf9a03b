#include "meshops/crossings/part_touching.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "meshops/crossings/solid_check.hpp"
#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/joining/joined_points.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/number_map.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/single_precision.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr int random_directions = 48;
constexpr double least_share = 0x1p-16;  ///< of the way that is allowed: the first try, or a step of a float
constexpr double longer = 2;             ///< each try than the one before

class Parter {
 public:
  Parter(Soup& soup, double farthest, Context& context)
      : soup_(soup), farthest_(farthest), context_(context), name_(points_at_same_place(soup.points, &context)),
        in_place_(soup.points.size()), tree_(tree()) {
    Pace pace(context);
    for (const std::uint32_t n : name_) pace(), in_place_.insert(place_of(soup_.points[n]), n);
  }

  std::size_t run() {
    const std::vector<std::uint32_t> touching = touching_vertices(soup_, &context_);
    std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
    for (const std::uint32_t v : touching) groups[name_[v]].push_back(v);
    std::map<std::uint32_t, std::vector<std::uint32_t>> fans;
    for (auto& [first, group] : groups) group.push_back(first);
    for (const auto& [first, group] : groups)
      for (const std::uint32_t v : group) fans[v];
    Pace pace(context_);
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t, pace())
      for (const std::uint32_t v : soup_.triangles[t])
        if (const auto fan = fans.find(v); fan != fans.end()) fan->second.push_back(t);
    std::size_t moved = 0;
    for (const auto& [first, group] : groups) {
      std::size_t left = 0;
      for (const std::uint32_t v : group) left += !fans[v].empty();
      for (const std::uint32_t v : group) {
        if (left < 2) break;
        if (fans[v].empty() || !part(v, fans[v])) continue;
        --left;
        ++moved;
      }
    }
    return moved;
  }

 private:
  using Place = std::array<double, 3>;
  struct PlaceHash {
    std::size_t operator()(const Place& p) const {
      std::uint64_t h = 0;
      for (const double x : p) h = (h ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u, h ^= h >> 32;
      return static_cast<std::size_t>(h);
    }
  };

  static Place place_of(const Vec3& p) { return {p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}; }

  /// Boxes hold the triangles wherever their vertices move.
  OverlapTree tree() const {
    Pace pace(context_);
    std::vector<OverlapTree::Box> boxes(soup_.triangles.size());
    std::vector<std::uint32_t> items(boxes.size());
    std::iota(items.begin(), items.end(), 0u);
    const Vec3 reach = Vec3(1, 1, 1) * farthest_;
    for (std::size_t t = 0; t < boxes.size(); ++t, pace())
      for (const std::uint32_t v : soup_.triangles[t])
        boxes[t].grow(soup_.points[v] - reach), boxes[t].grow(soup_.points[v] + reach);
    return OverlapTree(std::move(boxes), std::move(items), &context_);
  }

  std::array<Vec3, 3> corners(std::uint32_t t) const {
    const Triangle& v = soup_.triangles[t];
    return {soup_.points[v[0]], soup_.points[v[1]], soup_.points[v[2]]};
  }
  Triangle named(std::uint32_t t) const {
    const Triangle& v = soup_.triangles[t];
    return {name_[v[0]], name_[v[1]], name_[v[2]]};
  }

  bool part(std::uint32_t v, const std::vector<std::uint32_t>& fan) {
    context_.checkpoint();
    const Vec3 from = soup_.points[v];
    std::vector<Vec3> normals;
    Vec3 normal(0, 0, 0), middle(0, 0, 0);
    for (const std::uint32_t t : fan) {
      normals.push_back(area_vector(soup_, soup_.triangles[t]));
      normal += normals.back();
      for (const Vec3& p : corners(t)) middle += p - from;
    }
    std::vector<Vec3> directions{-normal, middle, middle - normal * (middle.norm() / std::max(normal.norm(), 1e-300)),
                                 normal};
    RandomStream random(v + 1);
    for (int i = 0; i < random_directions; ++i) {
      Vec3 d(0, 0, 0);
      for (int k = 0; k < 3; ++k) d[k] = 2 * random.uniform() - 1;
      directions.push_back(d);
    }
    const std::uint32_t old_name = name_[v];
    name_[v] = static_cast<std::uint32_t>(name_.size()) + v;  // of its own
    double least = least_share * farthest_;
    for (int k = 0; k < 3; ++k) least = std::max(least, 0x1p-23 * std::abs(from[k]));
    for (double length = least; length > 0 && length <= farthest_; length *= longer)
      for (const Vec3& d : directions) {
        if (!(d.norm() > 0)) continue;
        const Vec3 to = rounded_to_floats(from + d * (length / d.norm()));
        if ((to - from).norm() > farthest_ || in_place_.find(place_of(to)) != no_index) continue;
        soup_.points[v] = to;
        if (!fits(fan, normals)) continue;
        in_place_.insert(place_of(to), v);
        return true;
      }
    soup_.points[v] = from;
    name_[v] = old_name;
    return false;
  }

  bool fits(const std::vector<std::uint32_t>& fan, const std::vector<Vec3>& normals) const {
    for (std::size_t i = 0; i < fan.size(); ++i)
      if (!((area_vector(soup_, soup_.triangles[fan[i]]) | normals[i]) > 0)) return false;
    return std::ranges::all_of(fan, [&](std::uint32_t t) {
      const std::array<Vec3, 3> at = corners(t);
      if (!triangle_has_area(at[0], at[1], at[2])) return false;
      const TriangleBox box(at);
      bool meets = false;
      tree_.meeting(box, [&](std::uint32_t u) {
        if (meets || u == t) return;
        const std::array<Vec3, 3> other = corners(u);
        if (!box.beside(other) && triangle_has_area(other[0], other[1], other[2]))
          meets = triangles_meet(named(t), at, named(u), other);
      });
      return !meets;
    });
  }

  Soup& soup_;
  const double farthest_;
  Context& context_;
  std::vector<std::uint32_t> name_;       ///< of vertices: the same for those in one place
  NumberMap<Place, PlaceHash> in_place_;  ///< places that vertices have or had
  const OverlapTree tree_;
};

}  // namespace

std::size_t part_touching_vertices(Soup& soup, double farthest, Report& report, Context& context) {
  const std::size_t moved = Parter(soup, farthest, context).run();
  report.vertices_moved += moved;
  return moved;
}

}  // namespace tri

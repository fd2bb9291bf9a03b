#include "meshops/checks/surface_reach.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

using CornerPoints = std::array<Vec3, 3>;

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

CornerPoints sorted_corners(const Soup& soup, const Triangle& t) {
  CornerPoints c{soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]};
  std::sort(c.begin(), c.end(), before);
  return c;
}

std::size_t hash(const CornerPoints& c) {
  std::uint64_t h = 0;
  for (const Vec3& p : c)
    for (int k = 0; k < 3; ++k) {
      h = (h ^ std::bit_cast<std::uint64_t>(p[k] + 0.0)) * 0x9E3779B97F4A7C15ULL;  // -0 equals 0
      h ^= h >> 32;
    }
  return static_cast<std::size_t>(h);
}

/// Finds triangles by the coordinates of their corners.
class TrianglesByPlace {
 public:
  TrianglesByPlace(const Soup& soup, const Context& context)
      : soup_(soup), slots_(std::bit_ceil(2 * soup.triangles.size() + 16), no_index) {
    Pace pace(context);
    for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
      pace();
      std::uint32_t& slot = slot_of(sorted_corners(soup, soup.triangles[t]));
      if (slot == no_index) slot = t;
    }
  }
  bool has(const CornerPoints& c) { return slot_of(c) != no_index; }

 private:
  /// Where the triangle with these corners is, or belongs.
  std::uint32_t& slot_of(const CornerPoints& c) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = hash(c) & mask;
    while (slots_[at] != no_index && sorted_corners(soup_, soup_.triangles[slots_[at]]) != c) at = (at + 1) & mask;
    return slots_[at];
  }

  const Soup& soup_;
  std::vector<std::uint32_t> slots_;  ///< triangles
};

}  // namespace

ReachOfTriangle reach_of(const std::array<Vec3, 3>& triangle, const ClosestTriangle& surface, double reach,
                         std::size_t most_pieces, std::uint32_t& hint) {
  using Verdict = ReachOfTriangle::Verdict;
  std::vector<CornerPoints> pieces{triangle};
  bool decided = true;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto [a, b, c] = pieces[i];
    const auto within = [&](std::uint32_t t) {
      const CornerPoints& near = surface.corners(t);
      return std::ranges::all_of(pieces[i],
                                 [&](const Vec3& p) { return (closest_on_triangle(near, p) - p).norm() <= reach; });
    };
    if (within(hint)) continue;
    const Vec3 middle = (a + b + c) / 3.0;
    const ClosestTriangle::Hit hit = surface.closest(middle, hint);
    hint = hit.triangle;
    if (hit.distance > reach) return {Verdict::beyond, {0, middle, hit.distance}};
    const double radius = std::sqrt(std::max({(a - middle).sqrnorm(), (b - middle).sqrnorm(), (c - middle).sqrnorm()}));
    if (hit.distance + radius <= reach) continue;
    if (within(hint)) continue;
    if (pieces.size() + 4 > most_pieces) {
      decided = false;  // the rest is still looked at
      continue;
    }
    const Vec3 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
    pieces.insert(pieces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return {decided ? Verdict::within : Verdict::undecided, {}};
}

PlacesBeyond places_beyond(const Soup& from, std::span<const std::uint32_t> left_out, const Soup& to, double reach,
                           Context& context) {
  constexpr std::size_t searches = 4000, searches_each = 4;
  const ClosestTriangle surface(to.points, to.triangles, &context);
  TrianglesByPlace same(to, context);
  Pace pace(context), search_pace(context, 128);
  std::vector<std::uint32_t> changed;
  double area = 0;
  for (std::uint32_t t = 0; t < from.triangles.size(); ++t) {
    pace();
    if (std::ranges::binary_search(left_out, t) || same.has(sorted_corners(from, from.triangles[t]))) continue;
    changed.push_back(t);
    area += area_vector(from, from.triangles[t]).norm();
  }
  PlacesBeyond result;
  std::uint32_t hint = 0;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    search_pace();
    const CornerPoints corners = sorted_corners(from, from.triangles[changed[i]]);
    const double share = area > 0 ? area_vector(from, from.triangles[changed[i]]).norm() / area : 0;
    const auto most = searches_each +
                      static_cast<std::size_t>(share * static_cast<double>(searches + searches_each * changed.size()));
    ReachOfTriangle found = reach_of(corners, surface, reach, most, hint);
    found.far.triangle = changed[i];
    if (found.verdict == ReachOfTriangle::Verdict::beyond) result.places.push_back(found.far);
    result.undecided += found.verdict == ReachOfTriangle::Verdict::undecided;
  }
  return result;
}

}  // namespace tri

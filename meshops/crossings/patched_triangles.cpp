#include "meshops/crossings/patched_triangles.hpp"

#include <algorithm>
#include <numeric>

#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/joining/joined_points.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

constexpr std::uint32_t least_in_level = 64;

bool has_side(const Triangle& t, std::uint32_t from, std::uint32_t to) {
  return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) || (t[2] == from && t[0] == to);
}

}  // namespace

PatchedTriangles::PatchedTriangles(const Soup& soup, const Context* context)
    : context_(context), points_(soup.points), triangles_(soup.triangles), there_(soup.triangles.size(), 1),
      given_(size()) {
  Pace pace(context);
  const std::vector<std::uint32_t> same = points_at_same_place(points_, context);
  first_.assign(points_.size() + 1, 0);
  for (Triangle& t : triangles_) {
    pace();
    for (std::uint32_t& v : t) v = same[v], ++first_[v + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  around_.resize(3 * triangles_.size());
  std::vector<std::uint32_t> end(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < given_; ++t, pace())
    for (const std::uint32_t v : triangles_[t]) around_[end[v]++] = t;
  levels_.push_back(level_of(0, given_));
}

PatchedTriangles::Level PatchedTriangles::level_of(std::uint32_t first, std::uint32_t end) const {
  Pace pace(context_);
  std::vector<OverlapTree::Box> boxes(end - first);
  std::vector<std::uint32_t> items(end - first);
  std::iota(items.begin(), items.end(), 0u);
  for (std::uint32_t t = first; t < end; ++t, pace())
    for (const std::uint32_t v : triangles_[t]) boxes[t - first].grow(points_[v]);
  return {first, end, OverlapTree(std::move(boxes), std::move(items), context_)};
}

std::uint32_t PatchedTriangles::add(const Triangle& corners) {
  const std::uint32_t number = size();
  triangles_.push_back(corners);
  there_.push_back(1);
  for (const std::uint32_t v : corners) added_around_[v].push_back(number);
  std::uint32_t first = levels_.back().end;
  if (size() - first < least_in_level) return number;
  while (levels_.size() > 1 && levels_.back().end - levels_.back().first < 2 * (size() - first)) {
    first = levels_.back().first;
    levels_.pop_back();
  }
  levels_.push_back(level_of(first, size()));
  return number;
}

void PatchedTriangles::forget_from(std::uint32_t first) {
  while (size() > first) {
    for (const std::uint32_t v : triangles_.back()) std::erase(added_around_[v], size() - 1);
    triangles_.pop_back();
    there_.pop_back();
  }
  while (levels_.size() > 1 && levels_.back().end > first) levels_.pop_back();
}

std::uint32_t PatchedTriangles::beyond(std::uint32_t t, std::size_t k) const {
  const std::uint32_t from = triangles_[t][k], to = triangles_[t][(k + 1) % 3];
  std::uint32_t found = none;
  std::size_t others = 0;
  at_vertex(from, [&](std::uint32_t u) {
    if (u == t || std::ranges::find(triangles_[u], to) == triangles_[u].end()) return;
    ++others;
    found = u;
  });
  return others == 1 && has_side(triangles_[found], to, from) ? found : none;
}

int PatchedTriangles::crossings(const Triangle& corners) const {
  const std::array<Vec3, 3> at = places(corners);
  if (!triangle_has_area(at[0], at[1], at[2])) return 0;
  int count = 0;
  const TriangleBox box(at);
  const auto look = [&](std::uint32_t t) {
    if (!there_[t]) return;
    const std::array<Vec3, 3> other = places(t);
    if (!box.beside(other) && triangle_has_area(other[0], other[1], other[2]))
      count += triangles_meet(corners, at, triangles_[t], other);
  };
  for (const Level& level : levels_) level.tree.meeting(box, [&](std::uint32_t item) { look(level.first + item); });
  for (std::uint32_t t = levels_.back().end; t < size(); ++t) look(t);
  return count;
}

}  // namespace tri

#include "libtri/surfaces/crossing_search.hpp"

#include <algorithm>
#include <utility>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/pace.hpp"

namespace tri {

CrossingSearch::CrossingSearch(std::span<const Vec3> positions, const std::vector<Triangle>& triangles,
                               std::vector<std::uint32_t> ids, const Context* context)
    : positions_(positions), triangles_(triangles), ids_(std::move(ids)), context_(context),
      changed_(triangles.size(), false) {
  refresh();
}

void CrossingSearch::note_change(std::uint32_t t) {
  if (!changed_[t]) changed_[t] = true, changed_list_.push_back(t);
}

void CrossingSearch::refresh() {
  std::vector<OverlapTree::Box> boxes(ids_.size());
  std::vector<std::uint32_t> items(ids_.size());
  Pace pace(context_);
  for (std::uint32_t i = 0; i < ids_.size(); ++i, pace()) {
    items[i] = i;
    boxes[i] = box_of(triangles_[ids_[i]]);
  }
  tree_.emplace(std::move(boxes), std::move(items), context_);
  for (std::uint32_t t : changed_list_) changed_[t] = false;
  changed_list_.clear();
}

OverlapTree::Box CrossingSearch::box_of(const Triangle& t) const {
  OverlapTree::Box box;
  for (std::uint32_t v : t) box.grow(positions_[v]);
  return box;
}

long CrossingSearch::count(const Triangle& q, std::span<const std::int32_t> skip) const {
  const std::array<Vec3, 3> a{positions_[q[0]], positions_[q[1]], positions_[q[2]]};
  const OverlapTree::Box box = box_of(q);
  long count = 0;
  const auto test = [&](std::uint32_t u) {
    if (std::find(skip.begin(), skip.end(), static_cast<std::int32_t>(u)) != skip.end()) return;
    const Triangle& r = triangles_[u];
    for (std::uint32_t v : q)
      if (v == r[0] || v == r[1] || v == r[2]) return;
    count += triangles_intersect(a, {positions_[r[0]], positions_[r[1]], positions_[r[2]]});
  };
  tree_->overlapping(box, 0, [&](std::uint32_t i) {
    if (!changed_[ids_[i]]) test(ids_[i]);
  });
  for (std::uint32_t u : changed_list_)
    if (box_of(triangles_[u]).overlaps(box)) test(u);
  return count;
}

}  // namespace tri

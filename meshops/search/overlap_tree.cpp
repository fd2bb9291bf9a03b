#include "meshops/search/overlap_tree.hpp"

#include "meshops/search/cancellable_sort.hpp"

namespace tri {

OverlapTree::OverlapTree(std::vector<Box> boxes, std::vector<std::uint32_t> items, const Context* context)
    : order_(std::move(items)), boxes_(std::move(boxes)) {
  Pace pace(context);
  nodes_.reserve(order_.size());
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()), pace);
}

std::uint32_t OverlapTree::build(std::uint32_t first, std::uint32_t end, Pace& pace) {
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Box box;
  std::uint32_t last = 0;
  for (std::uint32_t i = first; i < end; ++i) {
    pace();
    box.grow(boxes_[order_[i]]);
    last = std::max(last, order_[i]);
  }
  std::uint32_t right = 0;
  if (end - first > 4) {
    const Vec3 size = box.hi - box.lo;
    const int axis = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : (size[1] >= size[2] ? 1 : 2);
    const std::uint32_t middle = first + (end - first) / 2;
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const double x = boxes_[a].lo[axis] + boxes_[a].hi[axis], y = boxes_[b].lo[axis] + boxes_[b].hi[axis];
      return x != y ? x < y : a < b;
    };
    paced_nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end, before, pace);
    build(first, middle, pace);
    right = build(middle, end, pace);
  }
  nodes_[id] = {box, first, end, right, last};
  return id;
}

}  // namespace tri

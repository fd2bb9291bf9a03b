#include "meshops/search/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "meshops/search/cancellable_sort.hpp"

namespace tri {

namespace {

// Halves the items at the median of their centres along the longest side.
std::uint32_t* split(const std::vector<Box>& boxes, std::uint32_t* begin, std::uint32_t* end, Pace& pace) {
  Vec3 low = boxes[*begin].low + boxes[*begin].high, high = low;
  for (const std::uint32_t* i = begin; i != end; ++i) {
    pace();
    const Vec3 c = boxes[*i].low + boxes[*i].high;
    low.minimize(c);
    high.maximize(c);
  }
  const Vec3 size = high - low;
  const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  std::uint32_t* middle = begin + (end - begin) / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const double x = boxes[a].low[axis] + boxes[a].high[axis], y = boxes[b].low[axis] + boxes[b].high[axis];
    return x < y || (x == y && a < b);
  };
  paced_nth_element(begin, middle, end, before, pace);
  return middle;
}

float down(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}
float up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes, const Context* context) {
  Pace pace(context);
  if (boxes.empty()) return;
  Vec3 low = boxes[0].low, high = boxes[0].high;
  for (const Box& b : boxes) {
    low.minimize(b.low);
    high.maximize(b.high);
  }
  center_ = (low + high) / 2.0;
  radius_ = static_cast<float>((high - low).norm());
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0u);
  nodes_.reserve(boxes.size() / 2 + 1);
  build(boxes, order.data(), order.data() + order.size(), pace);
}

std::int32_t BoxTree::build(const std::vector<Box>& boxes, std::uint32_t* begin, std::uint32_t* end, Pace& pace) {
  const auto index = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  std::uint32_t* cuts[5] = {begin, begin, end, end, end};
  const std::ptrdiff_t n = end - begin;
  if (n > 4) {
    cuts[2] = split(boxes, begin, end, pace);
    cuts[1] = split(boxes, begin, cuts[2], pace);
    cuts[3] = split(boxes, cuts[2], end, pace);
  } else {
    for (int k = 0; k <= 4; ++k) cuts[k] = begin + std::min<std::ptrdiff_t>(k, n);
  }
  Node node;
  for (int k = 0; k < 4; ++k) {
    std::uint32_t *a = cuts[k], *b = cuts[k + 1];
    node.child[k] = 0;
    for (int c = 0; c < 3; ++c) {
      // An unused child is infinitely far away.
      node.low[c][k] = std::numeric_limits<float>::infinity();
      node.high[c][k] = std::numeric_limits<float>::infinity();
    }
    if (a == b) continue;
    Vec3 low = boxes[*a].low, high = boxes[*a].high;
    for (const std::uint32_t* i = a; i != b; ++i) {
      pace();
      low.minimize(boxes[*i].low);
      high.maximize(boxes[*i].high);
    }
    for (int c = 0; c < 3; ++c) {
      node.low[c][k] = down(low[c] - center_[c]);
      node.high[c][k] = up(high[c] - center_[c]);
    }
    node.child[k] = b - a == 1 ? ~static_cast<std::int32_t>(*a) : build(boxes, a, b, pace);
  }
  nodes_[index] = node;
  return index;
}

}  // namespace tri

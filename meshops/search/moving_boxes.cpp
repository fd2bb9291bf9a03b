#include "meshops/search/moving_boxes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "meshops/for_each_block.hpp"
#include "meshops/limits.hpp"
#include "meshops/search/key_sort.hpp"
#include "meshops/search/spread_bits.hpp"

namespace tri {
namespace {

constexpr std::size_t boxes_block = 8192;

// A float that is surely below or above: half a unit in the last place is what rounding may do.
float below(double x) {
  const float f = static_cast<float>(x);
  return f - std::abs(f) * 1.2e-7f - std::numeric_limits<float>::min();
}
float above(double x) {
  const float f = static_cast<float>(x);
  return f + std::abs(f) * 1.2e-7f + std::numeric_limits<float>::min();
}

}  // namespace

MovingBoxes::Box MovingBoxes::box_of(std::span<const Vec3> places) const {
  Box box;
  for (const Vec3& p : places)
    for (int k = 0; k < 3; ++k) {
      const double x = p[k] - center_[k];
      const auto i = static_cast<std::size_t>(k);
      box.low[i] = std::min(box.low[i], below(x));
      box.high[i] = std::max(box.high[i], above(x));
    }
  return box;
}

void MovingBoxes::build(std::span<const std::array<Vec3, 3>> corners, const Context& context) {
  const std::size_t n = corners.size();
  const auto finite = [&](std::size_t i) {
    return is_finite(corners[i][0]) && is_finite(corners[i][1]) && is_finite(corners[i][2]);
  };
  Vec3 low(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = -low;
  for (std::size_t i = 0; i < n; ++i)
    if (finite(i))
      for (const Vec3& p : corners[i]) low.minimize(p), high.maximize(p);
  context.checkpoint();
  center_ = low[0] <= high[0] ? low * 0.5 + high * 0.5 : Vec3(0, 0, 0);
  std::vector<KeyedIndex> order(n);
  std::vector<Box> boxes(n);
  for_each_block(context, "", n, boxes_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      order[i].index = static_cast<std::uint32_t>(i);
      if (!finite(i)) continue;
      boxes[i] = box_of(corners[i]);
      for (int k = 0; k < 3; ++k) {
        const double middle = corners[i][0][k] / 3 + corners[i][1][k] / 3 + corners[i][2][k] / 3;
        const double share = high[k] > low[k] ? (middle - low[k]) / (high[k] - low[k]) : 0;
        order[i].key |= spread_bits(share > 0 ? share < 1 ? static_cast<std::uint32_t>(share * 1023) : 1023 : 0) << k;
      }
    }
  });
  sort_by_key(order, 30);
  context.checkpoint();
  const std::size_t leaves = std::bit_ceil(std::max<std::size_t>((n + leaf_size - 1) / leaf_size, 1));
  extra_.assign(leaves, none);
  slots_.assign(leaves * leaf_size, Slot());
  places_.resize(n);
  nodes_.assign(2 * leaves, Box());
  std::size_t last = leaves, within = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t i = order[k].index;
    // All leaves alike, instead of full ones and empty ones.
    const std::size_t leaf = k * leaves / n;
    within = leaf == last ? within + 1 : 0;
    last = leaf;
    const std::size_t slot = leaf * leaf_size + within;
    places_[i] = {static_cast<std::uint32_t>(slot), static_cast<std::uint32_t>(leaf)};
    slots_[slot] = {boxes[i], i, none};
    nodes_[leaves + leaf].grow(boxes[i]);
  }
  for (std::size_t node = leaves - 1; node > 0; --node) {
    nodes_[node] = nodes_[2 * node];
    nodes_[node].grow(nodes_[2 * node + 1]);
  }
}

void MovingBoxes::set(std::uint32_t item, const Box& box) {
  slots_[places_[item].slot].box = box;
  if (!(box.low[0] <= box.high[0])) return;
  for (std::size_t node = extra_.size() + places_[item].leaf; node > 0 && !nodes_[node].holds(box); node /= 2)
    nodes_[node].grow(box);
}

void MovingBoxes::add(std::uint32_t beside, const Box& box) {
  const auto item = static_cast<std::uint32_t>(places_.size());
  const auto slot = static_cast<std::uint32_t>(slots_.size());
  const std::uint32_t leaf = places_[beside].leaf;
  slots_.push_back({Box(), item, extra_[leaf]});
  extra_[leaf] = slot;
  places_.push_back({slot, leaf});
  set(item, box);
}

}  // namespace tri

#include "meshops/crossings/arrangement/edge_rings.hpp"

#include <algorithm>

#include "meshops/search/cancellable_sort.hpp"

namespace tri {
namespace {

/// Sorts points around the axis (u, v) counter-clockwise seen from v, starting at the half-plane of the first.
class AngularOrder {
 public:
  AngularOrder(const GridPoint& u, const GridPoint& v, const GridPoint& first) : u_(u), v_(v), first_(first) {}

  bool operator()(const GridPoint& a, const GridPoint& b) const {
    const int ha = half(a), hb = half(b);
    if (ha != hb) return ha < hb;
    if (ha == 0 || ha == 2) return false;
    return sign_of(volume6(u_, v_, a, b)) > 0;
  }

 private:
  /// 0: at the first; 1: less than half a turn from it; 2: half a turn; 3: more.
  int half(const GridPoint& p) const {
    const int s = sign_of(volume6(u_, v_, first_, p));
    if (s != 0) return s > 0 ? 1 : 3;
    const GridPoint n = normal_of(u_, v_, first_), m = normal_of(u_, v_, p);
    Int128 dot = 0;
    for (int k = 0; k < 3; ++k) dot += static_cast<Int128>(n[k]) * m[k];
    return dot > 0 ? 0 : 2;
  }

  const GridPoint &u_, &v_, &first_;
};

}  // namespace

EdgeRings edge_rings(const CrossingComplex& complex, const Context& context) {
  Pace pace(context);
  struct Item {
    std::uint64_t edge;
    EdgeRings::Wing wing;
  };
  std::vector<Item> items;
  items.reserve(3 * complex.faces.size());
  for (std::uint32_t f = 0; f < complex.faces.size(); ++f) {
    pace();
    const Triangle& v = complex.faces[f].v;
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      items.push_back({static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b), {f, k, a < b}});
    }
  }
  cancellable_sort(items.begin(), items.end(), &context, [](const Item& a, const Item& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.wing.face < b.wing.face;
  });
  EdgeRings rings;
  rings.wings.reserve(items.size());
  for (std::size_t i = 0; i < items.size();) {
    pace();
    std::size_t j = i;
    while (j < items.size() && items[j].edge == items[i].edge) ++j;
    rings.first.push_back(static_cast<std::uint32_t>(i));
    if (j - i > 2) {
      const GridPoint &u = complex.points[items[i].edge >> 32], &v = complex.points[items[i].edge & 0xffffffffu];
      const auto apex = [&](const Item& item) -> const GridPoint& {
        return complex.points[complex.faces[item.wing.face].v[(item.wing.side + 2) % 3]];
      };
      const GridPoint start = apex(items[i]);
      const AngularOrder order(u, v, start);
      std::stable_sort(items.begin() + static_cast<std::ptrdiff_t>(i), items.begin() + static_cast<std::ptrdiff_t>(j),
                       [&](const Item& a, const Item& b) { return order(apex(a), apex(b)); });
    }
    for (std::size_t k = i; k < j; ++k) rings.wings.push_back(items[k].wing);
    i = j;
  }
  rings.first.push_back(static_cast<std::uint32_t>(items.size()));
  return rings;
}

}  // namespace tri

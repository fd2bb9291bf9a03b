#include "meshops/holes/hole_islands.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "meshops/search/closest_triangle.hpp"
#include "meshops/search/nearest_points.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

constexpr double highest_rise = 0.7;
constexpr double least_cosine = 0.5;

/// What a hole would be filled with, to search in.
class Bed {
 public:
  Bed(const Hole& hole, const Context& context) : rim_(hole.points()) {
    std::vector<Triangle> triangles;
    for (const VertexTriple& t : hole.triangulate(HoleStrategy::least_bending, 64, context))
      triangles.push_back({static_cast<std::uint32_t>(t[0].idx()), static_cast<std::uint32_t>(t[1].idx()),
                           static_cast<std::uint32_t>(t[2].idx())});
    if (triangles.empty()) return;
    // By place in the rim instead of by vertex.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> place;
    for (std::uint32_t i = 0; i < hole.vertices().size(); ++i)
      place.push_back({static_cast<std::uint32_t>(hole.vertices()[i].idx()), i});
    std::sort(place.begin(), place.end());
    for (Triangle& t : triangles)
      for (std::uint32_t& v : t) v = std::lower_bound(place.begin(), place.end(), std::pair(v, 0u))->second;
    filling_ = std::make_unique<ClosestTriangle>(hole.points(), triangles);
  }

  /// How far the island's rim is from the hole's where it is nearest; infinity if the island is not in the hole.
  double gap(const Hole& island) const {
    const double infinity = std::numeric_limits<double>::infinity();
    if (!filling_) return infinity;
    std::vector<NearestPoints::Neighbor> near;
    const Vec3 looks = unit_or_zero(island.mean_normal());
    double gap = infinity, cosines = 0;
    for (const Vec3& p : island.points()) {
      rim_.nearest(p, 1, near);
      const double to_rim = std::sqrt(near[0].squared_distance);
      const auto hit = filling_->closest(p);
      if (!(hit.distance <= highest_rise * to_rim)) return infinity;
      const auto& corners = filling_->corners(hit.triangle);
      cosines += looks | triangle_normal(corners[0], corners[1], corners[2]);
      gap = std::min(gap, to_rim);
    }
    return cosines > least_cosine * static_cast<double>(island.points().size()) && gap > 0 ? gap : infinity;
  }

 private:
  NearestPoints rim_;
  std::unique_ptr<ClosestTriangle> filling_;
};

OverlapTree::Box rim_box(const Hole& hole) {
  OverlapTree::Box box;
  for (const Vec3& p : hole.points()) box.grow(p);
  return box;
}

}  // namespace

std::vector<int> find_hole_islands(MeshView view, std::span<const Hole> holes,
                                   std::span<const std::vector<HalfedgeHandle>> islands, const Context& context) {
  std::vector<int> in(islands.size(), -1);
  if (holes.empty() || islands.empty()) return in;
  std::vector<OverlapTree::Box> boxes;
  std::vector<double> width;
  for (const Hole& hole : holes) {
    OverlapTree::Box box = rim_box(hole);
    width.push_back((box.hi - box.lo).norm());
    // An island may rise out of a flat hole.
    const Vec3 margin = 0.5 * width.back() * Vec3(1, 1, 1);
    box.lo -= margin;
    box.hi += margin;
    boxes.push_back(box);
  }
  std::vector<std::uint32_t> items(holes.size());
  std::iota(items.begin(), items.end(), 0u);
  const OverlapTree tree(boxes, items);
  std::vector<std::unique_ptr<Bed>> beds(holes.size());
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const Hole island(view, islands[i]);
    const OverlapTree::Box box = rim_box(island);
    double nearest = std::numeric_limits<double>::infinity();
    tree.overlapping(box, 0, [&](std::uint32_t h) {
      if ((box.hi - box.lo).norm() >= width[h]) return;
      for (int k = 0; k < 3; ++k)
        if (box.lo[k] < boxes[h].lo[k] || box.hi[k] > boxes[h].hi[k]) return;
      if (!beds[h]) beds[h] = std::make_unique<Bed>(holes[h], context);
      const double gap = beds[h]->gap(island);
      if (gap < nearest || (gap == nearest && static_cast<int>(h) < in[i])) {
        nearest = gap;
        in[i] = static_cast<int>(h);
      }
    });
  }
  return in;
}

}  // namespace tri

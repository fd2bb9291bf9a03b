#include "meshops/search/nearest_points.hpp"

#include <nanoflann.hpp>

#include "meshops/pace.hpp"

namespace tri {
namespace {

struct Cloud {
  std::span<const Vec3> points;
  Pace* building = nullptr;  // nanoflann asks for coordinates all the time while it builds; the one place to stop it
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    if (building) (*building)();
    return points[i][static_cast<int>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>;

}  // namespace

struct NearestPoints::Impl {
  Impl(std::span<const Vec3> points, const Context* context)
      : cloud{points}, tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {
    Pace pace(context, 1 << 18);
    cloud.building = &pace;
    tree.buildIndex();
    cloud.building = nullptr;
  }
  Cloud cloud;
  Tree tree;
};

NearestPoints::NearestPoints(std::span<const Vec3> points, const Context* context)
    : impl_(std::make_unique<Impl>(points, context)) {}
NearestPoints::~NearestPoints() = default;
NearestPoints::NearestPoints(NearestPoints&&) noexcept = default;

void NearestPoints::nearest(const Vec3& place, std::size_t k, std::vector<Neighbor>& out) const {
  thread_local std::vector<std::uint32_t> indices;
  thread_local std::vector<double> distances;
  indices.resize(k);
  distances.resize(k);
  const std::size_t found = impl_->tree.knnSearch(place.data(), k, indices.data(), distances.data());
  out.resize(found);
  for (std::size_t i = 0; i < found; ++i) out[i] = {indices[i], distances[i]};
}

void NearestPoints::within(const Vec3& place, double radius, std::vector<Neighbor>& out) const {
  thread_local std::vector<std::pair<std::uint32_t, double>> matches;
  impl_->tree.radiusSearch(place.data(), radius * radius, matches, nanoflann::SearchParams(32, 0, false));
  out.clear();
  for (const auto& [index, squared] : matches) out.push_back({index, squared});
}

}  // namespace tri

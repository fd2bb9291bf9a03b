#include "meshops/holes/filling_obstacles.hpp"

#include <numeric>

#include "meshops/crossings/triangle_pair.hpp"

namespace tri {
namespace {

OverlapTree tree_of_rims(MeshView view, std::span<const std::vector<VertexHandle>> rims) {
  std::vector<OverlapTree::Box> boxes(rims.size());
  std::vector<std::uint32_t> items(rims.size());
  std::iota(items.begin(), items.end(), 0u);
  for (std::size_t i = 0; i < rims.size(); ++i)
    for (const VertexHandle v : rims[i]) boxes[i].grow(view.point(v));
  return OverlapTree(std::move(boxes), std::move(items));
}

/// Names for corners such that those in one place have one: vertices that were split lie on each other.
std::array<std::uint32_t, 3> names(const std::array<Vec3, 3>& at, const std::array<Vec3, 3>& first) {
  std::array<std::uint32_t, 3> result{};
  for (std::uint32_t i = 0; i < 3; ++i) {
    result[i] = 3 + i;
    for (std::uint32_t k = 0; k < 3; ++k)
      if (at[i] == first[k]) result[i] = k;
  }
  return result;
}

VertexTriple corners(MeshView view, FaceHandle f) {
  const HalfedgeHandle h = view.mesh.halfedge_handle(f);
  return {view.mesh.from_vertex_handle(h), view.mesh.to_vertex_handle(h),
          view.mesh.to_vertex_handle(view.mesh.next_halfedge_handle(h))};
}

std::array<Vec3, 3> places(MeshView view, const VertexTriple& t) {
  return {view.point(t[0]), view.point(t[1]), view.point(t[2])};
}

}  // namespace

FillingObstacles::FillingObstacles(MeshView view, std::span<const std::vector<VertexHandle>> rims)
    : view_(view), rims_(tree_of_rims(view, rims)), fillings_(rims.size()) {
  std::vector<FaceHandle> faces;
  for (int i = 0; i < static_cast<int>(view.mesh.n_faces()); ++i) {
    const FaceHandle f(i);
    if (view.mesh.status(f).deleted()) continue;
    bool near = false;
    rims_.overlapping(box_of(f), 0, [&](std::uint32_t) { near = true; });
    if (near) faces.push_back(f);
  }
  mesh_ = std::make_unique<Faces>(tree_of(std::move(faces)));
}

OverlapTree::Box FillingObstacles::box_of(FaceHandle f) const {
  OverlapTree::Box box;
  for (const VertexHandle v : corners(view_, f)) box.grow(view_.point(v));
  return box;
}

FillingObstacles::Faces FillingObstacles::tree_of(std::vector<FaceHandle> faces) const {
  std::vector<OverlapTree::Box> boxes;
  for (const FaceHandle f : faces) boxes.push_back(box_of(f));
  std::vector<std::uint32_t> items(faces.size());
  std::iota(items.begin(), items.end(), 0u);
  return {std::move(faces), OverlapTree(std::move(boxes), std::move(items))};
}

void FillingObstacles::start(std::size_t hole) {
  near_.assign(1, mesh_.get());
  rims_.overlapping(rims_.box(static_cast<std::uint32_t>(hole)), 0, [&](std::uint32_t other) {
    if (other != hole && fillings_[other]) near_.push_back(fillings_[other].get());
  });
}

void FillingObstacles::add(std::size_t hole, std::span<const FaceHandle> faces) {
  fillings_[hole] = std::make_unique<Faces>(tree_of({faces.begin(), faces.end()}));
}

int FillingObstacles::crossings(const VertexTriple& triangle) const {
  const auto at = places(view_, triangle);
  if (!triangle_has_area(at[0], at[1], at[2])) return 0;
  int count = 0;
  for (const Faces* faces : near_) count += crossings_with(*faces, at);
  return count;
}

int FillingObstacles::crossings_with(const Faces& faces, const std::array<Vec3, 3>& at) const {
  OverlapTree::Box box;
  for (const Vec3& p : at) box.grow(p);
  int count = 0;
  faces.tree.overlapping(box, 0, [&](std::uint32_t i) {
    const auto at_other = places(view_, corners(view_, faces.faces[i]));
    if (triangle_has_area(at_other[0], at_other[1], at_other[2]))
      count += triangles_meet({0, 1, 2}, at, names(at_other, at), at_other);
  });
  return count;
}

}  // namespace tri

#include "meshops/holes/filling_obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "meshops/crossings/triangle_pair.hpp"

namespace tri {
namespace {

/// Below, looking at each triangle of a filling is cheap.
constexpr std::size_t least_edges_to_project = 100;

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

/// In how many pieces a triangle goes into a tree: several if it is a needle, since its box is nearly empty if it lies
/// askew.
int pieces_of(const std::array<Vec3, 3>& at) {
  constexpr double needle = 16;  // length over height
  constexpr int most = 16;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (at[(k + 1) % 3] - at[k]).sqrnorm());
  const double twice_area = ((at[1] - at[0]) % (at[2] - at[0])).norm();
  int pieces = 1;
  while (pieces < most && longest > needle * pieces * twice_area) pieces *= 2;
  return pieces;
}

/// The boxes of a triangle halved along its longest side, again and again. @param pieces  a power of two
/// @param slack  for the rounding of places where it is cut
void add_boxes(const std::array<Vec3, 3>& at, int pieces, const Vec3& slack, std::vector<OverlapTree::Box>& boxes) {
  if (pieces == 1) {
    OverlapTree::Box& box = boxes.emplace_back();
    for (const Vec3& p : at) box.grow(p);
    box.lo -= slack;
    box.hi += slack;
    return;
  }
  std::size_t k = 0;
  for (std::size_t m = 1; m < 3; ++m)
    if ((at[(m + 1) % 3] - at[m]).sqrnorm() > (at[(k + 1) % 3] - at[k]).sqrnorm()) k = m;
  const Vec3 &a = at[k], &b = at[(k + 1) % 3], &c = at[(k + 2) % 3], middle = (a + b) / 2.0;
  add_boxes({a, middle, c}, pieces / 2, slack, boxes);
  add_boxes({middle, b, c}, pieces / 2, slack, boxes);
}

}  // namespace

FillingObstacles::FillingObstacles(MeshView view, std::span<const std::vector<VertexHandle>> rims)
    : view_(view), rings_(rims), rims_(tree_of_rims(view, rims)), fillings_(rims.size()) {
  for (int i = 0; i < static_cast<int>(view.mesh.n_faces()); ++i) {
    const FaceHandle f(i);
    if (view.mesh.status(f).deleted()) continue;
    bool near = false;
    rims_.overlapping(box_of(f), 0, [&](std::uint32_t) { near = true; });
    if (near) mesh_.faces.push_back(f);
  }
}

OverlapTree::Box FillingObstacles::box_of(FaceHandle f) const {
  OverlapTree::Box box;
  for (const VertexHandle v : corners(view_, f)) box.grow(view_.point(v));
  return box;
}

const OverlapTree& FillingObstacles::tree_of(const Faces& faces) const {
  if (faces.tree) return *faces.tree;
  std::vector<OverlapTree::Box> boxes;
  for (std::uint32_t i = 0; i < faces.faces.size(); ++i) {
    const auto at = places(view_, corners(view_, faces.faces[i]));
    const int pieces = pieces_of(at);
    if (pieces > 1 && faces.face_of.empty()) {
      faces.face_of.resize(boxes.size());
      std::iota(faces.face_of.begin(), faces.face_of.end(), 0u);
      faces.asked.assign(faces.faces.size(), 0);
    }
    Vec3 slack(0, 0, 0);
    if (pieces > 1)
      for (const Vec3& p : at)
        for (int k = 0; k < 3; ++k) slack[k] = std::max(slack[k], 1e-15 * std::abs(p[k]));
    add_boxes(at, pieces, slack, boxes);
    if (!faces.asked.empty()) faces.face_of.resize(boxes.size(), i);
  }
  std::vector<std::uint32_t> items(boxes.size());
  std::iota(items.begin(), items.end(), 0u);
  faces.tree.emplace(std::move(boxes), std::move(items));
  return *faces.tree;
}

template <class Find, class Visit>
void FillingObstacles::each_face(const Faces& faces, const Find& find, const Visit& visit) const {
  const OverlapTree& tree = tree_of(faces);
  ++faces.question;
  find(tree, [&](std::uint32_t item) {
    if (faces.asked.empty()) {
      visit(faces.faces[item]);
      return;
    }
    const std::uint32_t face = faces.face_of[item];
    if (faces.asked[face] == faces.question) return;
    faces.asked[face] = faces.question;
    visit(faces.faces[face]);
  });
}

void FillingObstacles::start(std::size_t hole) {
  near_.assign(1, &mesh_);
  rims_.overlapping(rims_.box(static_cast<std::uint32_t>(hole)), 0, [&](std::uint32_t other) {
    if (other != hole && fillings_[other]) near_.push_back(fillings_[other].get());
  });
  project(hole);
}

void FillingObstacles::project(std::size_t hole) {
  projection_.reset();
  const std::size_t edges = rings_[hole].size();
  // Going through all that is in the boxes of holes must not cost more than this filling does.
  if (edges < least_edges_to_project || mesh_.faces.size() > 300 * edges || view_.mesh.n_vertices() > 2000 * edges)
    return;
  const OverlapTree::Box& box = rims_.box(static_cast<std::uint32_t>(hole));
  projection_ = std::make_unique<FillingProjection>(view_, rings_[hole], box);
  others_ = {};
  for (const Faces* faces : near_)
    for (const FaceHandle f : faces->faces)
      if (!projection_->covers(f) && box_of(f).overlaps(box)) others_.faces.push_back(f);
}

std::vector<char> FillingObstacles::in_doubt(std::span<const VertexTriple> filling) const {
  if (!projection_) return std::vector<char>(filling.size(), 1);
  std::vector<char> doubt = projection_->in_doubt(filling);
  if (others_.faces.empty()) return doubt;
  for (std::size_t t = 0; t < filling.size(); ++t)
    if (!doubt[t]) doubt[t] = crossings_with(others_, places(view_, filling[t])) > 0;
  return doubt;
}

void FillingObstacles::add(std::size_t hole, std::span<const FaceHandle> faces) {
  fillings_[hole] = std::make_unique<Faces>();
  fillings_[hole]->faces.assign(faces.begin(), faces.end());
}

int FillingObstacles::crossings(const VertexTriple& triangle) const {
  const auto at = places(view_, triangle);
  if (!triangle_has_area(at[0], at[1], at[2])) return 0;
  int count = 0;
  for (const Faces* faces : near_) count += crossings_with(*faces, at);
  return count;
}

std::vector<FaceHandle> FillingObstacles::pierced(VertexHandle from, VertexHandle to) const {
  const Vec3 &p = view_.point(from), &q = view_.point(to);
  OverlapTree::Box box;
  box.grow(p);
  box.grow(q);
  std::vector<FaceHandle> found;
  for (const Faces* faces : near_)
    each_face(
        *faces, [&](const OverlapTree& tree, const auto& visit) { tree.overlapping(box, 0, visit); },
        [&](FaceHandle f) {
          const auto at = places(view_, corners(view_, f));
          if (std::find(at.begin(), at.end(), p) == at.end() && std::find(at.begin(), at.end(), q) == at.end() &&
              segment_pierces(p, q, at))
            found.push_back(f);
        });
  std::sort(found.begin(), found.end());
  return found;
}

int FillingObstacles::crossings_with(const Faces& faces, const std::array<Vec3, 3>& at) const {
  int count = 0;
  const TriangleBox triangle(at);
  each_face(
      faces, [&](const OverlapTree& tree, const auto& visit) { tree.meeting(triangle, visit); },
      [&](FaceHandle f) {
        const auto at_other = places(view_, corners(view_, f));
        if (triangle.beside(at_other)) return;
        if (triangle_has_area(at_other[0], at_other[1], at_other[2]))
          count += triangles_meet({0, 1, 2}, at, names(at_other, at), at_other);
      });
  return count;
}

}  // namespace tri

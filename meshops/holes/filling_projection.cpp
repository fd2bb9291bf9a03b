#include "meshops/holes/filling_projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

using FillingBox = OverlapTree::Box;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

OverlapTree tree_of(std::vector<FillingBox> boxes) {
  std::vector<std::uint32_t> items(boxes.size());
  std::iota(items.begin(), items.end(), 0u);
  return OverlapTree(std::move(boxes), std::move(items));
}

/// Cuts closed walks at every vertex that is met again. @param next  by vertex: its steps, which are used up
std::vector<std::vector<std::int32_t>> simple_walks(std::vector<std::vector<std::int32_t>> next) {
  std::vector<std::vector<std::int32_t>> loops;
  std::vector<std::int32_t> place(next.size(), -1), open;
  for (std::size_t start = 0; start < next.size(); ++start) {
    while (!next[start].empty()) {
      open.assign(1, static_cast<std::int32_t>(start));
      place[start] = 0;
      while (!next[open.back()].empty()) {
        const std::int32_t to = next[open.back()].back();
        next[open.back()].pop_back();
        if (place[to] < 0) {
          place[to] = static_cast<std::int32_t>(open.size());
          open.push_back(to);
          continue;
        }
        loops.emplace_back(open.begin() + place[to], open.end());
        for (const std::int32_t v : loops.back()) place[v] = -1;
        open.resize(open.size() - loops.back().size());
        place[to] = static_cast<std::int32_t>(open.size());
        open.push_back(to);
      }
      for (const std::int32_t v : open) place[v] = -1;
    }
  }
  return loops;
}

}  // namespace

FillingProjection::FillingProjection(MeshView view, std::span<const VertexHandle> ring, const FillingBox& box)
    : view_(view), taken_(view.mesh.n_faces(), 0), number_(view.mesh.n_vertices(), -1) {
  center_ = (box.lo + box.hi) / 2;
  Vec3 sum(0, 0, 0);
  for (std::size_t i = 0; i < ring.size(); ++i)
    sum += (view.point(ring[i]) - center_) % (view.point(ring[(i + 1) % ring.size()]) - center_);
  const Vec3 normal = unit_or_zero(sum);
  hopeless_ = !(normal.sqrnorm() > 0.5);
  if (hopeless_) return;
  const int least = std::abs(normal[0]) <= std::abs(normal[1]) ? (std::abs(normal[0]) <= std::abs(normal[2]) ? 0 : 2)
                                                               : (std::abs(normal[1]) <= std::abs(normal[2]) ? 1 : 2);
  Vec3 axis(0, 0, 0);
  axis[least] = 1;
  u_ = unit_or_zero(axis % normal);
  v_ = normal % u_;
  take_faces(ring, box);
  find_boundary(ring);
}

std::int32_t FillingProjection::number(VertexHandle v) {
  std::int32_t& n = number_[static_cast<std::size_t>(v.idx())];
  if (n < 0) {
    n = static_cast<std::int32_t>(places_.size());
    const Vec3& p = view_.point(v);
    places_.push_back(flat(p));
    for (int k = 0; k < 3; ++k) error_ = std::max(error_, 16 * epsilon * (std::abs(p[k]) + std::abs(center_[k])));
  }
  return n;
}

std::array<Vec2, 3> FillingProjection::corners_of(FaceHandle f) const {
  std::array<Vec2, 3> corners;
  std::size_t k = 0;
  for (auto it = view_.mesh.cfv_ccwiter(f); it.is_valid(); ++it)
    corners[k++] = places_[static_cast<std::size_t>(number_[static_cast<std::size_t>((*it).idx())])];
  return corners;
}

/// Bound for the rounding of a product of two differences of places.
double FillingProjection::slack(const Vec2& p, const Vec2& q) const {
  constexpr double underflow = 1e-290;
  return 8 * error_ * (std::abs(p[0]) + std::abs(p[1]) + std::abs(q[0]) + std::abs(q[1]) + error_) + underflow;
}

int FillingProjection::turn(const Vec2& a, const Vec2& b, const Vec2& c) const {
  const Vec2 p = b - a, q = c - a;
  const double area = p[0] * q[1] - p[1] * q[0];
  const double bound = slack(p, q);
  return area > bound ? 1 : area < -bound ? -1 : 0;
}

FillingBox FillingProjection::box_of(std::span<const Vec2> corners) const {
  FillingBox box;
  for (const Vec2& c : corners) box.grow(Vec3(c[0], c[1], 0));
  const Vec3 slack(2 * error_, 2 * error_, 0);
  box.lo -= slack;
  box.hi += slack;
  return box;
}

void FillingProjection::take_faces(std::span<const VertexHandle> ring, const FillingBox& box) {
  const auto take = [&](FaceHandle f) {
    if (taken_[static_cast<std::size_t>(f.idx())]) return;
    taken_[static_cast<std::size_t>(f.idx())] = 1;
    faces_.push_back(f);
    for (auto v = view_.mesh.cfv_iter(f); v.is_valid(); ++v) number(*v);
  };
  for (const VertexHandle v : ring) {
    number(v);
    // All around the rim, so that its vertices lie within.
    for (auto f = view_.mesh.cvf_iter(v); f.is_valid(); ++f) take(*f);
  }
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const std::array<Vec2, 3> at = corners_of(faces_[i]);
    if (turn(at[0], at[1], at[2]) <= 0) continue;
    for (auto h = view_.mesh.cfh_iter(faces_[i]); h.is_valid(); ++h) {
      const FaceHandle other = view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(*h));
      if (!other.is_valid() || covers(other)) continue;
      std::array<Vec2, 3> projected;
      std::size_t k = 0;
      FillingBox near;
      for (auto v = view_.mesh.cfv_ccwiter(other); v.is_valid(); ++v, ++k) {
        near.grow(view_.point(*v));
        projected[k] = flat(view_.point(*v));
      }
      // Where the surface turns over it may be the back of the part: the boundary is there.
      if (near.overlaps(box) && turn(projected[0], projected[1], projected[2]) > 0) take(other);
    }
  }
  for (const FaceHandle f : faces_) {
    const std::array<Vec2, 3> at = corners_of(f);
    const int t = turn(at[0], at[1], at[2]);
    if (t <= 0) regions_.push_back(region_of(at, t));
  }
}

FillingProjection::Region FillingProjection::region_of(const std::array<Vec2, 3>& at, int turn) const {
  return turn < 0 ? Region{{at[0], at[2], at[1], at[1]}, 3, true} : Region{{at[0], at[1], at[2], at[2]}, 3, turn > 0};
}

void FillingProjection::add_region(const FillingBox& box) {
  regions_.push_back(
      {{Vec2(box.lo[0], box.lo[1]), Vec2(box.hi[0], box.lo[1]), Vec2(box.hi[0], box.hi[1]), Vec2(box.lo[0], box.hi[1])},
       4,
       true});
}

/// The boundary of filling and surface together: loops beyond which no face was taken.
void FillingProjection::find_boundary(std::span<const VertexHandle> ring) {
  std::vector<std::pair<int, int>> rim;
  for (std::size_t i = 0; i < ring.size(); ++i) rim.push_back({ring[i].idx(), ring[(i + 1) % ring.size()].idx()});
  std::sort(rim.begin(), rim.end());
  const auto on_rim = [&](HalfedgeHandle h) {
    return std::binary_search(rim.begin(), rim.end(),
                              std::pair(view_.mesh.from_vertex_handle(h).idx(), view_.mesh.to_vertex_handle(h).idx()));
  };
  std::vector<std::vector<std::int32_t>> next(places_.size());
  for (const FaceHandle f : faces_)
    for (auto h = view_.mesh.cfh_iter(f); h.is_valid(); ++h) {
      const HalfedgeHandle beyond = view_.mesh.opposite_halfedge_handle(*h);
      const FaceHandle other = view_.mesh.face_handle(beyond);
      if (other.is_valid() ? covers(other) : on_rim(beyond)) continue;
      next[static_cast<std::size_t>(number(view_.mesh.from_vertex_handle(*h)))].push_back(
          number(view_.mesh.to_vertex_handle(*h)));
    }
  // A vertex of the ring around which there is yet another gap is not surrounded by faces.
  for (const VertexHandle v : ring)
    for (auto h = view_.mesh.cvoh_iter(v); h.is_valid(); ++h)
      if (view_.mesh.is_boundary(*h) && !on_rim(*h)) {
        const Vec2 at = places_[static_cast<std::size_t>(number(v))];
        add_region(box_of(std::span(&at, 1)));
      }
  check_loops(simple_walks(std::move(next)));
}

/// Each loop winds round a point at most once if it is simple, and a clockwise one adds nothing. So all but one are
/// regions unless they are clockwise.
void FillingProjection::check_loops(const std::vector<std::vector<std::int32_t>>& loops) {
  std::vector<double> area(loops.size(), 0), rounding(loops.size(), 0);
  std::size_t main = loops.size();
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const Vec2& origin = places_[static_cast<std::size_t>(loops[l][0])];
    for (std::size_t i = 0; i < loops[l].size(); ++i) {
      const Vec2 p = places_[static_cast<std::size_t>(loops[l][i])] - origin,
                 q = places_[static_cast<std::size_t>(loops[l][(i + 1) % loops[l].size()])] - origin;
      area[l] += p[0] * q[1] - p[1] * q[0];
      rounding[l] += 2 * slack(p, q);
    }
    if (main == loops.size() || area[l] > area[main]) main = l;
  }
  for (std::size_t l = 0; l < loops.size(); ++l) {
    if (loops[l].size() < 3) continue;  // there and back
    if (l == main || area[l] < -static_cast<double>(loops[l].size()) * rounding[l]) {
      check_loop(loops[l]);
      continue;
    }
    FillingBox box;
    for (const std::int32_t v : loops[l]) box.grow(box_of(std::span(&places_[static_cast<std::size_t>(v)], 1)));
    add_region(box);
  }
}

/// Where a loop crosses itself it is cut: what is left is simple, and the smaller part stays within a box.
void FillingProjection::check_loop(std::span<const std::int32_t> loop) {
  const std::size_t n = loop.size();
  const auto place = [&](std::size_t i) -> const Vec2& { return places_[static_cast<std::size_t>(loop[i % n])]; };
  std::vector<FillingBox> boxes(n);
  for (std::size_t i = 0; i < n; ++i) boxes[i] = box_of(std::array{place(i), place(i + 1)});
  const OverlapTree tree = tree_of(boxes);
  std::size_t steps = 0;
  const std::size_t most_steps = 16 * n + 1000;
  for (std::size_t i = 0; i < n && !hopeless_; ++i)
    tree.overlapping(boxes[i], static_cast<std::uint32_t>(i + 1), [&](std::uint32_t k) {
      if (steps > most_steps || apart({loop[i], loop[(i + 1) % n]}, {loop[k], loop[(k + 1) % n]})) return;
      std::size_t from = i, to = k;
      if (to - from > n / 2) from = k, to = i + n;
      steps += to - from + 1;
      FillingBox box;
      for (std::size_t at = from; at <= to + 1; ++at) box.grow(boxes[at % n]);
      add_region(box);
    });
  hopeless_ |= steps > most_steps;
}

/// Whether two steps of a loop meet in nothing but a common vertex.
bool FillingProjection::apart(const Step& a, const Step& b) const {
  const auto at = [&](std::int32_t v) -> const Vec2& { return places_[static_cast<std::size_t>(v)]; };
  if (a.to == b.from || b.to == a.from) {
    const Step &first = a.to == b.from ? a : b, &second = a.to == b.from ? b : a;
    const Vec2 p = at(first.to) - at(first.from), q = at(second.to) - at(second.from);
    return turn(at(first.from), at(first.to), at(second.to)) != 0 || (p | q) > slack(p, q);
  }
  const auto beside = [&](const Step& s, const Step& t) {
    const int x = turn(at(s.from), at(s.to), at(t.from));
    return x != 0 && x == turn(at(s.from), at(s.to), at(t.to));
  };
  return beside(a, b) || beside(b, a);
}

/// Whether a side of one has all of the other strictly beyond it.
bool FillingProjection::clear(const std::array<Vec2, 3>& triangle, const Region& region) const {
  const auto beyond = [&](std::span<const Vec2> one, std::span<const Vec2> other) {
    for (std::size_t i = 0; i < one.size(); ++i) {
      const Vec2 &p = one[i], &q = one[(i + 1) % one.size()];
      if (std::all_of(other.begin(), other.end(), [&](const Vec2& c) { return turn(p, q, c) < 0; })) return true;
    }
    return false;
  };
  const std::span<const Vec2> corners(region.corners.data(), static_cast<std::size_t>(region.size));
  return beyond(triangle, corners) || (region.oriented && beyond(corners, triangle));
}

std::vector<char> FillingProjection::in_doubt(std::span<const VertexTriple> filling) const {
  std::vector<char> doubt(filling.size(), 1);
  if (hopeless_) return doubt;
  std::vector<Region> regions = regions_;
  std::vector<std::array<Vec2, 3>> corners(filling.size());
  for (std::size_t t = 0; t < filling.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      corners[t][k] = places_[static_cast<std::size_t>(number_[static_cast<std::size_t>(filling[t][k].idx())])];
    const int side = turn(corners[t][0], corners[t][1], corners[t][2]);
    doubt[t] = side <= 0;
    if (doubt[t]) regions.push_back(region_of(corners[t], side));
  }
  if (regions.empty()) return doubt;
  std::vector<FillingBox> boxes;
  for (const Region& r : regions)
    boxes.push_back(box_of(std::span(r.corners.data(), static_cast<std::size_t>(r.size))));
  const OverlapTree tree = tree_of(std::move(boxes));
  for (std::size_t t = 0; t < filling.size(); ++t) {
    if (doubt[t]) continue;
    bool near = false;
    tree.overlapping(box_of(corners[t]), 0, [&](std::uint32_t r) { near = near || !clear(corners[t], regions[r]); });
    doubt[t] = near;
  }
  return doubt;
}

}  // namespace tri

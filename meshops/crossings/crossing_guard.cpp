#include "meshops/crossings/crossing_guard.hpp"

#include <algorithm>
#include <limits>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/limits.hpp"

namespace tri {
namespace {

constexpr double surely = 1e-10;  // of a cosine: above what rounding does to it

Vec3 normal_of(const std::array<Vec3, 3>& t) {
  return (t[1] - t[0]) % (t[2] - t[0]);
}

bool is_finite(const CrossingGuard::Piece& p) {
  return tri::is_finite(p.at[0]) && tri::is_finite(p.at[1]) && tri::is_finite(p.at[2]);
}

bool surely_agree(const Vec3& a, const Vec3& b) {
  const double dot = a | b;
  return dot > 0 && dot * dot > surely * surely * a.sqrnorm() * b.sqrnorm();
}

bool cross(const std::array<Vec3, 3>& a, const Vec3& normal_a, const std::array<Vec3, 3>& b, const Vec3& normal_b) {
  std::array<std::uint32_t, 3> names{3, 4, 5};  // of b's corners; those of a are 0, 1, 2
  std::size_t shared = 0, in_a = 0, in_b = 0;   // sums of the corners shared
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (a[i] == b[k]) names[k] = static_cast<std::uint32_t>(i), ++shared, in_a += i, in_b += k;
  if (shared == 2 && surely_agree(normal_a, normal_b)) {
    // Side by side, and not folded back, if the side they share has two directions.
    const std::size_t free_a = 3 - in_a, free_b = 3 - in_b;
    if (a[(free_a + 1) % 3] == b[(free_b + 2) % 3]) return false;
  }
  if (!triangle_has_area(a[0], a[1], a[2]) || !triangle_has_area(b[0], b[1], b[2])) return false;
  return triangles_meet({0, 1, 2}, a, names, b);
}

}  // namespace

bool triangles_cross(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  return cross(a, normal_of(a), b, normal_of(b));
}

std::vector<std::array<std::uint32_t, 2>> crossing_pairs(std::span<const Vec3> points,
                                                         std::span<const Triangle> triangles, const Context& context) {
  std::vector<Vec3> finite;
  if (!std::all_of(points.begin(), points.end(), [](const Vec3& p) { return is_finite(p); })) {
    finite.assign(points.begin(), points.end());
    for (Vec3& p : finite)
      if (!is_finite(p)) p = Vec3(0, 0, 0);
    points = finite;
  }
  auto pairs = self_intersections(points, triangles, context, Neighbors::judge);
  const auto corners = [&](std::uint32_t t) {
    return std::array{points[triangles[t][0]], points[triangles[t][1]], points[triangles[t][2]]};
  };
  // Vertices at the same place are one.
  std::erase_if(pairs, [&](const auto& pair) { return !triangles_cross(corners(pair[0]), corners(pair[1])); });
  return pairs;
}

CrossingGuard::CrossingGuard(MeshView mesh, const Context& context) : view_(mesh), context_(context) {
  build();
}

CrossingGuard::Piece CrossingGuard::piece_of(FaceHandle f) const {
  Piece piece;
  HalfedgeHandle h = view_.mesh.halfedge_handle(f);
  for (std::size_t k = 0; k < 3; ++k, h = view_.mesh.next_halfedge_handle(h)) {
    piece.corners[k] = view_.mesh.to_vertex_handle(h);
    piece.at[k] = view_.point(piece.corners[k]);
  }
  return piece;
}

void CrossingGuard::build() {
  const std::size_t n = view_.mesh.n_faces();
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::array<Vec3, 3>> corners(n, {Vec3(none, none, none), Vec3(none, none, none), Vec3(none, none, none)});
  alive_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 65536 == 0) context_.checkpoint();
    const FaceHandle f(static_cast<int>(i));
    if (view_.mesh.status(f).deleted()) continue;
    corners[i] = piece_of(f).at;
    ++alive_;
  }
  boxes_.build(corners, context_);
  alive_at_build_ = alive_;
}

/// Finds the faces near the pieces, but for those with the stamps of the question.
/// @param stamp  from which on faces are left out
void CrossingGuard::collect(std::span<const Piece> pieces, std::uint32_t stamp) {
  piece_boxes_.clear();
  MovingBoxes::Box all;
  for (const Piece& p : pieces) {
    piece_boxes_.push_back(is_finite(p) ? boxes_.box_of(p.at) : MovingBoxes::Box());
    all.grow(piece_boxes_.back());
  }
  candidates_.clear();
  boxes_.overlapping(all, [&](std::uint32_t i) {
    if (face_stamps_[i] >= stamp) return;
    const MovingBoxes::Box& box = boxes_.box(i);
    if (std::none_of(piece_boxes_.begin(), piece_boxes_.end(), [&](const auto& b) { return b.overlaps(box); })) return;
    const Piece piece = piece_of(FaceHandle(static_cast<int>(i)));
    candidates_.push_back({piece, normal_of(piece.at), box});
  });
}

/// Then the fans around all their corners are flat maps of the surface, one to one before the change (where no two
/// triangles cross), and so they are after it: moving the corners there in a straight line turns none over on the way.
/// Puts a stamp on the faces beside.
bool CrossingGuard::all_face_one_way(std::span<const Piece> pieces) {
  Vec3 up(0, 0, 0);
  for (const Piece& p : old_) up += normal_of(p.at);
  const auto agrees = [&](const Piece& p) { return surely_agree(normal_of(p.at), up); };
  if (!std::all_of(old_.begin(), old_.end(), agrees) || !std::all_of(pieces.begin(), pieces.end(), agrees))
    return false;
  for (const Piece& p : old_)
    for (const VertexHandle v : p.corners) {
      std::uint32_t& stamp = vertex_stamps_[static_cast<std::size_t>(v.idx())];
      if (stamp == stamp_) continue;
      stamp = stamp_;
      const HalfedgeHandle first = view_.mesh.halfedge_handle(v);
      const Vec3& at = view_.point(v);
      Vec3 side = view_.point(view_.mesh.to_vertex_handle(first)) - at;
      HalfedgeHandle h = first;
      do {
        // A fan that is open may wind around its corner more than once.
        if (view_.mesh.is_boundary(h)) return false;
        const HalfedgeHandle back = view_.mesh.prev_halfedge_handle(h);
        const Vec3 next = view_.point(view_.mesh.from_vertex_handle(back)) - at;
        std::uint32_t& face = face_stamps_[static_cast<std::size_t>(view_.mesh.face_handle(h).idx())];
        if (face < stamp_) {
          if (!surely_agree(side % next, up)) return false;
          face = stamp_;
        }
        side = next;
        h = view_.mesh.opposite_halfedge_handle(back);
      } while (h != first);
    }
  return true;
}

/// How many pairs cross, of pieces with the candidates and, if wanted, with one another. @param enough  to stop at
std::size_t CrossingGuard::crossings(std::span<const Piece> pieces, bool one_another, std::size_t enough) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& p = pieces[i];
    if (!is_finite(p)) continue;
    const Vec3 normal = normal_of(p.at);
    for (const Candidate& c : candidates_)
      if (c.box.overlaps(piece_boxes_[i]) && cross(p.at, normal, c.piece.at, c.normal) && ++count == enough)
        return count;
    for (std::size_t k = 0; one_another && k < i; ++k)
      if (is_finite(pieces[k]) && cross(p.at, normal, pieces[k].at, normal_of(pieces[k].at)) && ++count == enough)
        return count;
  }
  return count;
}

bool CrossingGuard::makes_worse(std::span<const Piece> pieces, std::span<const FaceHandle> gone) {
  if (gone.data() != gone_.data()) gone_.assign(gone.begin(), gone.end());
  face_stamps_.resize(boxes_.size(), 0);
  if (vertex_stamps_.size() < view_.mesh.n_vertices())
    vertex_stamps_.resize(view_.mesh.n_vertices() + view_.mesh.n_vertices() / 2, 0);
  if (stamp_ > 0xfffffff0) {
    std::fill(face_stamps_.begin(), face_stamps_.end(), 0);
    std::fill(vertex_stamps_.begin(), vertex_stamps_.end(), 0);
    stamp_ = 0;
  }
  stamp_ += 2;  // of what lies beside; of what goes one more
  old_.clear();
  for (const FaceHandle f : gone_) {
    face_stamps_[static_cast<std::size_t>(f.idx())] = stamp_ + 1;
    old_.push_back(piece_of(f));
  }
  const bool one_way = all_face_one_way(pieces);
  collect(pieces, one_way ? stamp_ : stamp_ + 1);
  if (crossings(pieces, !one_way, 1) == 0) return false;
  // What crosses already may go on to, but not more.
  if (one_way) collect(pieces, stamp_ + 1);
  const std::size_t then = crossings(pieces, true, std::numeric_limits<std::size_t>::max());
  collect(old_, stamp_ + 1);
  return crossings(old_, true, then) < then;
}

void CrossingGuard::add_fan(VertexHandle v, VertexHandle other, VertexHandle to, const Vec3& place) {
  for (HalfedgeHandle h : view_.mesh.voh_range(v)) {
    if (view_.mesh.is_boundary(h)) continue;
    const FaceHandle f = view_.mesh.face_handle(h);
    Piece piece = piece_of(f);
    bool both = false;
    for (std::size_t k = 0; k < 3; ++k) {
      both = both || piece.corners[k] == other;
      if (piece.corners[k] == v) piece.corners[k] = to, piece.at[k] = place;
    }
    if (!both) pieces_.push_back(piece);
    if (!both || v != to) gone_.push_back(f);
  }
}

bool CrossingGuard::collapse_makes_worse(HalfedgeHandle h, const Vec3& place) {
  const VertexHandle goes = view_.mesh.from_vertex_handle(h), stays = view_.mesh.to_vertex_handle(h);
  pieces_.clear();
  gone_.clear();
  add_fan(goes, stays, stays, place);
  if (place != view_.point(stays)) add_fan(stays, goes, stays, place);
  return makes_worse(pieces_, gone_);
}

bool CrossingGuard::flip_makes_worse(EdgeHandle e) {
  const auto& mesh = view_.mesh;
  const HalfedgeHandle h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
  const VertexHandle a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
  const VertexHandle c = mesh.to_vertex_handle(mesh.next_halfedge_handle(h));
  const VertexHandle d = mesh.to_vertex_handle(mesh.next_halfedge_handle(o));
  const auto piece = [&](VertexHandle u, VertexHandle v, VertexHandle w) {
    return Piece{{u, v, w}, {view_.point(u), view_.point(v), view_.point(w)}};
  };
  pieces_ = {piece(c, a, d), piece(d, b, c)};
  gone_ = {mesh.face_handle(h), mesh.face_handle(o)};
  return makes_worse(pieces_, gone_);
}

bool CrossingGuard::move_makes_worse(VertexHandle v, const Vec3& place) {
  pieces_.clear();
  gone_.clear();
  add_fan(v, VertexHandle(), v, place);
  return makes_worse(pieces_, gone_);
}

void CrossingGuard::done() {
  for (const FaceHandle f : gone_) {
    const auto i = static_cast<std::uint32_t>(f.idx());
    if (view_.mesh.status(f).deleted()) {
      boxes_.set(i, MovingBoxes::Box());
      --alive_;
      continue;
    }
    const Piece piece = piece_of(f);
    boxes_.set(i, is_finite(piece) ? boxes_.box_of(piece.at) : MovingBoxes::Box());
  }
  gone_.clear();
  if (2 * alive_ < alive_at_build_) build();
}

void CrossingGuard::split(VertexHandle v) {
  const auto box_now = [&](std::uint32_t i) {
    const Piece piece = piece_of(FaceHandle(static_cast<int>(i)));
    return is_finite(piece) ? boxes_.box_of(piece.at) : MovingBoxes::Box();
  };
  std::uint32_t old = 0;
  for (const FaceHandle f : view_.mesh.vf_range(v)) {
    const auto i = static_cast<std::uint32_t>(f.idx());
    if (i >= boxes_.size()) continue;
    boxes_.set(i, box_now(i));
    old = i;
  }
  for (; boxes_.size() < view_.mesh.n_faces(); ++alive_)
    boxes_.add(old, box_now(static_cast<std::uint32_t>(boxes_.size())));
  if (alive_ > 2 * alive_at_build_) build();
}

}  // namespace tri
